// The tables of docs/which-method.md: every way to mesh that compareMethods() knows, on four
// volumes. Prints rows of Markdown.

#include <openvdb/openvdb.h>

#include <tufa/compare.h>
#include <tufa/shapes.h>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "meta_image.h"
#include "table_text.h"

namespace {

using namespace tufa;
using bench::count;
using bench::number;

std::string short3(double value) { return number("%.3g", value); }

std::string distances(const DistanceSummary& side) {
  return side.samples == 0 ? "-" : short3(side.largest) + " / " + short3(side.rms);
}

// What a mesh should be and is not.
std::string faults(const CheckReport& check) {
  std::string text;
  if (!check.closed) text += count(check.boundaryEdges) + " open edges";
  const std::size_t broken = check.nonManifoldEdges + check.nonManifoldVertices;
  if (broken > 0) text += (text.empty() ? "" : ", ") + count(broken) + " not manifold";
  return text.empty() ? "none" : text;
}

void printTable(const std::string& name, const std::string& what, const openvdb::FloatGrid& grid,
                const CompareOptions& options) {
  const Comparison all = compareMethods(grid, options);
  const bool truth = options.truth != nullptr;
  std::cout << "\n### " << what << "\n\n"
            << count(all.activeVoxels)
            << " active voxels. The trilinear isosurface has the Euler characteristic "
            << all.trilinearEuler << ".\n\n"
            << "| method | triangles | faults | pairs | Euler | to surface | from surface | "
            << (truth ? "to truth | creases | " : "") << "under 10° | CPU ms | MB |\n"
            << "| --- | ---: | --- | ---: | ---: | ---: | ---: | "
            << (truth ? "---: | ---: | " : "") << "---: | ---: | ---: |\n";
  for (const MethodResult& one : all.methods) {
    const CheckReport& check = one.check;
    std::cout << "| " << name << ", " << one.name << " | " << count(check.triangles) << " | "
              << faults(check) << " | " << count(check.selfIntersectingPairs.value_or(0)) << " | "
              << check.eulerCharacteristic << " | " << distances(one.distance.meshToSurface)
              << " | " << distances(one.distance.surfaceToMesh) << " | ";
    if (truth) {
      const bool creases = one.truth->pointsToMesh.samples > 0;
      std::cout << distances(one.truth->meshToTruth) << " | "
                << (creases ? short3(one.truth->pointsShare99) : "-") << " | ";
    }
    std::cout << short3(100 * check.shareUnder10Degrees) << "% | " << short3(1000 * one.cpuSeconds)
              << " | "
              << (one.extraBytes ? short3(static_cast<double>(*one.extraBytes) / 1e6) : "-") << " |"
              << std::endl;
  }
}

void printShape(Shape shape, const std::string& what, CompareOptions options) {
  ShapeOptions making;
  const auto grid = makeShape(shape, making);
  options.truth = [shape](const Position& p) { return shapeDistance(shape, p); };
  options.truthPoints = shapeCreasePoints(shape, making.voxelSize / 4);
  printTable(std::string(shapeNames().at(static_cast<std::size_t>(shape))), what, *grid, options);
}

// A corner of the demonstration volume: all of it takes some methods minutes.
void printNoise(int size, const CompareOptions& options) {
  const auto whole = makeShape(Shape::Noise);
  const auto part = openvdb::FloatGrid::create(whole->background());
  part->setTransform(whole->transformPtr());
  const openvdb::Coord first(-32);
  auto from = whole->getConstAccessor();
  auto to = part->getAccessor();
  for (auto at = openvdb::CoordBBox(first, first.offsetBy(size - 1)).begin(); at; ++at) {
    to.setValue(*at, from.getValue(*at));
  }
  CompareOptions atZero = options;
  atZero.extract.contour.isovalue = 0;
  const std::string samples = std::to_string(size) + "³ samples";
  printTable("noise", "White noise, " + samples, *part, atZero);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares all methods on four volumes. Prints Markdown.");
  std::string folder = TUFA_TEST_DATA;
  CompareOptions options;
  options.repeats = 3;
  options.memory = true;
  app.add_option("FOLDER", folder, "folder of headsq_ct.mhd")->capture_default_str();
  app.add_option("--threads", options.extract.contour.threads, "most threads")
      ->capture_default_str();
  app.add_option("--repeats", options.repeats, "timed runs of each method")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  openvdb::initialize();
  try {
    printShape(Shape::Bracket, "The bracket, 0.02 units a voxel", options);
    printShape(Shape::Gyroid, "The gyroid, 0.02 units a voxel", options);
    const auto head = std::filesystem::path(folder) / "headsq_ct.mhd";
    if (std::filesystem::exists(head)) {
      CompareOptions skin = options;
      skin.extract.contour.isovalue = 500;
      printTable("head", "The CT head, skin at 500", *bench::readMetaImage(head), skin);
    } else {
      std::cerr << head << " is missing: left out\n";
    }
    printNoise(24, options);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
