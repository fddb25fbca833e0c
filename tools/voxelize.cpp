#include <tufa/voxelize.h>

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/io.h>
#include <memory>
#include <string>

#include "commands.h"
#include "console.h"
#include "progress_bar.h"

namespace tufa::tools {
namespace {

struct VoxelizeArguments {
  std::string input;
  std::string output;
  VoxelizeOptions options;
};

int runVoxelize(const VoxelizeArguments& arguments) {
  requireWritable(arguments.output);
  const Mesh mesh = readMesh(arguments.input);
  if (mesh.triangleCount() == 0) {
    throw Error(ErrorCode::UnreadableFile, arguments.input + " holds no faces");
  }
  openvdb::FloatGrid::Ptr grid;
  {
    ProgressBar bar(false);
    VoxelizeOptions options = arguments.options;
    options.progress = bar.callback();
    grid = voxelize(mesh, options);
  }
  writeGrids({grid}, arguments.output);
  print(arguments.output + ": " + formatCount(grid->activeVoxelCount()) + " active voxels of " +
        formatNumber(arguments.options.voxelSize) + " from " + formatCount(mesh.triangleCount()) +
        " triangles\n");
  return kDone;
}

}  // namespace

void addVoxelizeCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<VoxelizeArguments>();
  CLI::App* const voxelize = app.add_subcommand("voxelize", "Convert a mesh to a level set");
  VoxelizeOptions& options = arguments->options;
  voxelize->add_option("MESH", arguments->input, "an .obj, .ply, .stl, .off or .glb file")
      ->required();
  voxelize->add_option("-o,--output", arguments->output, "the .vdb file to write")->required();
  voxelize->add_option("--voxel", options.voxelSize, "voxel size in the mesh's units")->required();
  voxelize
      ->add_option("--half-width", options.halfWidth, "half width of the narrow band, in voxels")
      ->capture_default_str();
  addThreadsOption(*voxelize, options.threads);
  voxelize->callback(
      [arguments, &chosen] { chosen = [arguments] { return runVoxelize(*arguments); }; });
}

}  // namespace tufa::tools
