// Chains of levels of detail, made by Tufa and in the usual way: volumeToMesh at adaptivity 0, then
// meshoptimizer's simplify from each level to the next, to as many triangles. Prints Markdown
// tables: tufa_lod_table [--millions M] SHAPE|MESH|VDB...
//
// All on one thread; times are of the CPU. Errors are in voxels, both ways, and measured alike:
// against the trilinear isosurface, by checkAgainst(); against the uniform mesh that each chain is
// made of, which is what the reduction alone does; and for shapes against the true surface.

#include <meshoptimizer.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/task_arena.h>

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <limits>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "volumes.h"

namespace {

using namespace tufa;

// Points on each side of a triangle at which it is measured against the true surface.
constexpr int kSide = 6;

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Chain {
  std::vector<Mesh> levels;
  Mesh uniform;  // what they are made of
  double seconds = 0;
};

// A chain by tolerances, and how long its first level alone takes.
struct OwnChain : Chain {
  ContourReport report;
  double levelSeconds = 0;
};

OwnChain ownChain(const openvdb::FloatGrid& grid) {
  OwnChain chain;
  LodOptions options;
  options.contour.threads = 1;
  double start = cpuSeconds();
  LodChain lods = buildLods(grid, options, &chain.report);
  chain.seconds = cpuSeconds() - start;
  for (Lod& lod : lods.levels) chain.levels.push_back(std::move(lod.mesh));
  start = cpuSeconds();
  (void)contour(grid, options.contour);
  chain.levelSeconds = cpuSeconds() - start;
  options.contour.uniform = true;
  chain.uniform = contour(grid, options.contour);
  return chain;
}

// The vertices that some triangles of `points` use.
Mesh meshOf(const std::vector<openvdb::Vec3s>& points, const std::vector<unsigned>& corners) {
  Mesh mesh;
  std::vector<unsigned> numbers(points.size(), ~0U);
  const auto number = [&](unsigned vertex) {
    if (numbers[vertex] == ~0U) {
      numbers[vertex] = static_cast<unsigned>(mesh.positions.size());
      const openvdb::Vec3s& p = points[vertex];
      mesh.positions.emplace_back(p[0], p[1], p[2]);
    }
    return numbers[vertex];
  };
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const unsigned a = number(corners[i]), b = number(corners[i + 1]), c = number(corners[i + 2]);
    mesh.triangles.emplace_back(a, b, c);
  }
  return mesh;
}

// As many triangles in each level as the other chain has. Triangles of volumeToMesh are the other
// way round.
Chain usualChain(const openvdb::FloatGrid& grid, const OwnChain& own) {
  const double start = cpuSeconds();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, own.report.isovalue, 0.0);
  std::vector<unsigned> corners;
  for (const openvdb::Vec3I& t : triangles) corners.insert(corners.end(), {t[2], t[1], t[0]});
  for (const openvdb::Vec4I& q : quads) {
    corners.insert(corners.end(), {q[3], q[2], q[1], q[3], q[1], q[0]});
  }
  const std::vector<unsigned> uniform = corners;
  std::vector<std::vector<unsigned>> levels;
  for (const Mesh& level : own.levels) {
    std::vector<unsigned> next(corners.size());
    next.resize(meshopt_simplify(next.data(), corners.data(), corners.size(), points[0].asPointer(),
                                 points.size(), sizeof(openvdb::Vec3s), 3 * level.triangleCount(),
                                 std::numeric_limits<float>::max(), 0, nullptr));
    levels.push_back(next);
    corners = std::move(next);
  }
  Chain chain;
  chain.seconds = cpuSeconds() - start;
  for (const std::vector<unsigned>& level : levels) chain.levels.push_back(meshOf(points, level));
  chain.uniform = meshOf(points, uniform);
  return chain;
}

struct Spread {
  double largest = 0, rms = 0;
};

Spread worse(const Spread& a, const Spread& b) {
  return {std::max(a.largest, b.largest), std::max(a.rms, b.rms)};
}

Spread toIsosurface(const Mesh& mesh, const openvdb::FloatGrid& grid) {
  const DistanceReport report = checkAgainst(mesh, grid);
  return worse({report.meshToSurface.largest, report.meshToSurface.rms},
               {report.surfaceToMesh.largest, report.surfaceToMesh.rms});
}

// Points spread over a mesh by area, the same for the same mesh.
std::vector<Position> samplesOf(const Mesh& mesh) {
  constexpr int kSamples = 200000;
  std::vector<double> weights;
  const std::vector<Triangle> triangles = triangulate(mesh);
  const auto corner = [&](const Triangle& t, std::size_t i) {
    const Position& at = mesh.positions[t.vertices[i]];
    return openvdb::Vec3d(at.x, at.y, at.z);
  };
  for (const Triangle& t : triangles) {
    const openvdb::Vec3d a = corner(t, 0);
    weights.push_back((corner(t, 1) - a).cross(corner(t, 2) - a).length());
  }
  std::mt19937 random(1);
  std::discrete_distribution<std::size_t> pick(weights.begin(), weights.end());
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Position> points;
  for (int i = 0; i < kSamples; ++i) {
    const Triangle& t = triangles[pick(random)];
    double u = unit(random), v = unit(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const openvdb::Vec3d at = corner(t, 0) * (1 - u - v) + corner(t, 1) * u + corner(t, 2) * v;
    points.push_back({at[0], at[1], at[2]});
  }
  return points;
}

// Each triangle counts by its area.
Spread meshToShape(const Mesh& mesh, Shape shape, double voxel) {
  Spread spread;
  double sum = 0, weights = 0;
  for (const Triangle& triangle : triangulate(mesh)) {
    openvdb::Vec3d p[3];
    for (int i = 0; i < 3; ++i) {
      const Position& at = mesh.positions[triangle.vertices[i]];
      p[i] = {at.x, at.y, at.z};
    }
    const double area = (p[1] - p[0]).cross(p[2] - p[0]).length();
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; i + j < kSide; ++j) {
        const openvdb::Vec3d at =
            p[0] + (p[1] - p[0]) * (i / (kSide - 1.0)) + (p[2] - p[0]) * (j / (kSide - 1.0));
        const double distance = std::abs(shapeDistance(shape, {at[0], at[1], at[2]})) / voxel;
        spread.largest = std::max(spread.largest, distance);
        sum += area * distance * distance;
        weights += area;
      }
    }
  }
  spread.rms = weights > 0 ? std::sqrt(sum / weights) : 0;
  return spread;
}

// Points of the true surface: vertices of a uniform mesh that lie on it.
std::vector<Position> pointsOn(const openvdb::FloatGrid& grid, Shape shape, double voxel) {
  ContourOptions options;
  options.uniform = true;
  std::vector<Position> points;
  for (const Position& p : contour(grid, options).positions) {
    if (std::abs(shapeDistance(shape, p)) < 0.01 * voxel) points.push_back(p);
  }
  return points;
}

Spread pointsToMesh(const Mesh& mesh, const std::vector<Position>& points, double voxel) {
  Spread spread;
  double sum = 0;
  for (const double world : distancesTo(mesh, points)) {
    spread.largest = std::max(spread.largest, world / voxel);
    sum += world * world;
  }
  spread.rms = std::sqrt(sum / static_cast<double>(points.size())) / voxel;
  return spread;
}

Spread toUniform(const Mesh& mesh, const Mesh& uniform, double voxel) {
  return worse(pointsToMesh(mesh, samplesOf(uniform), voxel),
               pointsToMesh(uniform, samplesOf(mesh), voxel));
}

std::string number(double value) {
  std::ostringstream text;
  text << std::setprecision(3) << value;
  return text.str();
}

// What was asked of both, and how many times theirs ours is.
std::string both(double theirs, double ours) {
  return number(theirs) + " / " + number(ours) + " / " + number(ours / theirs);
}

void printLevel(const std::string& name, const openvdb::FloatGrid& grid, const Shape* shape,
                const std::vector<Position>& points, const Chain& usual, const Chain& own,
                std::size_t level) {
  const double voxel = grid.voxelSize()[0];
  const Mesh &theirs = usual.levels[level], &ours = own.levels[level];
  const Spread start[2] = {toUniform(theirs, usual.uniform, voxel),
                           toUniform(ours, own.uniform, voxel)};
  const Spread iso[2] = {toIsosurface(theirs, grid), toIsosurface(ours, grid)};
  const CheckReport checks[2] = {check(theirs), check(ours)};
  std::cout << "| " << name << " | " << theirs.triangleCount() << " / " << ours.triangleCount()
            << " | " << both(iso[0].largest, iso[1].largest) << " | "
            << both(iso[0].rms, iso[1].rms) << " | " << both(start[0].largest, start[1].largest)
            << " | " << both(start[0].rms, start[1].rms) << " | ";
  if (shape) {
    const auto measure = [&](const Mesh& mesh) {
      return worse(meshToShape(mesh, *shape, voxel), pointsToMesh(mesh, points, voxel));
    };
    const Spread truth[2] = {measure(theirs), measure(ours)};
    std::cout << both(truth[0].largest, truth[1].largest) << " | "
              << both(truth[0].rms, truth[1].rms) << " | ";
  } else {
    std::cout << "| | ";
  }
  std::cout << number(checks[0].smallestAngleDegrees) << " / "
            << number(checks[1].smallestAngleDegrees) << " | " << checks[0].nonManifoldEdges
            << " / " << checks[1].nonManifoldEdges << " | "
            << checks[0].selfIntersectingPairs.value_or(0) << " / "
            << checks[1].selfIntersectingPairs.value_or(0) << " |" << std::endl;
}

std::string printVolume(const std::string& volume, double millions) {
  const std::filesystem::path path(volume);
  const openvdb::FloatGrid::Ptr grid =
      path.extension() == ".vdb" ? openvdb::gridPtrCast<openvdb::FloatGrid>(readGrid(volume))
                                 : bench::makeVolume(volume, millions * 1e6);
  if (!grid) return "";
  const std::string name = path.stem().string();
  // The fields of the others are not distances.
  const std::optional<Shape> named = shapeByName(name);
  const bool isDistance = named && *named != Shape::Gyroid && *named != Shape::Terrain;
  const Shape* const shape = isDistance ? &*named : nullptr;
  const OwnChain own = ownChain(*grid);
  const Chain usual = usualChain(*grid, own);
  std::vector<Position> points;
  if (shape) points = pointsOn(*grid, *shape, grid->voxelSize()[0]);
  for (std::size_t i = 0; i < own.levels.size(); ++i) {
    printLevel(name, *grid, shape, points, usual, own, i);
  }
  return "| " + name + " | " + number(static_cast<double>(grid->activeVoxelCount()) * 1e-6) +
         " | " + std::to_string(own.levels.size()) + " | " + both(usual.seconds, own.seconds) +
         " | " + number(own.seconds / own.levelSeconds) + " |\n";
}

void run(const std::vector<std::string>& volumes, double millions) {
  std::cout
      << "Each cell: the usual way / Tufa, and how many times the former the latter is.\n\n"
         "| volume | triangles | largest | rms | largest, own uniform mesh | rms, own uniform "
         "mesh | largest, true surface | rms, true surface | smallest angle | non-manifold "
         "edges | pairs |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  std::string times;
  for (const std::string& volume : volumes) times += printVolume(volume, millions);
  std::cout << "\n| volume | active voxels, millions | levels | CPU seconds of the chain | Tufa's "
               "chain over its level 0 alone |\n"
               "| --- | ---: | ---: | --- | ---: |\n"
            << times;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares chains of levels of detail. Prints Markdown tables.");
  std::vector<std::string> volumes;
  double millions = 1;
  app.add_option("VOLUME", volumes, "shapes, mesh files to voxelize, or level sets in .vdb files")
      ->required();
  app.add_option("--millions", millions, "active voxels of shapes and meshes")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  openvdb::initialize();
  try {
    tbb::task_arena(1).execute([&] { run(volumes, millions); });
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
