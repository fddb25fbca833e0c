#include "octree/solve_patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tufa::octree {
namespace {

// Vertices keep this distance, in voxels, from the faces of their cell.
constexpr double kMargin = 1e-3;

}  // namespace

Cluster solvePatch(const Patch& patch, const Vec3& corner, int size, const grid::Affine& affine) {
  const PatchPlanes planes = patch.planes.translatedTo(corner + Vec3(0.5 * size));
  const auto half = static_cast<float>(0.5 - kMargin / size);
  uniform::Qef scaled = planes.scaledBy(size);
  // Uniform vertices on creases may lie outside their cells, and so may their mean; solve() expects
  // it inside.
  for (float& sum : scaled.points) sum = std::clamp(sum, -half * scaled.count, half * scaled.count);
  const uniform::Vector point = uniform::solve(scaled, half);
  Cluster cluster;
  Vec3 at;
  for (int i = 0; i < 3; ++i) {
    cluster.point[i] = point[i] * static_cast<float>(size);
    at[i] = static_cast<double>(cluster.point[i]);
  }
  cluster.error = static_cast<float>(std::sqrt(planes.meanSquare(at)));
  const Normal normal = affine.normalOfPlane(planes.normals);
  cluster.normal = {normal.x, normal.y, normal.z};
  // Two normals in one cone differ by at most twice its angle.
  cluster.angle = static_cast<float>(std::min(2 * patch.cone.angle, std::numbers::pi));
  return cluster;
}

}  // namespace tufa::octree
