// Runs every mesh and volume of a folder through Tufa and prints a markdown table of what came out:
// meshes voxelized at two resolutions, volumes as they are.

#include <openvdb/openvdb.h>

#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/voxelize.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "meta_image.h"
#include "table_text.h"

namespace {

using namespace tufa;
using bench::count;
using bench::number;
using bench::readMetaImage;
namespace fs = std::filesystem;

// Voxels along the longest side of a mesh.
constexpr int kResolutions[2] = {100, 250};

double extentOf(const Mesh& mesh) {
  openvdb::BBoxd box;
  for (const Position& p : mesh.positions) box.expand(openvdb::Vec3d(p.x, p.y, p.z));
  return box.empty() ? 0 : box.extents()[box.maxExtent()];
}

std::string errors(const DistanceSummary& side) {
  return number("%.3f", side.largest) + " / " + number("%.4f", side.mean);
}

std::string manifold(const CheckReport& report) {
  if (report.triangles == 0) return "no surface at this resolution";
  if (!report.manifold) {
    return "no: " + count(report.nonManifoldEdges) + " edges, " +
           count(report.nonManifoldVertices) + " vertices";
  }
  return report.closed ? "yes" : "yes, open where the data ends";
}

std::string row(const std::string& file, const std::string& source, const openvdb::GridBase& grid,
                const std::optional<double>& isovalue) {
  ContourOptions options;
  options.uniform = true;
  options.isovalue = isovalue;
  ContourReport report;
  const auto start = std::chrono::steady_clock::now();
  const Mesh mesh = contour(grid, options, &report);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const CheckReport checked = check(mesh);
  DistanceOptions against;
  against.isovalue = isovalue;
  const DistanceReport distance = checkAgainst(mesh, grid, against);
  return "| " + file + " | " + source + " | " + count(report.activeVoxels) + " | " +
         count(checked.triangles) + " | " + manifold(checked) + " | " +
         count(checked.selfIntersectingPairs.value_or(0)) + " | " + errors(distance.meshToSurface) +
         " | " + errors(distance.surfaceToMesh) + " | " + number("%.2f", seconds.count()) + " |\n";
}

void printRows(const fs::path& path, std::string ending) {
  const std::string file = path.filename().string();
  if (ending == ".vdb" || ending == ".nvdb") {
    std::cout << row(file, "as it is", *readGrid(path), {});
  } else if (ending == ".mhd") {
    const auto grid = readMetaImage(path);
    std::cout << row(file, "skin, 500", *grid, 500) << row(file, "bone, 1150", *grid, 1150);
  } else {
    const Mesh mesh = readMesh(path);
    for (const int resolution : kResolutions) {
      VoxelizeOptions options;
      options.voxelSize = extentOf(mesh) / resolution;
      options.exactDistances = false;  // as other programs make volumes of meshes
      std::cout << row(file, std::to_string(resolution), *voxelize(mesh, options), {});
    }
  }
}

void printTable(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::cout
      << "| file | voxelized at | active voxels | triangles | manifold | intersecting pairs | "
         "mesh to surface, voxels | surface to mesh, voxels | seconds |\n"
         "| --- | --- | ---: | ---: | --- | ---: | ---: | ---: | ---: |\n";
  const std::vector<std::string> endings = {".vdb", ".nvdb", ".mhd", ".obj",
                                            ".off", ".stl",  ".ply", ".glb"};
  for (const fs::path& file : files) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::find(endings.begin(), endings.end(), ending) == endings.end()) continue;
    try {
      printRows(file, ending);
    } catch (const Error& error) {
      const std::string name = file.filename().string();
      std::string reason = error.what();
      const auto at = reason.find(file.string());
      if (at != std::string::npos) reason.replace(at, file.string().size(), name);
      std::cout << "| " << name << " | refused: " << reason << " | | | | | | | |\n";
    }
    std::cout << std::flush;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Meshes and checks every file of a folder. Prints a markdown table.");
  std::string folder = TUFA_TEST_DATA;
  app.add_option("FOLDER", folder, "folder of meshes and volumes")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  openvdb::initialize();
  try {
    printTable(folder);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
