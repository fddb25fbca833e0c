#include "mesh_sequence.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "commands.h"
#include "console.h"
#include "failure.h"
#include "frame_table.h"
#include "frames.h"
#include "paths.h"
#include "processes.h"
#include "standard_streams.h"
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
  frame.arguments.output = frameFile(arguments.output, number);
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
  if (!namesFrames(arguments.output)) {
    refuse("all frames would be written to " + arguments.output +
           "; write #### in the place of the frame's number");
  }
  if (sequence.resume && arguments.output.find("{}") != std::string::npos) {
    refuse("--resume cannot tell which meshes of {} there are to be");
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
    json = toJson(meshFile(frame.arguments), frame.arguments);
  } catch (const Error& error) {
    json["error"] = errorToJson(nameOf(error.code()), error.what());
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
  FrameTable table(frames.size());
  std::string wrongUsage;
  const auto work = [&](std::size_t index) {
    return frames[index].state == FrameState::Done ? meshFrame(frames[index]) : std::string("{}");
  };
  const auto tell = [&](std::size_t index, const ProcessResult& result) {
    const Frame& frame = frames[index];
    const FrameRow& row = table.add({frame.number, frame.arguments.input, frame.arguments.output,
                                     frame.state, readResult(result)});
    // What is wrong with the command line is wrong with every frame.
    if (row.code() == nameOf(ErrorCode::InvalidArgument)) wrongUsage = row.message();
    if (!wrongUsage.empty()) return false;
    if (row.state == FrameState::Failed) printNote(row.message());
    if (!arguments.quiet && !arguments.json) print(table.describeLast());
    return true;
  };
  const double seconds = timed([&] { runInProcesses(frames.size(), sequence.jobs, work, tell); });
  if (!wrongUsage.empty()) refuse(wrongUsage);

  if (sequence.report) {
    const bool csv = endingOf(*sequence.report) == ".csv";
    writeFile(csv ? table.toCsv() : table.toJson(seconds).dump(2) + "\n", *sequence.report);
  }
  if (arguments.json) {
    print(table.toJson(seconds).dump(2) + "\n");
  } else if (!arguments.quiet) {
    print(table.describe(seconds));
  }
  return table.failed() ? kPromiseBroken : kDone;
}

}  // namespace tufa::tools
