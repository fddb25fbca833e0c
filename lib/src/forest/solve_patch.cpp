#include "forest/solve_patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tufa::forest {
namespace {

// Vertices keep this distance, in voxels, from the faces of their cell.
constexpr double kMargin = 1e-3;

}  // namespace

Cluster solvePatch(const Patch& patch, const openvdb::Vec3d& corner, int size,
                   const base::Affine& affine) {
  const Quadric planes = patch.planes.seenFrom(corner + openvdb::Vec3d(0.5 * size));
  const auto half = static_cast<float>(0.5 - kMargin / size);
  qef::Qef scaled = planes.scaledBy(size);
  // A vertex of the base mesh on a crease may lie outside its cell, and so their mean.
  for (float& sum : scaled.points) sum = std::clamp(sum, -half * scaled.count, half * scaled.count);
  const qef::Vector point = qef::solve(scaled, half);
  Cluster cluster;
  openvdb::Vec3d at;
  for (int i = 0; i < 3; ++i) {
    cluster.point[i] = point[i] * static_cast<float>(size);
    at[i] = static_cast<double>(cluster.point[i]);
  }
  cluster.error = static_cast<float>(std::sqrt(planes.meanSquare(at)));
  const Normal normal = affine.normalOfPlane(planes.normals);
  cluster.normal = {normal.x, normal.y, normal.z};
  cluster.angle = static_cast<float>(std::min(2 * patch.cone.angle, std::numbers::pi));
  return cluster;
}

}  // namespace tufa::forest
