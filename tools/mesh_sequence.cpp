#include "mesh_sequence.h"

#include <tufa/check.h>
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
#include <set>
#include <string>
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
#include "report.h"
#include "standard_streams.h"
#include "usda_sequence.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::InvalidArgument, why); }

/// One frame, and what to do with it. There may be a million.
struct Frame {
  int number = 0;
  std::string input;
  std::string output;  ///< of all frames where they go into one file
  FrameState state = FrameState::Done;
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
      if (frame.state != FrameState::Done) continue;
      const std::string file = frameFile(frame.number);
      if (std::filesystem::exists(file)) frames.push_back({frame.number, file});
    }
    if (frames.empty()) return false;
    write(frames, fps);
    std::filesystem::remove_all(folder());
    staged_.commit(output_.filename().string());
    return true;
  }

 private:
  [[nodiscard]] std::filesystem::path folder() const {
    return std::filesystem::path(staged_.path()) / "frames";
  }

  /// Errors name the file that was asked for.
  void write(const std::vector<UsdaFrame>& frames, std::optional<double> fps) {
    const std::filesystem::path file = staged_.path() / output_.filename();
    try {
      joinUsdaFrames(frames, fps, file);
    } catch (const Error& error) {
      std::string message = error.what();
      const std::size_t at = message.find(file.string());
      if (at != std::string::npos) message.replace(at, file.string().size(), output_.string());
      throw Error(error.code(), message);
    }
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

/// Whether meshes of a format can be read, and so checked.
bool isReadable(MeshFormat format) {
  return format != MeshFormat::Usda && format != MeshFormat::ThreeMf;
}

Frame makeFrame(int number, const MeshArguments& arguments, const SequenceArguments& sequence) {
  Frame frame;
  frame.number = number;
  frame.input = frameFile(arguments.input, number);
  frame.output = isOneFile(arguments) ? arguments.output : frameFile(arguments.output, number);
  std::error_code error;
  if (!std::filesystem::exists(frame.input, error)) {
    frame.state = FrameState::Missing;
  } else if (sequence.resume && isNewer(frame.output, frame.input) &&
             (!arguments.check || isReadable(meshFormat(frame.output, arguments.format)))) {
    frame.state = FrameState::Skipped;
  }
  return frame;
}

MeshArguments argumentsOf(const Frame& frame, const MeshArguments& all,
                          const SequenceArguments& sequence) {
  MeshArguments arguments = all;
  arguments.input = frame.input;
  arguments.output = frame.output;
  arguments.allowEmpty = true;
  arguments.isFrame = true;
  arguments.quiet = true;
  if (arguments.contour.threads == 0) {
    arguments.contour.threads = std::max(1, resolveThreads(0) / sequence.jobs);
  }
  return arguments;
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

/// Throws Error(InvalidArgument) if a file of the frame would be overwritten.
void requireOwnFiles(const Frame& frame, const std::optional<std::string>& report) {
  requireDistinct(frame.output, {frame.input});
  if (!report) return;
  for (const std::string& file : {frame.input, frame.output}) {
    if (sameFile(*report, file)) refuse("--report " + *report + " would overwrite " + file);
  }
}

std::vector<Frame> framesOf(const MeshArguments& arguments, const SequenceArguments& sequence) {
  const std::vector<int> numbers =
      sequence.frames ? readFrames(*sequence.frames) : findFrames(arguments.input);
  std::vector<Frame> frames;
  for (const int number : numbers) {
    stopIfAsked();
    frames.push_back(makeFrame(number, arguments, sequence));
  }
  const auto missing = [](const Frame& frame) { return frame.state == FrameState::Missing; };
  if (std::all_of(frames.begin(), frames.end(), missing)) {
    std::string why = "no file of the sequence " + arguments.input + " is there";
    if (sequence.frames) why += ", of the frames " + *sequence.frames;
    const std::string other = withDigitsOfFiles(arguments.input);
    if (!other.empty()) why += "; there are files of " + other;
    throw Error(ErrorCode::UnreadableFile, why);
  }
  for (const Frame& frame : frames) {
    stopIfAsked();
    if (!missing(frame)) requireOwnFiles(frame, sequence.report);
  }
  requireFeasible(argumentsOf(frames.front(), arguments, sequence));
  return frames;
}

/// In the process of a frame whose mesh is there already: whether that is as it should be.
std::string checkFrame(const MeshArguments& arguments) {
  Json json;
  try {
    const Mesh mesh = readMeshInput(arguments.output, arguments.format);
    json["output"] = arguments.output;
    json["vertices"] = mesh.positions.size();
    json["triangles"] = mesh.triangleCount();
    CheckOptions options;
    options.threads = arguments.contour.threads;
    std::optional<CheckReport> report;
    const double seconds = timed([&] {
      if (mesh.triangleCount() > 0) report = check(mesh, options);
    });
    json["seconds"] = {{"check", seconds}};
    if (report) json["check"] = toJson(*report);
  } catch (const Error& error) {
    json["error"] = errorToJson(nameOf(error.code()), messageOf(error));
  } catch (const std::bad_alloc&) {
    json["error"] = errorToJson("out_of_memory", "out of memory");
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// In the process of a frame: what there is to tell of it. `output`: the file that is told of, if
/// it is another than that of the arguments.
std::string meshFrame(const MeshArguments& arguments, const std::string& output) {
  Json json;
  try {
    MeshRun run = meshFile(arguments);
    if (output != arguments.output) {
      for (GridRun& grid : run.grids) grid.output = output;
    }
    json = toJson(run, arguments);
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

/// The grids that frames were meshed of.
class FrameGrids {
 public:
  void add(const std::string& file, const Json& frame) {
    if (frame.contains("grid")) addName(frame);
    for (const Json& grid : frame.value("grids", Json::array())) addName(grid);
    if (firstFile_.empty() && !names_.empty()) firstFile_ = file, firstGrid_ = *names_.begin();
  }
  /// Says on standard error what is to be said of the choice of grids.
  void note(const std::vector<std::string>& asked) const {
    if (asked.empty() && !firstFile_.empty()) noteChoice(firstFile_, firstGrid_);
    for (const std::string& name : asked) {
      const bool isPattern = name.find_first_of("*?") != std::string::npos;
      if (isPattern || names_.empty() || names_.contains(name)) continue;
      printNote("note: no frame has a grid \"" + name + "\"");
    }
  }

 private:
  void addName(const Json& grid) { names_.insert(grid.value("grid", "")); }

  std::set<std::string> names_;
  std::string firstFile_, firstGrid_;
};

/// Tells of all frames in their order.
class FrameTeller {
 public:
  FrameTeller(const std::vector<Frame>& frames, bool printsEach)
      : frames_(frames), printsEach_(printsEach), table_(frames.size()) {}

  /// Of a frame that has been meshed, and those before it that are not to be. Whether to go on.
  bool tell(std::size_t index, Json result) {
    tellUpTo(index);
    isovalues_.add(result);
    grids_.add(frames_[index].input, result);
    const FrameRow& row = add(std::move(result));
    // What is wrong with the command line is wrong with the first frame; with one behind it, it is
    // what the frame holds that does not fit.
    if (!std::exchange(anyMeshed_, true) && row.code() == nameOf(ErrorCode::InvalidArgument)) {
      wrongUsage_ = row.message();
    }
    if (!wrongUsage_.empty()) return false;
    if (row.state == FrameState::Failed) printNote(row.message());
    if (printsEach_) print(table_.describeLast());
    return true;
  }

  /// Of the frames behind the last that is meshed.
  void finish() { tellUpTo(frames_.size()); }

  [[nodiscard]] const FrameTable& table() const { return table_; }
  [[nodiscard]] const Isovalues& isovalues() const { return isovalues_; }
  [[nodiscard]] const FrameGrids& grids() const { return grids_; }
  /// What is wrong with the command line; empty if nothing is.
  [[nodiscard]] const std::string& wrongUsage() const { return wrongUsage_; }

 private:
  const FrameRow& add(Json result) {
    const Frame& frame = frames_[told_++];
    return table_.add({frame.number, frame.input, frame.output, frame.state, std::move(result)});
  }

  void tellUpTo(std::size_t end) {
    while (told_ < end) {
      stopIfAsked();
      add(Json::object());
      if (printsEach_) print(table_.describeLast());
    }
  }

  const std::vector<Frame>& frames_;
  bool printsEach_;
  FrameTable table_;
  Isovalues isovalues_;
  FrameGrids grids_;
  std::size_t told_ = 0;
  bool anyMeshed_ = false;
  std::string wrongUsage_;
};

/// Of frames that are to be meshed, or checked.
std::vector<std::size_t> indicesOfWork(const std::vector<Frame>& frames, bool checksSkipped) {
  std::vector<std::size_t> indices;
  for (std::size_t index = 0; index < frames.size(); ++index) {
    const FrameState state = frames[index].state;
    const bool isChecked = checksSkipped && state == FrameState::Skipped;
    if (state == FrameState::Done || isChecked) indices.push_back(index);
  }
  return indices;
}

std::string jsonOf(const FrameTable& table, double seconds) {
  return table.toJson(seconds).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeReport(const FrameTable& table, double seconds, const std::string& report) {
  writeFile(endingOf(report) == ".csv" ? table.toCsv() : jsonOf(table, seconds), report);
}

}  // namespace

bool isSequence(const MeshArguments& arguments, const SequenceArguments& sequence) {
  if (sequence.frames) return true;
  std::error_code error;
  return !isStandard(arguments.input) && namesFrames(arguments.input) &&
         !std::filesystem::exists(arguments.input, error);
}

int runSequence(const MeshArguments& arguments, const SequenceArguments& sequence) {
  requireSound(arguments, sequence);
  const std::vector<Frame> frames = framesOf(arguments, sequence);
  const std::vector<std::size_t> toDo = indicesOfWork(frames, arguments.check);
  std::optional<OneFile> one;
  if (isOneFile(arguments)) one.emplace(arguments.output);
  FrameTeller teller(frames, !arguments.quiet && !arguments.json);
  const auto work = [&](std::size_t n) {
    const Frame& frame = frames[toDo[n]];
    MeshArguments ofFrame = argumentsOf(frame, arguments, sequence);
    if (frame.state == FrameState::Skipped) return checkFrame(ofFrame);
    if (one) ofFrame.output = one->frameFile(frame.number);
    return meshFrame(ofFrame, frame.output);
  };
  const auto tell = [&](std::size_t n, const ProcessResult& result) {
    return teller.tell(toDo[n], readResult(result));
  };
  const double seconds = timed([&] { runInProcesses(toDo.size(), sequence.jobs, work, tell); });
  const FrameTable& table = teller.table();
  if (teller.wrongUsage().empty()) teller.finish();
  // Before what may fail still.
  if (sequence.report) writeReport(table, seconds, *sequence.report);
  if (!teller.wrongUsage().empty()) refuse(teller.wrongUsage());
  if (!arguments.isovalue || *arguments.isovalue == "auto") teller.isovalues().note();
  if (!arguments.quiet && arguments.join != Join::Union && !arguments.labels) {
    teller.grids().note(arguments.grids);
  }
  bool isJoined = false;
  const double joinSeconds = timed([&] { isJoined = one && one->join(frames, sequence.fps); });

  if (arguments.json) {
    print(jsonOf(table, seconds));
  } else if (!arguments.quiet) {
    print(table.describe(seconds));
    if (isJoined) print(describeWritten({arguments.output}, joinSeconds));
  }
  if (table.isEmpty()) {
    printNote("no frame has a surface: all meshes are empty; tufa info says what values there are");
  }
  return table.failed() || table.isEmpty() ? kPromiseBroken : kDone;
}

}  // namespace tufa::tools
