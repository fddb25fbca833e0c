// How far meshes of the shapes with creases are from the truth, in voxels, and what their triangles
// are like: tufa_accuracy [VOXEL...]

#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "base/job.h"
#include "check/triangle_soup.h"

namespace {

using namespace tufa;

struct Spread {
  std::size_t count = 0, overTenth = 0, overQuarter = 0;
  double most = 0, share999 = 0;
};

Spread spreadOf(std::vector<double> distances) {
  Spread spread;
  spread.count = distances.size();
  if (distances.empty()) return spread;
  std::sort(distances.begin(), distances.end());
  const auto over = [&](double limit) {
    return static_cast<std::size_t>(distances.end() -
                                    std::upper_bound(distances.begin(), distances.end(), limit));
  };
  spread.overTenth = over(0.1);
  spread.overQuarter = over(0.25);
  spread.most = distances.back();
  spread.share999 = distances[distances.size() * 999 / 1000];
  return spread;
}

// At the corners, the middles of the sides and the middle of every triangle.
Spread meshToShape(const Mesh& mesh, Shape shape, double voxel) {
  std::vector<double> distances;
  const auto measure = [&](double x, double y, double z) {
    distances.push_back(std::abs(shapeDistance(shape, {x, y, z})) / voxel);
  };
  for (const Position& p : mesh.positions) measure(p.x, p.y, p.z);
  for (const Triangle& triangle : triangulate(mesh)) {
    const Position& a = mesh.positions[triangle.vertices[0]];
    const Position& b = mesh.positions[triangle.vertices[1]];
    const Position& c = mesh.positions[triangle.vertices[2]];
    measure((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3);
    for (const auto& [p, q] : {std::pair{&a, &b}, std::pair{&b, &c}, std::pair{&c, &a}}) {
      measure((p->x + q->x) / 2, (p->y + q->y) / 2, (p->z + q->z) / 2);
    }
  }
  return spreadOf(std::move(distances));
}

Spread creaseToMesh(const Mesh& mesh, Shape shape, const openvdb::FloatGrid& grid, double voxel) {
  base::Job job(0, {});
  const grid::VoxelFrame frame(grid);
  const checks::TriangleSoup soup(mesh, frame, job);
  std::vector<double> distances;
  std::uint32_t hint = base::Bvh::kNone;
  for (const Position& p : shapeCreasePoints(shape, voxel / 4)) {
    distances.push_back(soup.distance(frame.fromWorld(p), hint));
  }
  return spreadOf(std::move(distances));
}

void print(const char* name, const Spread& s) {
  std::printf("  %s: 99.9%% %.3f, largest %.3f, over 0.1 %.3f%%, over 0.25 %zu of %zu\n", name,
              s.share999, s.most,
              100 * static_cast<double>(s.overTenth) / static_cast<double>(s.count), s.overQuarter,
              s.count);
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  std::vector<double> voxels;
  for (int i = 1; i < argc; ++i) voxels.push_back(std::atof(argv[i]));
  if (voxels.empty()) voxels = {0.005, 0.007, 0.01, 0.0137, 0.02};
  for (const Shape shape : {Shape::Box, Shape::Bracket}) {
    for (const double voxel : voxels) {
      ShapeOptions options;
      options.voxelSize = voxel;
      const auto grid = makeShape(shape, options);
      ContourOptions uniform;
      uniform.uniform = true;
      ContourReport report;
      const Mesh mesh = contour(*grid, uniform, &report);
      const CheckReport checked = check(mesh);
      std::printf(
          "%s at %g: %zu triangles, %zu pairs (%zu found, %zu moved, %zu turned, %zu fanned), "
          "smallest angle %.4f, under 10 degrees %.3f%%\n",
          shape == Shape::Box ? "box" : "bracket", voxel, mesh.triangleCount(),
          checked.selfIntersectingPairs.value_or(0), report.intersectionsFound,
          report.movedVertices, report.flippedDiagonals, report.fannedQuads,
          checked.smallestAngleDegrees, 100 * checked.shareUnder10Degrees);
      print("mesh to shape", meshToShape(mesh, shape, voxel));
      print("crease to mesh", creaseToMesh(mesh, shape, *grid, voxel));
    }
  }
  return 0;
}
