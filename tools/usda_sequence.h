#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace tufa::tools {

/// The file of one frame of a sequence, as write() makes it.
struct UsdaFrame {
  int number = 0;
  std::filesystem::path file;
};

/// Puts the .usda files of frames into one, in which meshes change with time: each attribute has a
/// sample at each frame, whose number is the time code. A mesh that a frame does not have is empty
/// there. `framesPerSecond`: the time codes in a second. There is at least one frame; numbers rise.
///
/// Holds one line of one file at a time. Throws Error: UnwritableFile, UnreadableFile,
/// InvalidArgument where some frames have a normal for each vertex and some for each corner.
void joinUsdaFrames(const std::vector<UsdaFrame>& frames, std::optional<double> framesPerSecond,
                    const std::filesystem::path& output);

}  // namespace tufa::tools
