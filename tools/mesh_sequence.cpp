#include "mesh_sequence.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/staged_folder.h>
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "failure.h"
#include "frame_table.h"
#include "frames.h"
#include "paths.h"
#include "processes.h"
#include "standard_streams.h"
#include "usda_sequence.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::InvalidArgument, why); }

/// One frame, and what to do with it.
struct Frame {
  int number = 0;
  MeshArguments arguments;
  FrameState state = FrameState::Done;
  std::string joined;  ///< the file of all frames; empty if each has its own
  [[nodiscard]] const std::string& output() const {
    return joined.empty() ? arguments.output : joined;
  }
};

/// Whether all frames go into one file: a .usda, whose meshes change with time.
bool isOneFile(const MeshArguments& arguments) {
  return !isStandard(arguments.output) && !namesFrames(arguments.output) &&
         meshFormat(arguments.output, arguments.format) == MeshFormat::Usda;
}

/// What a link stands for, as for other files that are written.
std::filesystem::path behindLinks(std::filesystem::path path) {
  return std::filesystem::is_symlink(path) ? std::filesystem::weakly_canonical(path) : path;
}

/// The one file of all frames, while it is made: the frames' own files are in a folder beside it.
class OneFile {
 public:
  explicit OneFile(std::filesystem::path output)
      : output_(behindLinks(std::move(output))),
        staged_(output_.has_parent_path() ? output_.parent_path() : std::filesystem::path(".")) {
    std::filesystem::create_directory(folder());
  }

  [[nodiscard]] std::string frameFile(int frame) const {
    return (folder() / (std::to_string(frame) + ".usda")).string();
  }

  /// Puts the frames together of which there are files; whether there are any.
  bool join(const std::vector<Frame>& all, std::optional<double> fps) {
    std::vector<UsdaFrame> frames;
    for (const Frame& frame : all) {
      const std::string& file = frame.arguments.output;
      if (std::filesystem::exists(file)) frames.push_back({frame.number, file});
    }
    if (frames.empty()) return false;
    joinUsdaFrames(frames, fps, staged_.path() / output_.filename());
    std::filesystem::remove_all(folder());
    staged_.commit(output_.filename().string());
    return true;
  }

 private:
  [[nodiscard]] std::filesystem::path folder() const {
    return std::filesystem::path(staged_.path()) / "frames";
  }

  std::filesystem::path output_;
  StagedFolder staged_;
};

bool isNewer(const std::string& output, const std::string& input) {
  std::error_code error;
  const auto made = std::filesystem::last_write_time(output, error);
  if (error) return false;
  return made > std::filesystem::last_write_time(input, error) && !error;
}

Frame makeFrame(int number, const MeshArguments& arguments, const SequenceArguments& sequence) {
  Frame frame;
  frame.number = number;
  frame.arguments = arguments;
  frame.arguments.input = frameFile(arguments.input, number);
  if (isOneFile(arguments)) {
    frame.joined = arguments.output;
  } else {
    frame.arguments.output = frameFile(arguments.output, number);
  }
  frame.arguments.allowEmpty = true;
  frame.arguments.quiet = true;
  if (arguments.contour.threads == 0) {
    frame.arguments.contour.threads = std::max(1, resolveThreads(0) / sequence.jobs);
  }
  std::error_code error;
  if (!std::filesystem::exists(frame.arguments.input, error)) {
    frame.state = FrameState::Missing;
  } else if (sequence.resume && isNewer(frame.arguments.output, frame.arguments.input)) {
    frame.state = FrameState::Skipped;
  }
  return frame;
}

void requireSound(const MeshArguments& arguments, const SequenceArguments& sequence) {
  if (!namesFrames(arguments.input)) {
    refuse("--frames needs a name with #### in the place of the frame's number, which " +
           arguments.input + " does not have");
  }
  for (const std::string& name : {arguments.input, arguments.output}) requireOnePlace(name);
  const bool isOne = isOneFile(arguments);
  if (!isOne && !namesFrames(arguments.output)) {
    refuse("all frames would be written to " + arguments.output +
           ", as only a .usda can hold them; write #### in the place of the frame's number");
  }
  if (isOne) {
    std::error_code error;
    const auto status = std::filesystem::status(arguments.output, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
      refuse("a .usda of all frames is written to a file, which " + arguments.output + " is not");
    }
    if (sequence.resume) refuse("--resume is for a file a frame, not for a .usda of all frames");
  } else if (sequence.fps) {
    refuse("--fps is for a .usda of all frames, whose name has no ####");
  }
  if ((sequence.resume || isOne) && arguments.output.find("{}") != std::string::npos) {
    refuse(isOne ? "a .usda of all frames holds all grids; leave {} out of its name"
                 : "--resume cannot tell which meshes of {} there are to be");
  }
  if (!sequence.report) return;
  const std::string ending = endingOf(*sequence.report);
  if (ending != ".csv" && ending != ".json") {
    refuse("a report of a sequence is written as .csv or .json, which " + *sequence.report +
           " does not end in");
  }
  requireWritable(*sequence.report);
}

std::vector<Frame> framesOf(const MeshArguments& arguments, const SequenceArguments& sequence) {
  const std::vector<int> numbers =
      sequence.frames ? readFrames(*sequence.frames) : findFrames(arguments.input);
  std::vector<Frame> frames;
  for (const int number : numbers) frames.push_back(makeFrame(number, arguments, sequence));
  const auto missing = [](const Frame& frame) { return frame.state == FrameState::Missing; };
  if (std::all_of(frames.begin(), frames.end(), missing)) {
    throw Error(
        ErrorCode::UnreadableFile,
        "no file of the sequence " + arguments.input +
            (sequence.frames ? " is there, of the frames " + *sequence.frames : " is there"));
  }
  for (const Frame& frame : frames) {
    requireDistinct(frame.arguments.output, {frame.arguments.input});
    if (!sequence.report) continue;
    for (const std::string& file : {frame.arguments.input, frame.arguments.output}) {
      if (sameFile(*sequence.report, file)) {
        refuse("--report " + *sequence.report + " would overwrite " + file);
      }
    }
  }
  requireFeasible(frames.front().arguments);
  return frames;
}

/// In the process of a frame: what there is to tell of it.
std::string meshFrame(const Frame& frame) {
  Json json;
  try {
    MeshRun run = meshFile(frame.arguments);
    if (!frame.joined.empty()) {
      for (GridRun& grid : run.grids) grid.output = frame.joined;
    }
    json = toJson(run, frame.arguments);
  } catch (const Error& error) {
    json["error"] = errorToJson(nameOf(error.code()), messageOf(error));
  } catch (const std::bad_alloc&) {
    json["error"] = errorToJson("out_of_memory", "out of memory");
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// What a process gave, or why it gave nothing.
Json readResult(const ProcessResult& result) {
  Json json = Json::parse(result.output, nullptr, false);
  if (json.is_object() && result.signal == 0) return json;
  // The crash guard has told of a damaged file itself.
  const std::string why = result.signal == 0
                              ? "its process ended early; the file may be damaged"
                              : std::string("its process was ended: ") + ::strsignal(result.signal);
  return {{"error", errorToJson("ended", why)}};
}

/// The isovalues of the frames that have a surface, by grid.
class Isovalues {
 public:
  void add(const Json& frame) {
    if (const auto grids = frame.find("grids"); grids != frame.end()) {
      for (const Json& grid : *grids) addGrid(grid);
    } else {
      addGrid(frame);
    }
  }
  /// Says on standard error that frames differ, if they do.
  void note() const {
    for (const auto& [grid, range] : ranges_) {
      if (!(range.least < range.greatest)) continue;
      printNote("note: the isovalue of grid \"" + grid + "\" differs from frame to frame, from " +
                formatNumber(range.least) + " to " + formatNumber(range.greatest) +
                ", half way between the least and the greatest value of each; --iso makes it one");
    }
  }

 private:
  struct Range {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
  };

  void addGrid(const Json& grid) {
    if (!grid.contains("isovalue") || grid.value("triangles", 0) == 0) return;
    Range& range = ranges_[grid.value("grid", "")];
    const double isovalue = grid["isovalue"].get<double>();
    range.least = std::min(range.least, isovalue);
    range.greatest = std::max(range.greatest, isovalue);
  }

  std::map<std::string, Range> ranges_;
};

}  // namespace

bool isSequence(const MeshArguments& arguments, const SequenceArguments& sequence) {
  if (sequence.frames) return true;
  std::error_code error;
  return !isStandard(arguments.input) && namesFrames(arguments.input) &&
         !std::filesystem::exists(arguments.input, error);
}

int runSequence(const MeshArguments& arguments, const SequenceArguments& sequence) {
  requireSound(arguments, sequence);
  std::vector<Frame> frames = framesOf(arguments, sequence);
  std::optional<OneFile> one;
  if (isOneFile(arguments)) {
    one.emplace(arguments.output);
    for (Frame& frame : frames) frame.arguments.output = one->frameFile(frame.number);
  }
  FrameTable table(frames.size());
  std::string wrongUsage;
  Isovalues isovalues;
  const auto work = [&](std::size_t index) {
    return frames[index].state == FrameState::Done ? meshFrame(frames[index]) : std::string("{}");
  };
  const auto tell = [&](std::size_t index, const ProcessResult& result) {
    const Frame& frame = frames[index];
    Json json = readResult(result);
    isovalues.add(json);
    const FrameRow& row = table.add(
        {frame.number, frame.arguments.input, frame.output(), frame.state, std::move(json)});
    // What is wrong with the command line is wrong with every frame.
    if (row.code() == nameOf(ErrorCode::InvalidArgument)) wrongUsage = row.message();
    if (!wrongUsage.empty()) return false;
    if (row.state == FrameState::Failed) printNote(row.message());
    if (!arguments.quiet && !arguments.json) print(table.describeLast());
    return true;
  };
  const double seconds = timed([&] { runInProcesses(frames.size(), sequence.jobs, work, tell); });
  if (!wrongUsage.empty()) refuse(wrongUsage);
  if (!arguments.isovalue || *arguments.isovalue == "auto") isovalues.note();
  bool isJoined = false;
  const double joinSeconds = timed([&] { isJoined = one && one->join(frames, sequence.fps); });

  if (sequence.report) {
    const bool csv = endingOf(*sequence.report) == ".csv";
    writeFile(csv ? table.toCsv() : table.toJson(seconds).dump(2) + "\n", *sequence.report);
  }
  if (arguments.json) {
    print(table.toJson(seconds).dump(2) + "\n");
  } else if (!arguments.quiet) {
    print(table.describe(seconds));
    if (isJoined) print(describeWritten({arguments.output}, joinSeconds));
  }
  return table.failed() ? kPromiseBroken : kDone;
}

}  // namespace tufa::tools
