#include "polygons/diagonal.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tufa::polygons {
namespace {

using openvdb::Vec3d;

// Distances along the lattice edge that differ by less than this, in voxels, count as equal.
constexpr double kSameDistance = 0.02;
// Sums of 1 - cosine that differ by less than this count as equal.
constexpr double kSameBend = 0.02;

// Squared sine of the smallest angle, near enough: twice the area against the longest side, squared.
double shapeOf(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& normal) {
  const double longest =
      std::max({(b - a).lengthSqr(), (c - b).lengthSqr(), (a - c).lengthSqr()});
  return longest > 0 ? normal.lengthSqr() / (longest * longest) : 0;
}

// One way to split a quad, its diagonal from `corners[0]` to `corners[2]`.
struct Split {
  std::array<Vec3d, 4> corners;
  std::array<Vec3d, 2> normals;  // of the triangles (0, 1, 2) and (0, 2, 3), twice their area long

  explicit Split(const std::array<Vec3d, 4>& c) : corners(c) {
    const Vec3d diagonal = c[2] - c[0];
    normals = {(c[1] - c[0]).cross(diagonal), diagonal.cross(c[3] - c[0])};
  }

  // A triangle faces inward along the lattice edge.
  [[nodiscard]] bool folded(const Vec3d& direction) const {
    return normals[0].dot(direction) <= 0 || normals[1].dot(direction) <= 0;
  }
  // From the crossing to the triangles along the lattice edge, in voxels.
  [[nodiscard]] double distance(const Vec3d& crossing, const Vec3d& direction) const {
    // Seen along the edge, the crossing lies right of the diagonal in the first triangle, else left.
    const Vec3d toCrossing = crossing - corners[0];
    const bool right = (corners[2] - corners[0]).cross(toCrossing).dot(direction) < 0;
    const Vec3d& normal = normals[right ? 0 : 1];
    const double facing = normal.dot(direction);
    return facing != 0 ? std::abs(normal.dot(toCrossing) / facing) : 1;
  }
  [[nodiscard]] double shape() const {
    return std::min(shapeOf(corners[0], corners[1], corners[2], normals[0]),
                    shapeOf(corners[0], corners[2], corners[3], normals[1]));
  }
};

// How far the triangles bend away from the planes of the vertices that lie on one side alone.
double bendAt(const Split& split, const std::array<Vec3d, 4>& normals,
              const std::array<bool, 4>& oneSided) {
  constexpr int kTriangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
  double bend = 0;
  for (int t = 0; t < 2; ++t) {
    const double length = split.normals[t].length();
    if (length == 0) continue;
    for (const int corner : kTriangles[t]) {
      if (oneSided[corner]) bend += 1 - split.normals[t].dot(normals[corner]) / length;
    }
  }
  return bend;
}

std::array<Vec3d, 4> turned(const std::array<Vec3d, 4>& c) { return {c[1], c[2], c[3], c[0]}; }

}  // namespace

bool secondDiagonalIsBetter(const Mesh& mesh, const Quad& quad, const creases::VertexSides& sides,
                            const Position& crossing, const Vec3d& direction) {
  std::array<Vec3d, 4> corners;
  bool crease = false;
  for (int i = 0; i < 4; ++i) {
    const Position& p = mesh.positions[quad.vertices[i]];
    corners[i] = {p.x, p.y, p.z};
    crease |= sides.isSharp(quad.vertices[i]);
  }
  const Split even(corners), odd(turned(corners));
  if (crease) {
    const creases::QuadSides around(mesh, sides, quad);
    const bool fits[2] = {around.fits(false), around.fits(true)};
    if (fits[0] != fits[1]) return fits[1];
    std::array<Vec3d, 4> normals;
    std::array<bool, 4> oneSided{};
    for (int i = 0; i < 4; ++i) {
      const Normal& n = mesh.normals[quad.vertices[i]];
      normals[i] = {n.x, n.y, n.z};
      oneSided[i] = !sides.isSharp(quad.vertices[i]);
    }
    const double bends[2] = {
        bendAt(even, normals, oneSided),
        bendAt(odd, turned(normals), {oneSided[1], oneSided[2], oneSided[3], oneSided[0]})};
    if (std::abs(bends[0] - bends[1]) > kSameBend) return bends[1] < bends[0];
  }
  const bool folds[2] = {even.folded(direction), odd.folded(direction)};
  if (folds[0] != folds[1]) return folds[0];
  const Vec3d surface(crossing.x, crossing.y, crossing.z);
  const double distances[2] = {even.distance(surface, direction),
                               odd.distance(surface, direction)};
  if (std::abs(distances[0] - distances[1]) > kSameDistance) return distances[1] < distances[0];
  return odd.shape() > even.shape();
}

}  // namespace tufa::polygons
