#include <tufa/voxelize.h>

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/mesh.h>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "commands.h"
#include "console.h"
#include "open_edges.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"
#include "written_grid.h"

namespace tufa::tools {
namespace {

struct VoxelizeArguments {
  std::string input;
  std::string output;
  std::optional<std::string> format;
  VoxelizeOptions options;
  bool json = false;
  bool quiet = false;
};

/// A mesh shorter than so many voxels hardly has a shape: its units may be others.
constexpr double kFewVoxels = 8;

/// Whether there is anything that the surface is around.
bool hasInside(const openvdb::FloatGrid& grid, bool isFog) {
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (isFog ? *value > 0 : *value < 0) return true;
  }
  return false;
}

/// Of a mesh that has vertices, along an axis.
double longestSide(const Mesh& mesh) {
  double longest = 0;
  for (const auto at : {&Position::x, &Position::y, &Position::z}) {
    const auto [least, greatest] =
        std::minmax_element(mesh.positions.begin(), mesh.positions.end(),
                            [at](const Position& a, const Position& b) { return a.*at < b.*at; });
    longest = std::max(longest, (*greatest).*at - (*least).*at);
  }
  return longest;
}

int runVoxelize(const VoxelizeArguments& arguments) {
  keepApart(arguments.output);
  requireVoxelSize("--voxel", arguments.options.voxelSize);
  requireVolumeOutput(arguments.output);
  requireDistinct(arguments.output, {arguments.input});
  const Mesh mesh = readMeshInput(arguments.input, arguments.format);
  if (mesh.triangleCount() == 0) {
    throw Error(ErrorCode::UnreadableFile, shownInput(arguments.input) + " holds no faces");
  }
  if (!arguments.quiet) noteOpenMesh(mesh, "the inside");
  openvdb::FloatGrid::Ptr grid;
  VoxelizedMesh voxelized{mesh.triangleCount()};
  const double seconds = timed([&] {
    ProgressBar bar(arguments.quiet);
    VoxelizeOptions options = arguments.options;
    options.progress = bar.callback();
    grid = voxelize(mesh, options, &voxelized.distances);
  });
  const double length = longestSide(mesh) / arguments.options.voxelSize;
  if (!arguments.quiet && length < kFewVoxels) {
    printNote("note: the mesh is " + shortNumber(length) +
              " voxels long; --voxel is in the mesh's units, and a hundredth of its length shows "
              "most of its shape");
  }
  if (!arguments.quiet && !hasInside(*grid, arguments.options.fog)) {
    printNote("note: no voxel is inside: the mesh is thinner than the voxels of " +
              formatNumber(arguments.options.voxelSize) + ", or open; there is no surface to mesh");
  }
  WrittenGrid written;
  written.input = arguments.input;
  written.mesh = voxelized;
  written.output = arguments.output;
  written.voxelSize = arguments.options.voxelSize;
  written.makeSeconds = seconds;
  writeAndTell(grid, std::move(written), {arguments.json, arguments.quiet});
  return kDone;
}

}  // namespace

void addVoxelizeCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<VoxelizeArguments>();
  CLI::App* const voxelize = app.add_subcommand("voxelize", "Convert a mesh to a level set");
  VoxelizeOptions& options = arguments->options;
  voxelize
      ->add_option("MESH", arguments->input,
                   "an .obj, .ply, .stl, .off or .glb file, or - for standard input")
      ->required();
  voxelize
      ->add_option("-o,--output", arguments->output,
                   "the .vdb file to write, or - for standard output")
      ->required();
  addInputFormatOption(*voxelize, arguments->format);
  voxelize->add_option("--voxel", options.voxelSize, "voxel size in the mesh's units")->required();
  voxelize
      ->add_option("--half-width", options.halfWidth, "half width of the narrow band, in voxels")
      ->capture_default_str();
  voxelize
      ->add_option("--band-voxels", options.bandVoxels,
                   "most voxels of the band, in estimate from the mesh's area")
      ->check(above0())
      ->capture_default_str();
  voxelize->add_flag("--fog", options.fog,
                     "a fog volume: 1 inside, down to 0 on the surface, in place of a level set");
  voxelize->add_flag("--fast{false}", options.exactDistances,
                     "OpenVDB's distances, too low beside concave edges, in place of exact ones");
  addThreadsOption(*voxelize, options.threads);
  voxelize->add_flag("--json", arguments->json, "one JSON object on standard output");
  voxelize->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  voxelize->callback(
      [arguments, &chosen] { chosen = [arguments] { return runVoxelize(*arguments); }; });
}

}  // namespace tufa::tools
