#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "checker.h"
#include "chunks_run.h"
#include "commands.h"
#include "console.h"
#include "number.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

tufa::Coord readIndex(const std::string& text) {
  const std::vector<std::string> words = CLI::detail::split(text, ',');
  std::vector<std::int32_t> index;
  for (const std::string& word : words) {
    if (const auto number = numberIn<std::int32_t>(word)) index.push_back(*number);
  }
  if (words.size() == 3 && index.size() == 3) return {index[0], index[1], index[2]};
  throw Error(ErrorCode::InvalidArgument,
              "--only wants indices of chunks such as 0,-1,2, not \"" + text + "\"");
}

ChunkOptions chunkOptions(const ChunksArguments& arguments, const ContourOptions& meshing,
                          const openvdb::GridBase& grid, ProgressBar& bar) {
  ChunkOptions options = arguments.chunks;
  options.contour = meshing;
  options.contour.tolerance = readTolerance("--tolerance", arguments.tolerance, grid);
  for (const std::string& text : arguments.only) options.only.push_back(readIndex(text));
  options.contour.progress = bar.callback();
  return options;
}

/// Throws Error if it is certain already that the folder could not be made or written to, or if its
/// name is that of a mesh.
void requireWritableFolder(const std::filesystem::path& folder) {
  if (isStandard(folder.string())) {
    throw Error(ErrorCode::InvalidArgument,
                "chunks are written to a folder, which standard output cannot hold");
  }
  const std::string ending = endingOf(folder);
  if (!std::filesystem::is_directory(folder) &&
      (ending == ".glb" || ending == ".ply" || ending == ".obj" || ending == ".stl" ||
       ending == ".off" || ending == ".vdb")) {
    throw Error(ErrorCode::InvalidArgument,
                "chunks are written to a folder, and " + folder.string() +
                    " is the name of a file; --assemble makes one mesh of a folder of chunks");
  }
  // What ends with a slash has no name behind it.
  const std::filesystem::path named = folder.has_filename() ? folder : folder.parent_path();
  requireWritable(std::filesystem::is_directory(folder) ? folder / "chunks.json" : named);
}

std::vector<Attribute> withoutValues(const std::vector<Attribute>& attributes) {
  std::vector<Attribute> names;
  for (const Attribute& each : attributes) names.push_back({each.name, each.width, each.role});
  return names;
}

/// Says on standard error which of the chunks asked for have no surface.
void noteMissing(const ChunkIndex& index, const std::vector<tufa::Coord>& only) {
  for (const tufa::Coord& place : only) {
    const bool found = std::any_of(index.chunks.begin(), index.chunks.end(),
                                   [&](const ChunkEntry& chunk) { return chunk.index == place; });
    if (found) continue;
    printNote("note: there is no surface in chunk " + std::to_string(place[0]) + "," +
              std::to_string(place[1]) + "," + std::to_string(place[2]) + " of --only");
  }
}

/// Of the calls that a run makes: how long each is likely to take.
std::vector<double> callShares(const ChunksArguments& arguments) {
  if (arguments.filters.inOrder.empty()) return {kContourShare};
  return {kFilterShare, kContourShare};
}

ChunksRun build(const ChunksArguments& arguments) {
  ProgressBar bar(arguments.quiet, callShares(arguments));
  ChunksRun run;
  std::optional<GridFile> file;  // none once the volume is filtered
  std::shared_ptr<const openvdb::GridBase> grid;
  run.readSeconds = timed([&] { file = openVolume(arguments.input, arguments.grid); });
  grid = file->outline();
  requireVoxels(*grid, arguments.input);
  ContourOptions meshing = arguments.chunks.contour;
  if (lacksIsovalue(arguments.isovalue, *grid)) grid = loadVolume(*file, arguments.input);
  meshing.isovalue = readIsovalue(arguments.isovalue, *grid, arguments.input);
  if (!arguments.filters.inOrder.empty()) {
    std::shared_ptr<openvdb::GridBase> whole;
    run.readSeconds += timed([&] { whole = loadVolume(*file, arguments.input); });
    file.reset();
    grid = filterVolume(whole, arguments.input, arguments.filters, meshing, bar, run.filters);
    requireLeft(*grid, arguments.input, run.filters);
  }
  const ChunkOptions options = chunkOptions(arguments, meshing, *grid, bar);
  const ChunkFormat format = arguments.format == "ply" ? ChunkFormat::Ply : ChunkFormat::Glb;
  ChunkFolder folder(arguments.output, format, options.contour.threads);
  const AttributeGrids attributes(arguments.input, arguments.attributes);
  const ChunkSink sink = [&](const ChunkIndex& index, Chunk&& chunk) {
    run.attributeSeconds += timed([&] {
      for (ChunkLevel& level : chunk.levels) {
        level.attributes = attributes.sample(level.positions, options.contour.threads);
      }
    });
    if (run.attributes.empty()) run.attributes = withoutValues(chunk.levels.front().attributes);
    run.writeSeconds += timed([&] { folder.add(index, std::move(chunk)); });
  };
  run.buildSeconds = timed([&] {
    run.index = file ? buildChunks(*file, options, sink, &run.contour)
                     : buildChunks(*grid, options, sink, &run.contour);
  });
  run.buildSeconds -= run.writeSeconds + run.attributeSeconds;
  run.contour.nonFiniteValues += run.filters.nonFiniteValues();
  run.index.attributes = run.attributes;
  if (!arguments.quiet) {
    noteIsovalue(arguments.isovalue, *grid, run.contour.isovalue);
    if (!arguments.grid) noteChoice(arguments.input, run.index.grid);
  }
  noteMissing(run.index, options.only);
  if (options.compression != run.index.compression) noteFloats("every level");
  if (options.only.empty() && run.index.chunks.empty()) {
    if (file) grid = loadVolume(*file, arguments.input);
    requireSurface({}, run.contour.isovalue, *grid, arguments.input, run.filters.text());
  }
  run.writeSeconds += timed([&] { folder.commit(run.index, !options.only.empty()); });
  return run;
}

int runBuild(const ChunksArguments& arguments) {
  requireWritableFolder(arguments.output);
  const ChunksRun run = build(arguments);
  noteData(run.contour);
  if (arguments.json) {
    print(toJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(describe(run, arguments));
  }
  return kDone;
}

/// Throws Error(InvalidArgument) for options that do not go together.
void requireOneTask(const ChunksArguments& arguments, const CLI::App& command) {
  const bool assembling = !arguments.assemble.folder.empty();
  if (assembling == !arguments.input.empty()) {
    throw Error(ErrorCode::InvalidArgument, assembling ? "--assemble takes no volume"
                                            : arguments.only.empty()
                                                ? "FILE or --assemble DIR is needed"
                                                : "FILE is needed, before --only and its indices");
  }
  if (assembling && !arguments.filters.inOrder.empty()) {
    throw Error(ErrorCode::InvalidArgument,
                "--" + arguments.filters.inOrder.front().option + " is not for --assemble");
  }
  const std::vector<const char*> others =
      assembling
          ? std::vector<const char*>{"--grid",      "--chunk",     "--levels",   "--slab-voxels",
                                     "--tolerance", "--min-angle", "--factor",   "--format",
                                     "--only",      "--iso",       "--crease",   "--up",
                                     "--scale",     "--quantize",  "--compress", "--attribute",
                                     "--velocity",  "--shutter"}
          : std::vector<const char*>{"--lods", "--pixel-error", "--check"};
  for (const char* option : others) {
    if (command.count(option) == 0) continue;
    throw Error(ErrorCode::InvalidArgument,
                std::string(option) + " is " + (assembling ? "not " : "only ") + "for --assemble");
  }
  for (const char* option : {"--quantize", "--compress", "--up", "--scale"}) {
    if (command.count(option) == 0 || arguments.format == "glb") continue;
    throw Error(ErrorCode::InvalidArgument, std::string(option) + " is for --format glb only");
  }
  if (!assembling) {
    requireAttributes(arguments.attributes,
                      arguments.format == "glb" ? MeshFormat::Glb : MeshFormat::Ply);
  }
  if (assembling && arguments.assemble.lods.empty()) {
    throw Error(ErrorCode::InvalidArgument, "--assemble needs --lods");
  }
  if (command.count("--pixel-error") > 0 && !arguments.assemble.lods.starts_with("camera")) {
    throw Error(ErrorCode::InvalidArgument, "--pixel-error is for --lods camera:X,Y,Z only");
  }
}

void addBuildOptions(CLI::App& app, ChunksArguments& arguments) {
  ChunkOptions& options = arguments.chunks;
  app.add_option("--grid", arguments.grid, "name of the grid; default: the first level set");
  app.add_option("--chunk", options.chunkSize,
                 "voxels along an edge of a chunk, a power of two from 8 to 1024")
      ->capture_default_str();
  app.add_option("--levels", options.levels, "levels of each chunk")
      ->check(wholeNumberIn(1, 16))
      ->capture_default_str();
  app.add_option("--slab-voxels", options.slabVoxels,
                 "active voxels of a slab: level 0 of larger volumes is made slab by slab, in less "
                 "memory")
      ->check(above0())
      ->capture_default_str();
  app.add_option("--tolerance", arguments.tolerance,
                 "largest distance of level 0 to the uniform mesh, in voxels, or with the suffix w "
                 "in world units")
      ->capture_default_str();
  app.add_option("--factor", options.factor, "each level's tolerance over that of the level before")
      ->capture_default_str();
  app.add_option("--format", arguments.format, "of the meshes: glb or ply")
      ->check(CLI::IsMember({"glb", "ply"}))
      ->capture_default_str();
  app.add_option("--crease", options.creaseAngle,
                 "normals are split where faces differ by more, in degrees")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  addFrameOptions(app, options.up, options.scale, ".glb");
  addCompressionOptions(app, options.compression);
  addAttributeOptions(app, arguments.attributes, ".ply and .glb");
  app.add_option("--only", arguments.only,
                 "indices of the chunks to make, such as 0,-1,2, behind FILE; default: all");
}

void addAssembleOptions(CLI::App& app, AssembleArguments& arguments) {
  app.add_option("--assemble", arguments.folder, "make one mesh of the chunks of a folder");
  app.add_option("--lods", arguments.lods,
                 "levels of the chunks: all:K, random[:SEED] or camera:X,Y,Z");
  app.add_option("--pixel-error", arguments.pixelError,
                 "with camera: pixels of error, of 1080 in height and 45 degrees")
      ->check(above0())
      ->capture_default_str();
  app.add_flag("--check", arguments.check,
               checkerHelp("check the mesh; exit 1 if it is not watertight"));
}

}  // namespace

void addChunksCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<ChunksArguments>();
  CLI::App* const chunks = app.add_subcommand(
      "chunks", "Divide a volume's surface into chunks, each at several levels of detail");
  chunks->add_option("FILE", arguments->input, "a .vdb file");
  chunks
      ->add_option("-o,--output", arguments->output,
                   "the folder to write; with --assemble the mesh")
      ->required();
  addBuildOptions(*chunks, *arguments);
  addFilterOptions(*chunks, arguments->filters);
  addAssembleOptions(*chunks, arguments->assemble);
  addContourOptions(*chunks, arguments->chunks.contour, arguments->isovalue);
  for (const char* none : {"--no-repair", "--simplify", "--normals"}) {
    chunks->remove_option(chunks->get_option(none));
  }
  chunks->add_flag("--json", arguments->json, "one JSON object on standard output");
  chunks->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  chunks->callback([arguments, chunks, &chosen] {
    chosen = [arguments, chunks] {
      orderFilters(*chunks, arguments->filters);
      requireOneTask(*arguments, *chunks);
      if (arguments->assemble.folder.empty()) return runBuild(*arguments);
      AssembleArguments assemble = arguments->assemble;
      const std::filesystem::path index = assemble.folder;
      if (index.filename() == "chunks.json") assemble.folder = (index.parent_path() / "").string();
      assemble.output = arguments->output;
      assemble.threads = arguments->chunks.contour.threads;
      assemble.json = arguments->json;
      assemble.quiet = arguments->quiet;
      return runAssemble(assemble);
    };
  });
}

}  // namespace tufa::tools
