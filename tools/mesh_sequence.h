#pragma once

#include <optional>
#include <string>

#include "mesh_run.h"

namespace tufa::tools {

/// What a sequence needs beside what each of its frames does.
struct SequenceArguments {
  std::optional<std::string> frames;  ///< text for readFrames(); unset: all that there are
  int jobs = 1;                       ///< frames at a time
  bool resume = false;                ///< leave out frames whose mesh is newer than their volume
  std::optional<double> fps;          ///< frames in a second, told in a .usda of all frames
  std::optional<std::string> report;  ///< a .csv or .json file about all frames
};

/// Whether the command line asks for a sequence: by `--frames`, or by a name with #### that is not
/// the name of a file.
[[nodiscard]] bool isSequence(const MeshArguments& arguments, const SequenceArguments& sequence);

/// Meshes all frames of a sequence, each in a process of its own, and tells of each. A frame that
/// fails does not stop the others, unless it is the first that is meshed and the command line is
/// wrong for it. Returns the exit code: 1 if any failed. Throws Error for what holds for all
/// frames; the report is written then too, of the frames up to there.
[[nodiscard]] int runSequence(const MeshArguments& arguments, const SequenceArguments& sequence);

}  // namespace tufa::tools
