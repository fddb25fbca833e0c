// Meshes the same grids with Tufa and with its peers in one process and prints how they compare.

#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/grid_files.h>
#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "contenders.h"
#include "measure.h"
#include "tables.h"
#include "volumes.h"

namespace {

using namespace tufa::bench;

struct Arguments {
  std::vector<std::string> shapes = {"sphere", "gyroid", "bracket", "terrain"};
  std::vector<std::string> meshes;
  std::vector<std::string> volumes;
  std::optional<double> isovalue;
  std::vector<double> sizes = {1, 10};
  std::vector<int> threads = {1, 2};
  int repeats = 5;
  bool methods = false;
};

void addOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("--shapes", arguments.shapes, "shapes to mesh, as `tufa make` names them")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--mesh", arguments.meshes, "mesh files to voxelize and mesh");
  app.add_option("--vdb", arguments.volumes, "files of volumes to mesh as they are");
  app.add_option("--iso", arguments.isovalue,
                 "isovalue of volumes that are no level sets (default half way between the least "
                 "and the greatest value)");
  app.add_option("--sizes", arguments.sizes, "millions of active voxels of shapes and meshes")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "numbers of threads")
      ->delimiter(',')
      ->capture_default_str();
  app.add_flag("--methods", arguments.methods,
               "compare the methods of `tufa mesh --method` with each other and with their peer");
  app.add_option("--repeats", arguments.repeats, "timed runs of each mesher")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

openvdb::FloatGrid::Ptr readVolume(const std::string& file) {
  auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(tufa::readGrid(file));
  if (!grid) throw std::runtime_error(file + " holds no grid of floats");
  return grid;
}

double isovalueOf(const openvdb::FloatGrid& grid, const std::optional<double>& asked) {
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) return 0;
  if (asked) return *asked;
  tufa::ContourOptions options;
  options.uniform = true;
  tufa::ContourReport report;
  static_cast<void>(tufa::contour(grid, options, &report));
  return report.isovalue;
}

std::vector<Case> measureVolume(const std::string& name, const openvdb::FloatGrid& grid,
                                const Arguments& arguments) {
  const double isovalue = isovalueOf(grid, arguments.isovalue);
  const std::vector<Contender> contenders =
      arguments.methods ? methodsFor(grid, isovalue) : contendersFor(grid, isovalue);
  std::vector<Case> cases;
  for (const int threads : arguments.threads) {
    cases.push_back({std::filesystem::path(name).stem().string(),
                     static_cast<double>(grid.activeVoxelCount()), threads,
                     measure(contenders, threads, arguments.repeats)});
  }
  return cases;
}

void run(const Arguments& arguments) {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, const openvdb::FloatGrid& grid) {
    const std::vector<Case> cases = measureVolume(name, grid, arguments);
    std::cerr << timeTable(cases) << std::flush;
    all.insert(all.end(), cases.begin(), cases.end());
  };
  for (const auto* names : {&arguments.shapes, &arguments.meshes}) {
    for (const std::string& name : *names) {
      for (const double millions : arguments.sizes) add(name, *makeVolume(name, millions * 1e6));
    }
  }
  for (const std::string& file : arguments.volumes) add(file, *readVolume(file));
  std::cout << timeTable(all);
  std::vector<std::string> names = {"tufa, uniform", "tufa, tolerance 0.1",
                                    "tufa, tolerance 0.1, --fast"};
  if (arguments.methods) {
    names.clear();
    for (const std::string_view name : tufa::methodNames()) {
      if (name != "dual") names.push_back(nameOf(*tufa::methodByName(name)));
    }
  }
  for (const std::string& name : names) {
    std::cout << "\n" << name << ", share of each stage:\n\n" << stageTable(all, name);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares Tufa's speed and memory with its peers'. Prints markdown tables.");
  Arguments arguments;
  addOptions(app, arguments);
  CLI11_PARSE(app, argc, argv);
  openvdb::initialize();
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
