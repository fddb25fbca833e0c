#include "mesh_run.h"

#include <tufa/error.h>
#include <tufa/labels.h>
#include <tufa/quads.h>
#include <tufa/unite.h>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "base/braces.h"
#include "base/printable.h"
#include "checker.h"
#include "console.h"
#include "number.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

constexpr const char* kUnionName = "union";

/// A grid's name as a part of a file's: without what leads into a folder, what a terminal obeys,
/// and a dash in front, which commands take for an option.
std::string filePartOf(std::string_view name) {
  std::string part;
  while (!name.empty()) {
    const std::size_t count = base::shownBytes(name);
    const bool keeps = count > 0 && name[0] != '/' && !(part.empty() && name[0] == '-');
    part += keeps ? name.substr(0, count) : "_";
    name.remove_prefix(std::max<std::size_t>(count, 1));
  }
  return part.empty() ? "mesh" : part;
}

/// The output with braces replaced by the grid's name.
std::string outputOf(const std::string& output, const std::string& grid) {
  if (!base::hasBraces(output)) return output;
  return base::fillBraces(output, filePartOf(grid)).string();
}

/// Throws Error(InvalidArgument) if a grid would be written over the input or over another grid.
void requireApart(const std::vector<std::string>& grids, const MeshArguments& arguments) {
  std::map<std::string, std::string> gridOf;
  for (const std::string& grid : grids) {
    const std::string output = outputOf(arguments.output, grid);
    requireDistinct(output, {arguments.input});
    const std::string& first = gridOf.emplace(output, grid).first->second;
    if (first == grid || !base::hasBraces(arguments.output)) continue;
    throw Error(ErrorCode::InvalidArgument,
                "the grids \"" + first + "\" and \"" + grid + "\" would both be written to " +
                    output + "; mesh them one by one, with --grid and an output each");
  }
}

/// Meshes a grid that has been read, in `run.readSeconds`.
void meshVolume(const MeshArguments& arguments, std::shared_ptr<openvdb::GridBase> grid,
                ProgressBar& bar, GridRun& run) {
  run.output = outputOf(arguments.output, run.grid);
  if (!arguments.allowEmpty) requireVoxels(*grid, arguments.input);

  ContourOptions options = arguments.contour;
  // Half way between the voxels of a label and others.
  constexpr double kOfLabels = 0.5;
  options.isovalue =
      arguments.labels ? kOfLabels : readIsovalue(arguments.isovalue, *grid, arguments.input);
  grid = filterVolume(grid, arguments.input, arguments.filters, options, bar, run.filters);
  if (!arguments.allowEmpty) requireLeft(*grid, arguments.input, run.filters);
  run.voxelSize = voxelSizeOf(*grid);
  options.tolerance = readTolerance("--tolerance", arguments.tolerance, *grid);
  if (arguments.toleranceGrid) {
    options.toleranceGrid = readToleranceGrid(arguments.input, *arguments.toleranceGrid);
  }
  options.progress = bar.callback();
  options.keepCells = arguments.shareInterfaces;
  run.contourSeconds = timed([&] {
    const double refine = readTolerance("--refine", arguments.refine, *grid);
    const double merge = arguments.mergeCells ? options.tolerance : 0;
    run.mesh = extract(*grid, arguments.method, {options, arguments.sharpAngle, refine, merge},
                       &run.contour);
    run.contour.nonFiniteValues += run.filters.nonFiniteValues();
    if (arguments.target == Target::Quads) {
      pairTriangles(run.mesh, options.tolerance * voxelSizeOf(*grid));
    }
  });
  if (!arguments.quiet && !arguments.labels) {
    noteIsovalue(arguments.isovalue, *grid, run.contour.isovalue);
  }
  if (arguments.allowEmpty) return;
  if (arguments.labels && run.mesh.triangleCount() == 0) {
    throw Error(ErrorCode::UnsupportedGrid,
                "no surface is left of " + run.grid + " in " + shownInput(arguments.input) +
                    (run.filters.reports.empty() ? "" : " once it is filtered") +
                    "; --allow-empty goes on with an empty mesh");
  }
  requireSurface(run.mesh, run.contour.isovalue, *grid, arguments.input, run.filters.text());
}

void sampleAttributes(const MeshArguments& arguments, std::optional<AttributeGrids>& attributes,
                      GridRun& run) {
  if (arguments.attributes.empty() || run.mesh.positions.empty()) return;
  run.attributeSeconds = timed([&] {
    if (!attributes) attributes.emplace(arguments.input, arguments.attributes);
    run.mesh.attributes = attributes->sample(run.mesh.positions, arguments.contour.threads);
  });
}

/// Throws what readVolume() throws, with a hint where labels stand in the place of a surface.
std::shared_ptr<openvdb::GridBase> readForMesh(const MeshArguments& arguments,
                                               const std::optional<std::string>& name) {
  try {
    return readVolume(arguments.input, name);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::UnsupportedGrid) throw;
    const std::vector<GridInfo> grids = describeVolumes(arguments.input);
    if (std::none_of(grids.begin(), grids.end(), holdsLabels)) throw;
    throw Error(error.code(), std::string(error.what()) +
                                  "; --labels all meshes the labels of a grid of integers");
  }
}

GridRun meshGrid(const MeshArguments& arguments, const std::optional<std::string>& name,
                 ProgressBar& bar) {
  GridRun run;
  std::shared_ptr<openvdb::GridBase> grid;
  run.readSeconds = timed([&] { grid = readForMesh(arguments, name); });
  run.grid = name.value_or(nameOf(*grid));
  meshVolume(arguments, std::move(grid), bar, run);
  return run;
}

/// Meshes the union of some level sets of the file.
GridRun meshUnion(const MeshArguments& arguments, const std::vector<std::string>& names,
                  ProgressBar& bar) {
  GridRun run;
  run.grid = kUnionName;
  run.united = names;
  std::vector<std::shared_ptr<const openvdb::GridBase>> grids;
  run.readSeconds = timed([&] {
    for (const std::string& name : names) grids.push_back(readVolume(arguments.input, name));
  });
  UniteOptions options;
  options.threads = arguments.contour.threads;
  options.progress = bar.callback();
  std::shared_ptr<openvdb::GridBase> grid;
  run.uniteSeconds = timed([&] { grid = uniteLevelSets(grids, options); });
  grids.clear();
  meshVolume(arguments, std::move(grid), bar, run);
  return run;
}

void checkMesh(GridRun& run, const MeshArguments& arguments, ProgressBar& bar) {
  if (run.mesh.triangleCount() == 0) {
    if (!arguments.quiet) printNote("note: an empty mesh is not checked");
    return;
  }
  CheckOptions options;
  options.threads = arguments.contour.threads;
  options.progress = bar.callback();
  run.checkSeconds = timed([&] { run.check = check(run.mesh, options); });
}

/// Checks a mesh as its file has it where that holds other positions, which may bring sheets
/// together that are apart in memory.
void checkRounded(GridRun& run, const WriteReport& written, const MeshArguments& arguments) {
  if (!run.check || !run.check->watertight() || isDirect(run.output)) return;
  const MeshFormat format = meshFormat(run.output, arguments.format);
  const bool isRounded = written.rounding > 0 || (format == MeshFormat::Glb &&
                                                  arguments.compression != GlbCompression::None);
  if (!isRounded || (format != MeshFormat::Glb && format != MeshFormat::Stl)) return;
  CheckOptions options;
  options.threads = arguments.contour.threads;
  options.progress = [](std::string_view /*stage*/, double /*fraction*/) { return !interrupted(); };
  run.checkSeconds += timed([&] {
    CheckReport found = check(readMeshInput(run.output, arguments.format), options);
    if (!found.watertight()) run.check = std::move(found);
  });
  if (run.check->watertight()) return;
  printNote(run.output +
            " holds positions of less precision than the mesh, which breaks it; .ply, "
            ".obj and .off hold it as it is");
}

WriteOptions writeOptions(const MeshArguments& arguments, const GridRun& run, ProgressBar& bar) {
  WriteOptions options;
  if (!run.grid.empty()) options.name = run.grid;
  if (arguments.creaseAngle) options.creaseAngle = *arguments.creaseAngle;
  options.up = arguments.up;
  options.scale = arguments.scale;
  options.compression = arguments.compression;
  options.threads = arguments.contour.threads;
  options.progress = bar.callback();
  return options;
}

/// One file for all grids, or one for each where the name has braces.
void writeAll(MeshRun& run, const MeshArguments& arguments, ProgressBar& bar) {
  if (run.grids.size() == 1 || base::hasBraces(arguments.output)) {
    for (const GridRun& grid : run.grids) {
      const WriteOptions options = writeOptions(arguments, grid, bar);
      WriteReport written;
      if (isDirect(grid.output)) {
        const MeshFormat format = meshFormat(grid.output, arguments.format);
        writeDirect(grid.output, [&](std::ostream& stream) {
          write(grid.mesh, stream, format, options, &written);
        });
      } else {
        write(grid.mesh, grid.output, options, &written);
      }
      for (std::string& name : written.floatMeshes) {
        run.written.floatMeshes.push_back(std::move(name));
      }
      run.written.rounding = std::max(run.written.rounding, written.rounding);
    }
    return;
  }
  std::vector<NamedMesh> meshes;
  for (GridRun& grid : run.grids) meshes.push_back({grid.grid, std::move(grid.mesh)});
  const WriteOptions options = writeOptions(arguments, run.grids.front(), bar);
  if (isDirect(arguments.output)) {
    const MeshFormat format = meshFormat(arguments.output, arguments.format);
    writeDirect(arguments.output, [&](std::ostream& stream) {
      writeMeshes(meshes, stream, format, options, &run.written);
    });
  } else {
    writeMeshes(meshes, arguments.output, options, &run.written);
  }
  for (std::size_t i = 0; i < meshes.size(); ++i) run.grids[i].mesh = std::move(meshes[i].mesh);
}

/// One file holds several meshes in some formats only.
void requireRoomForAll(const std::vector<std::string>& grids, const MeshArguments& arguments) {
  const std::string& output = arguments.output;
  if (grids.size() < 2 || base::hasBraces(output)) return;
  const MeshFormat format = meshFormat(output, arguments.format);
  if (format == MeshFormat::Glb || format == MeshFormat::Obj || format == MeshFormat::Usda ||
      format == MeshFormat::ThreeMf) {
    return;
  }
  throw Error(ErrorCode::InvalidArgument, output + " would hold " + std::to_string(grids.size()) +
                                              " meshes, as only .glb, .obj, .usda and .3mf can; "
                                              "write {} in the file name for one file a "
                                              "grid");
}

/// The labels that `--labels` names, all of the grid for "all".
std::vector<std::int64_t> chooseLabels(const MeshArguments& arguments,
                                       const openvdb::GridBase& grid) {
  std::vector<std::int64_t> found;
  for (const LabelCount& count : labelsIn(grid)) found.push_back(count.label);
  if (found.empty()) {
    throw Error(ErrorCode::UnsupportedGrid, "grid \"" + nameOf(grid) + "\" in " +
                                                shownInput(arguments.input) + " has no labels");
  }
  if (*arguments.labels == "all") return found;
  std::vector<std::int64_t> chosen;
  std::string rest = *arguments.labels + ",";
  while (!rest.empty()) {
    const std::string word = rest.substr(0, rest.find(','));
    rest.erase(0, word.size() + 1);
    const auto label = numberIn<std::int64_t>(word);
    if (!label) {
      throw Error(ErrorCode::InvalidArgument,
                  "--labels takes all, or whole numbers with commas between them, not \"" +
                      *arguments.labels + "\"");
    }
    if (!std::binary_search(found.begin(), found.end(), *label)) {
      throw Error(ErrorCode::UnknownGrid,
                  "there is no label " + word + " in " + shownInput(arguments.input) +
                      "; there are " + std::to_string(found.size()) + ", from " +
                      std::to_string(found.front()) + " to " + std::to_string(found.back()));
    }
    chosen.push_back(*label);
  }
  return chosen;
}

/// The labels that were asked for, and their grid.
struct Labels {
  std::shared_ptr<openvdb::GridBase> grid;
  std::vector<std::int64_t> numbers;
};

Labels readLabels(const MeshArguments& arguments) {
  if (arguments.isovalue || arguments.grids.size() > 1) {
    throw Error(ErrorCode::InvalidArgument, "--labels takes no --iso, and one --grid at most");
  }
  std::optional<std::string> name;
  if (!arguments.grids.empty()) name = arguments.grids.front();
  for (const GridInfo& info : describeVolumes(arguments.input)) {
    if (!name && holdsLabels(info)) name = info.name;
    if (info.name == name && !holdsLabels(info)) {
      throw Error(ErrorCode::UnsupportedGrid, "grid \"" + *name + "\" in " +
                                                  shownInput(arguments.input) +
                                                  " does not hold 32- or 64-bit integers");
    }
  }
  if (!name) {
    throw Error(ErrorCode::UnsupportedGrid,
                shownInput(arguments.input) + " has no grid of 32- or 64-bit integers");
  }
  auto grid = readVolume(arguments.input, name);
  std::vector<std::int64_t> numbers = chooseLabels(arguments, *grid);
  return {std::move(grid), std::move(numbers)};
}

/// Makes the meshes of labels fit each other.
void fitLabels(const Labels& labels, std::vector<GridRun>& runs) {
  std::vector<Mesh> meshes;
  for (GridRun& run : runs) meshes.push_back(std::move(run.mesh));
  std::vector<InterfaceReport> reports;
  const double seconds =
      timed([&] { reports = shareInterfaces(*labels.grid, labels.numbers, meshes); });
  for (std::size_t n = 0; n < runs.size(); ++n) {
    runs[n].mesh = std::move(meshes[n]);
    runs[n].mesh.cells = {};
    runs[n].interfaces = reports[n];
    runs[n].contourSeconds += seconds / static_cast<double>(runs.size());
  }
}

/// Meshes some labels, a mesh each.
std::vector<GridRun> meshLabels(const MeshArguments& arguments, const Labels& labels,
                                std::vector<std::shared_ptr<openvdb::GridBase>> volumes,
                                ProgressBar& bar) {
  std::vector<GridRun> runs;
  for (auto& volume : volumes) {
    GridRun& run = runs.emplace_back();
    run.grid = nameOf(*volume);
    meshVolume(arguments, std::move(volume), bar, run);
  }
  if (arguments.shareInterfaces) fitLabels(labels, runs);
  return runs;
}

/// Of the calls that a run makes: how long each is likely to take.
std::vector<double> callShares(const MeshArguments& arguments, std::size_t grids) {
  std::vector<double> shares;
  if (arguments.join == Join::Union) shares.push_back(kFilterShare);
  for (std::size_t i = 0; i < grids; ++i) {
    if (!arguments.filters.inOrder.empty()) shares.push_back(kFilterShare);
    shares.push_back(kContourShare);
  }
  if (arguments.check) shares.insert(shares.end(), grids, kCheckShare);
  const bool oneFile = grids == 1 || !base::hasBraces(arguments.output);
  shares.insert(shares.end(), oneFile ? 1 : grids, kWriteShare);
  return shares;
}

}  // namespace

void requireFeasible(const MeshArguments& arguments) {
  if (arguments.check) requireChecker();
  if (arguments.labels && arguments.join == Join::Union) {
    throw Error(ErrorCode::InvalidArgument,
                "--join union is for level sets, and --labels for grids of integers");
  }
  if (arguments.shareInterfaces &&
      (!arguments.labels || !arguments.filters.inOrder.empty() ||
       arguments.method != Method::SurfaceNets || numberIn<double>(arguments.refine) != 0.0)) {
    throw Error(ErrorCode::InvalidArgument,
                "--share-interfaces is for --labels, by surface nets without filters and --refine");
  }
  requireDistinct(arguments.output, {arguments.input});
  requireMeshOutput(arguments.output, arguments.format);
  if (!arguments.attributes.empty() || arguments.attributes.shutter) {
    requireAttributes(arguments.attributes, meshFormat(arguments.output, arguments.format));
  }
  if (arguments.up != UpAxis::Y || arguments.scale != 1) {
    const MeshFormat format = meshFormat(arguments.output, arguments.format);
    if (format != MeshFormat::Glb && format != MeshFormat::Usda && format != MeshFormat::ThreeMf) {
      throw Error(ErrorCode::InvalidArgument, "--up and --scale are for .glb, .usda and .3mf only");
    }
  }
  if (arguments.creaseAngle) {
    const MeshFormat format = meshFormat(arguments.output, arguments.format);
    if (format != MeshFormat::Glb && format != MeshFormat::Usda && format != MeshFormat::Obj) {
      throw Error(ErrorCode::InvalidArgument, "--crease is for .glb, .obj and .usda only");
    }
  }
  if (arguments.compression != GlbCompression::None &&
      meshFormat(arguments.output, arguments.format) != MeshFormat::Glb) {
    throw Error(ErrorCode::InvalidArgument, "--quantize and --compress are for .glb only");
  }
}

MeshRun meshFile(const MeshArguments& arguments) {
  MeshRun run;
  std::vector<std::string> names;
  Labels labels;
  std::vector<std::shared_ptr<openvdb::GridBase>> volumes;
  double labelSeconds = 0;
  if (arguments.labels) {
    labelSeconds = timed([&] {
      labels = readLabels(arguments);
      volumes = labelVolumes(*labels.grid, labels.numbers);
    });
    for (const auto& volume : volumes) names.push_back(nameOf(*volume));
  } else if (arguments.join == Join::Union && arguments.grids.empty()) {
    names = chooseGrids(arguments.input, {"*"});
  } else if (!arguments.grids.empty()) {
    names = chooseGrids(arguments.input, arguments.grids,
                        arguments.isFrame ? Lacking::Skip : Lacking::Refuse);
  }
  const bool united = arguments.join == Join::Union;
  const std::vector<std::string> meshes = united ? std::vector<std::string>{kUnionName} : names;
  requireRoomForAll(meshes, arguments);
  requireApart(meshes, arguments);
  // A frame of a sequence that may be empty need not have the grids.
  std::optional<AttributeGrids> attributes;
  if (!arguments.allowEmpty) attributes.emplace(arguments.input, arguments.attributes);
  ProgressBar bar(arguments.quiet, callShares(arguments, std::max<std::size_t>(1, meshes.size())));
  if (arguments.labels) {
    run.grids = meshLabels(arguments, labels, std::move(volumes), bar);
    run.grids.front().readSeconds = labelSeconds;
  } else if (united) {
    run.grids.push_back(meshUnion(arguments, names, bar));
  } else if (names.empty()) {
    run.grids.push_back(meshGrid(arguments, {}, bar));
  } else {
    for (const std::string& name : names) run.grids.push_back(meshGrid(arguments, name, bar));
  }
  for (GridRun& grid : run.grids) sampleAttributes(arguments, attributes, grid);
  if (names.empty() && !arguments.quiet) noteChoice(arguments.input, run.grids.front().grid);
  if (arguments.check) {
    for (GridRun& grid : run.grids) checkMesh(grid, arguments, bar);
  }
  run.writeSeconds = timed([&] { writeAll(run, arguments, bar); });
  if (arguments.check && (run.grids.size() == 1 || base::hasBraces(arguments.output))) {
    for (GridRun& grid : run.grids) checkRounded(grid, run.written, arguments);
  }
  return run;
}

}  // namespace tufa::tools
