#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "attribute_options.h"
#include "checker.h"
#include "commands.h"
#include "console.h"
#include "mesh_run.h"
#include "mesh_sequence.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

/// Prints in what meshes are not as they should be; returns the exit code.
int judge(const MeshRun& run) {
  int exitCode = kDone;
  for (const std::string& name : run.written.floatMeshes) noteFloats("mesh \"" + name + "\"");
  double voxelSize = std::numeric_limits<double>::infinity();
  for (const GridRun& grid : run.grids) voxelSize = std::min(voxelSize, grid.voxelSize);
  noteRounding(run.written.rounding, voxelSize);
  for (const GridRun& grid : run.grids) {
    noteData(grid.contour, &grid.mesh);
    if (!grid.check || grid.check->watertight()) continue;
    noteBroken(*grid.check, grid.contour,
               run.grids.size() == 1 ? "the mesh" : "the mesh of grid \"" + grid.grid + "\"");
    exitCode = kPromiseBroken;
  }
  return exitCode;
}

int runMesh(const MeshArguments& arguments) {
  keepApart(arguments.output);
  requireFeasible(arguments);
  const MeshRun run = meshFile(arguments);
  const int exitCode = judge(run);
  if (arguments.json) {
    print(toJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(describe(run, arguments.contour.minAngle));
  }
  return exitCode;
}

void addAdaptiveOptions(CLI::App& app, MeshArguments& arguments) {
  ContourOptions& options = arguments.contour;
  app.add_option(
         "--tolerance", arguments.tolerance,
         "dual: largest distance to the uniform mesh, in voxels, or with the suffix w in world "
         "units; octree-mc: about the largest to the surface; cms: of the planes between which the "
         "surface of merged cells lies, which without it are the finest")
      ->capture_default_str();
  app.add_option("--max-angle", options.maxAngle,
                 "largest angle between the normals in one cell, in degrees")
      ->capture_default_str();
  app.add_option("--min-cell", options.minCell,
                 "size in voxels up to which cells are merged whatever the tolerance")
      ->capture_default_str();
  app.add_option("--max-cell", options.maxCell, "size in voxels of the largest cells");
  app.add_option("--tolerance-grid", arguments.toleranceGrid,
                 "float grid of the file that multiplies the tolerance in space");
  app.add_flag("--uniform", options.uniform, "do not merge cells");
  app.add_option_function<std::string>(
         "--target",
         [&arguments](const std::string& word) {
           arguments.target = word == "quads" ? Target::Quads : Target::Any;
         },
         "faces of the mesh: any (default), or quads where the surface is flat or bent one way "
         "only")
      ->check(CLI::IsMember({"any", "quads"}));
}

void addSequenceOptions(CLI::App& app, SequenceArguments& sequence) {
  app.add_option("--frames", sequence.frames,
                 "of a sequence, a name with #### for the frame's number: 1-240, 1-240x2 or 3,7,9; "
                 "default: all that there are");
  constexpr int kMostJobs = 256;
  app.add_option("--jobs", sequence.jobs, "of a sequence: frames at a time")
      ->check(wholeNumberIn(1, kMostJobs))
      ->capture_default_str();
  app.add_flag("--resume", sequence.resume,
               "of a sequence: leave out frames whose mesh is newer than their volume");
  app.add_option("--fps", sequence.fps, "of a sequence in one .usda: frames in a second")
      ->check(above0());
  app.add_option("--report", sequence.report, "of a sequence: a .csv or .json about all frames");
}

/// Throws Error for options that mean nothing without a sequence.
void requireSequence(const CLI::App& app, const MeshArguments& arguments) {
  if (arguments.output.find("##") != std::string::npos) {
    throw Error(ErrorCode::InvalidArgument,
                "the output " + arguments.output +
                    " has a place for a frame's number, and the input is the one file " +
                    arguments.input);
  }
  for (const char* name : {"--jobs", "--resume", "--fps", "--report"}) {
    if (app.get_option(name)->count() == 0) continue;
    throw Error(ErrorCode::InvalidArgument, std::string(name) + " is for sequences, and " +
                                                arguments.input +
                                                " has no #### in the place of a frame's number");
  }
}

void addMethodOption(CLI::App& app, MeshArguments& arguments) {
  const std::vector<std::string> names(methodNames().begin(), methodNames().end());
  app.add_option_function<std::string>(
         "--method",
         [&arguments](const std::string& name) { arguments.method = *methodByName(name); },
         "how the surface is extracted (default dual); all others make a triangle mesh or, "
         "surface-nets, quads, of the finest cells, but octree-mc, and cms with --tolerance")
      ->check(CLI::IsMember(names));
  app.add_option(
         "--sharp-angle", arguments.sharpAngle,
         "--method emc, cms: normals in a cell that differ by more, in degrees, mean a crease")
      ->capture_default_str();
  app.add_option(
         "--refine", arguments.refine,
         "split triangles whose middle is farther from the trilinear surface, in voxels, or "
         "with the suffix w in world units; 0: none")
      ->capture_default_str();
}

/// Throws Error for options that mean nothing to the method.
void requireMeaning(const CLI::App& app, Method method) {
  const bool sharp =
      method == Method::ExtendedMarchingCubes || method == Method::CubicalMarchingSquares;
  if (!sharp && app.get_option("--sharp-angle")->count() > 0) {
    throw Error(ErrorCode::InvalidArgument, "--sharp-angle is for --method emc and cms alone");
  }
  const bool asksFaces = method == Method::Dual || method == Method::MarchingCubes ||
                         method == Method::ExtendedMarchingCubes || method == Method::SurfaceNets ||
                         method == Method::OctreeCubes;
  if (!asksFaces && app.get_option("--ambiguity")->count() > 0) {
    throw Error(
        ErrorCode::InvalidArgument,
        "--ambiguity is for --method dual, mc, emc, surface-nets and octree-mc alone, as the "
        "others have no choice; leave it out");
  }
  if (method == Method::Dual) return;
  const bool adaptive = method == Method::OctreeCubes || method == Method::CubicalMarchingSquares;
  if (!adaptive && app.get_option("--tolerance")->count() > 0) {
    throw Error(ErrorCode::InvalidArgument,
                "--tolerance is for --method dual, octree-mc and cms alone; leave it out");
  }
  for (const char* name : {"--max-angle", "--min-cell", "--max-cell", "--tolerance-grid",
                           "--simplify", "--min-angle", "--target", "--no-repair"}) {
    if (app.get_option(name)->count() == 0) continue;
    const std::string word =
        name == std::string("--simplify") ? "--simplify, as --fast and --no-simplify," : name;
    throw Error(ErrorCode::InvalidArgument, word + " is for --method dual alone; leave it out");
  }
}

/// Throws Error for options that exclude each other.
void requireOneKindOfMesh(const CLI::App& app, const ContourOptions& options) {
  const auto isGiven = [&](const char* name) { return app.get_option(name)->count() > 0; };
  const std::vector<std::string> simplify = app.get_option("--simplify")->results();
  if (std::adjacent_find(simplify.begin(), simplify.end(), std::not_equal_to<>()) !=
      simplify.end()) {
    throw Error(ErrorCode::InvalidArgument, "--simplify excludes --fast and --no-simplify");
  }
  for (const char* name : {"--max-angle", "--min-cell", "--max-cell"}) {
    if (!options.simplify || !isGiven("--simplify") || !isGiven(name)) continue;
    throw Error(ErrorCode::InvalidArgument,
                std::string(name) +
                    " bounds cells, and --simplify collapses edges whatever cells "
                    "they are in: leave one of them out");
  }
  if (!options.uniform) return;
  for (const char* name : {"--tolerance", "--max-angle", "--min-cell", "--max-cell",
                           "--tolerance-grid", "--simplify", "--min-angle"}) {
    if (!isGiven(name)) continue;
    const bool isSimplify = name == std::string("--simplify");
    throw Error(ErrorCode::InvalidArgument,
                (isSimplify ? std::string("--simplify, as --fast and --no-simplify,") : name) +
                    " means nothing to --uniform, which merges no cells and collapses no edges");
  }
}

void addGridOptions(CLI::App& app, MeshArguments& arguments) {
  app.add_option("--grid", arguments.grids,
                 "names of grids, or patterns with * and ?: .glb, .obj, .usda and .3mf hold "
                 "several meshes, and "
                 "{} in the output's name makes a file for each; default: the first level set")
      ->allow_extra_args(false);
  app.add_option_function<std::string>(
         "--join",
         [&arguments](const std::string& word) {
           arguments.join = word == "union" ? Join::Union : Join::Separate;
         },
         "of several grids: separate, a mesh each (the default), or union, one mesh of the union "
         "of "
         "level sets; without --grid of all that can be meshed")
      ->check(CLI::IsMember({"separate", "union"}));
  app.add_option("--labels", arguments.labels,
                 "all, or numbers with commas between them: mesh each label of a grid of integers "
                 "apart, as label_1 and so on");
  app.add_flag("--share-interfaces", arguments.shareInterfaces,
               "--labels: where labels meet, their meshes have the same vertices and faces, to "
               "the bit; by --method surface-nets");
}

int run(const CLI::App& mesh, MeshArguments& arguments, const SequenceArguments& sequence) {
  orderFilters(mesh, arguments.filters);
  if (arguments.shareInterfaces && mesh.get_option("--method")->count() == 0) {
    arguments.method = Method::SurfaceNets;
  }
  requireMeaning(mesh, arguments.method);
  arguments.mergeCells = arguments.method == Method::CubicalMarchingSquares &&
                         mesh.get_option("--tolerance")->count() > 0;
  requireOneKindOfMesh(mesh, arguments.contour);
  if (isSequence(arguments, sequence)) return runSequence(arguments, sequence);
  requireSequence(mesh, arguments);
  return runMesh(arguments);
}

}  // namespace

void addMeshCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<MeshArguments>();
  const auto sequence = std::make_shared<SequenceArguments>();
  CLI::App* const mesh = app.add_subcommand("mesh", "Mesh the surface of a volume");
  mesh->add_option("FILE", arguments->input,
                   "a .vdb file, a sequence with #### for the frame's number, or - for standard "
                   "input")
      ->required();
  mesh->add_option("-o,--output", arguments->output,
                   "the mesh to write: .ply (binary), .obj, .stl, .off, .glb, .usda or .3mf, or - "
                   "for standard output; of a sequence a name with ####, or a .usda of all frames")
      ->required();
  addFormatOption(*mesh, arguments->format, "of the mesh in standard output, a pipe or a device");
  addGridOptions(*mesh, *arguments);
  addMethodOption(*mesh, *arguments);
  addAdaptiveOptions(*mesh, *arguments);
  addFilterOptions(*mesh, arguments->filters);
  addAttributeOptions(*mesh, arguments->attributes);
  addContourOptions(*mesh, arguments->contour, arguments->isovalue, true);
  mesh->add_option(
          "--crease", arguments->creaseAngle,
          ".glb, .obj and .usda: normals are split where faces differ by more, in degrees; "
          "default: 40")
      ->check(CLI::Range(0.0, 180.0));
  addFrameOptions(*mesh, arguments->up, arguments->scale);
  addCompressionOptions(*mesh, arguments->compression);
  mesh->add_flag("--allow-empty", arguments->allowEmpty,
                 "write an empty mesh where the grid has no surface");
  mesh->add_flag("--check", arguments->check,
                 checkerHelp("check the mesh; exit 1 if it is not watertight"));
  mesh->add_flag("--json", arguments->json, "one JSON object on standard output");
  mesh->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  addSequenceOptions(*mesh, *sequence);
  mesh->callback([mesh, arguments, sequence, &chosen] {
    chosen = [mesh, arguments, sequence] { return run(*mesh, *arguments, *sequence); };
  });
}

}  // namespace tufa::tools
