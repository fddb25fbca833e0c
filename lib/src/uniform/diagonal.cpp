#include "uniform/diagonal.h"

#include <cmath>

namespace tufa::uniform {
namespace {

// One way to split a quad, its diagonal from a to c.
struct Split {
  Vec3 a, c;
  std::array<Vec3, 2> normals;  // of the triangles (a, b, c) and (a, c, d)

  Split(const Vec3& pa, const Vec3& pb, const Vec3& pc, const Vec3& pd) : a(pa), c(pc) {
    const Vec3 diagonal = pc - pa;
    normals = {(pb - pa).cross(diagonal), diagonal.cross(pd - pa)};
  }
  // A triangle faces inward along the lattice edge.
  [[nodiscard]] bool folded(const Vec3& outward) const {
    return normals[0].dot(outward) <= 0 || normals[1].dot(outward) <= 0;
  }
  // From the crossing to the triangles along the lattice edge, in voxels.
  [[nodiscard]] double distance(const LatticeCrossing& crossing) const {
    // Seen along the edge, the crossing is in the first triangle if it lies right of the diagonal.
    const Vec3 toCrossing = crossing.point - a;
    const bool right = (c - a).cross(toCrossing).dot(crossing.outward) < 0;
    const Vec3& normal = normals[right ? 0 : 1];
    const double facing = normal.dot(crossing.outward);
    return facing != 0 ? std::abs(normal.dot(toCrossing) / facing) : 1;
  }
};

}  // namespace

SplitChooser::SplitChooser(const Mesh& mesh, const Quad& quad, double voxelSize)
    : mesh_(mesh), quad_(quad), voxelSize_(voxelSize) {
  for (int i = 0; i < 4; ++i) {
    const Position& p = mesh.positions[quad.vertices[i]];
    corners_[i] = {p.x, p.y, p.z};
  }
}

bool SplitChooser::compareAt(const LatticeCrossing& crossing) const {
  const Split even(corners_[0], corners_[1], corners_[2], corners_[3]);
  const Split odd(corners_[1], corners_[2], corners_[3], corners_[0]);
  const bool folds[2] = {even.folded(crossing.outward), odd.folded(crossing.outward)};
  if (folds[0] != folds[1]) return folds[0];
  const double distances[2] = {even.distance(crossing), odd.distance(crossing)};
  if (std::abs(distances[0] - distances[1]) > kSameDistance) return distances[1] < distances[0];
  return isSecondShorter();
}

}  // namespace tufa::uniform
