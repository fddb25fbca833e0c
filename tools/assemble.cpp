#include "assemble.h"

#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <vector>

#include "checker.h"
#include "commands.h"
#include "console.h"
#include "number.h"
#include "paths.h"
#include "progress_bar.h"
#include "report.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;
using Lods = std::vector<std::size_t>;

struct AssembleRun {
  ChunkIndex index;
  Lods lods;
  Mesh mesh;
  std::optional<CheckReport> check;
  double readSeconds = 0;
  double assembleSeconds = 0;
  double checkSeconds = 0;
  double writeSeconds = 0;
};

[[noreturn]] void refuse(const std::string& lods) {
  throw Error(ErrorCode::InvalidArgument,
              "--lods is all:K, random, random:SEED or camera:X,Y,Z, not \"" + lods + "\"");
}

template <class Number>
Number readNumber(const std::string& word, const std::string& lods) {
  const std::optional<Number> number = numberIn<Number>(word);
  if (!number) refuse(lods);
  return *number;
}

Lods randomLods(const ChunkIndex& index, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Lods lods;
  for (std::size_t i = 0; i < index.chunks.size(); ++i) {
    lods.push_back(random() % index.tolerances.size());
  }
  restrictLods(index, lods);
  return lods;
}

Lods cameraLods(const ChunkIndex& index, const std::string& eye, const std::string& lods,
                double pixelError) {
  const std::vector<std::string> words = CLI::detail::split(eye, ',');
  if (words.size() != 3) refuse(lods);
  Camera camera;
  camera.eye = {readNumber<double>(words[0], lods), readNumber<double>(words[1], lods),
                readNumber<double>(words[2], lods)};
  const Position& at = camera.eye;
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z)) refuse(lods);
  return selectLods(index, camera, pixelError);
}

Lods chooseLods(const ChunkIndex& index, const AssembleArguments& arguments) {
  const std::string& text = arguments.lods;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string kind = text.substr(0, colon);
  const std::string rest = colon < text.size() ? text.substr(colon + 1) : "";
  if (kind == "camera") return cameraLods(index, rest, text, arguments.pixelError);
  if (kind == "random") {
    return randomLods(index, colon == text.size() ? 0 : readNumber<std::uint64_t>(rest, text));
  }
  if (kind != "all") refuse(text);
  const auto level = readNumber<std::size_t>(rest, text);
  if (level >= index.tolerances.size()) {
    throw Error(ErrorCode::InvalidArgument, "the chunks have " +
                                                std::to_string(index.tolerances.size()) +
                                                " levels and no level " + rest);
  }
  return Lods(index.chunks.size(), level);
}

/// All chunks, each with the mesh of its own LOD only.
std::vector<Chunk> readChunks(const ChunkIndex& index, const Lods& lods, const std::string& folder,
                              ProgressBar& bar) {
  const Progress progress = bar.callback();
  std::vector<Chunk> chunks;
  for (std::size_t i = 0; i < index.chunks.size(); ++i) {
    if (!progress("reading", static_cast<double>(i) / static_cast<double>(index.chunks.size()))) {
      throw Error(ErrorCode::Cancelled, "cancelled while reading chunks");
    }
    chunks.push_back(readChunk(index, i, folder));
    for (std::size_t level = 0; level < chunks[i].levels.size(); ++level) {
      if (level != lods[i]) chunks[i].levels[level] = {};
    }
  }
  return chunks;
}

AssembleRun runStages(const AssembleArguments& arguments) {
  ProgressBar bar(arguments.quiet, arguments.check
                                       ? std::vector{kCheckShare, kCheckShare, kWriteShare}
                                       : std::vector{kCheckShare, kWriteShare});
  AssembleRun run;
  std::vector<Chunk> chunks;
  run.readSeconds = timed([&] {
    run.index = readChunkIndex(arguments.folder);
    if (run.index.chunks.empty()) {
      throw Error(ErrorCode::UnreadableFile, arguments.folder + " holds no chunks to assemble");
    }
    run.lods = chooseLods(run.index, arguments);
    chunks = readChunks(run.index, run.lods, arguments.folder, bar);
  });
  run.assembleSeconds = timed([&] { run.mesh = assembleChunks(chunks, run.lods); });
  chunks.clear();
  if (arguments.check) {
    CheckOptions options;
    options.threads = arguments.threads;
    options.progress = bar.callback();
    run.checkSeconds = timed([&] { run.check = check(run.mesh, options); });
  }
  WriteOptions writing;
  writing.progress = bar.callback();
  run.writeSeconds = timed([&] { write(run.mesh, arguments.output, writing); });
  return run;
}

Json runToJson(const AssembleRun& run, const AssembleArguments& arguments) {
  Json json;
  json["folder"] = arguments.folder;
  json["output"] = arguments.output;
  json["chunks"] = run.index.chunks.size();
  json["triangles"] = run.mesh.triangleCount();
  json["vertices"] = run.mesh.positions.size();
  json["lods"] = run.lods;
  json["seconds"] = {{"read", run.readSeconds},
                     {"assemble", run.assembleSeconds},
                     {"check", run.checkSeconds},
                     {"write", run.writeSeconds}};
  if (run.check) json["check"] = toJson(*run.check);
  return json;
}

std::string summary(const AssembleRun& run, const AssembleArguments& arguments) {
  std::string text = formatCount(run.mesh.triangleCount()) + " triangles, " +
                     formatCount(run.mesh.positions.size()) + " vertices of " +
                     formatCount(run.index.chunks.size()) + " chunks; of level";
  for (std::size_t level = 0; level < run.index.tolerances.size(); ++level) {
    const auto count = std::count(run.lods.begin(), run.lods.end(), level);
    text += (level == 0 ? " " : ", ") + std::to_string(level) + ": " +
            formatCount(static_cast<std::size_t>(count));
  }
  text += "\n";
  if (run.check) text += describe(*run.check);
  return text + describeWritten({arguments.output}, run.writeSeconds);
}

/// The files that chunks are read from.
std::vector<std::filesystem::path> filesOf(const ChunkIndex& index, const std::string& folder) {
  const std::filesystem::path in = folder;
  std::vector<std::filesystem::path> files = {in / "chunks.json"};
  for (const ChunkEntry& chunk : index.chunks) {
    for (const ChunkLevelEntry& level : chunk.levels) {
      if (!level.file.empty()) files.push_back(in / level.file);
    }
  }
  return files;
}

}  // namespace

int runAssemble(const AssembleArguments& arguments) {
  if (arguments.check) requireChecker();
  requireMeshEnding(arguments.output);
  requireDistinct(arguments.output, filesOf(readChunkIndex(arguments.folder), arguments.folder));
  requireWritable(arguments.output);
  const AssembleRun run = runStages(arguments);
  const bool broken = run.check && !run.check->watertight();
  if (broken) noteBroken(*run.check, {}, "the mesh");
  if (arguments.json) {
    print(runToJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(summary(run, arguments));
  }
  return broken ? kPromiseBroken : kDone;
}

}  // namespace tufa::tools
