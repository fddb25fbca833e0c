#include "refine/collapse/ring.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tufa::refine {

namespace {

// Least cosine between the normals of a triangle before and after: 60 degrees.
constexpr double kLeastTurn = 0.5;
// A triangle no rounder than this has no meaningful normal: then the least cosine between its new
// normal and that of the surface counts.
constexpr double kSliver = 0.05;
constexpr double kLeastFacing = 0.3;
// Least cosine between the normals of two triangles at an edge.
constexpr double kFold = -0.3;
// Triangles must be this round (1: equilateral), or not worse than this share of the worst one
// before.
constexpr double kRound = 0.1;
constexpr double kWorse = 0.5;

double roundnessOf(double twiceArea, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double squares =
      (b - a).squaredLength() + (c - b).squaredLength() + (a - c).squaredLength();
  return squares > 0 ? 2 * std::sqrt(3.0) * twiceArea / squares : 0;
}

// Whether two vectors form an angle of at least this cosine.
bool isWithin(const Vec3& a, const Vec3& b, double cosine) {
  const double along = a.dot(b);
  return along > 0 && along * along >= cosine * cosine * a.squaredLength() * b.squaredLength();
}

}  // namespace

double roundness(const Vec3& a, const Vec3& b, const Vec3& c) {
  return roundnessOf((b - a).cross(c - a).length(), a, b, c);
}

bool Ring::collect(const EdgeMesh& mesh, VertexIndex a, VertexIndex b, const Vec3& point,
                   const Vec3& facing) {
  shapes_.clear();
  triangles_.clear();
  edges_.clear();
  star_.clear();
  double before = 1, after = 1;
  bool upright = true;
  const auto take = [&](VertexIndex own, VertexIndex other) {
    const Vec3& p = mesh.point(own);
    mesh.forTriangles(own, [&](std::uint32_t t, VertexIndex x, VertexIndex y) {
      if (!upright) return;
      const Vec3& px = mesh.point(x);
      const Vec3& py = mesh.point(y);
      const Vec3 was = (px - p).cross(py - p);
      const double round = roundnessOf(was.length(), p, px, py);
      before = std::min(before, round);
      if (x == other || y == other) {
        if (own < other) star_.push_back(t);
        return;
      }
      star_.push_back(t);
      triangles_.push_back(t);
      edges_.push_back({x, y});
      const Vec3 is = (px - point).cross(py - point);
      after = std::min(after, roundnessOf(is.length(), point, px, py));
      upright &= isWithin(was, is, kLeastTurn) ||
                 ((round < kSliver || !isWithin(facing, was, kLeastFacing)) &&
                  isWithin(facing, is, kLeastFacing));
    });
  };
  take(a, b);
  take(b, a);
  if (!upright || after < std::min(kRound, kWorse * before)) return false;
  for (const auto& [x, y] : edges_) shapes_.emplace_back(point, mesh.point(x), mesh.point(y));
  return true;
}

bool Ring::staysUnfolded(const EdgeMesh& mesh) const {
  double after = 1;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const auto [x, y] = edges_[i];
    const Vec3& own = shapes_[i].normal();
    for (std::size_t j = 0; j < i; ++j) {
      if (edges_[j][0] == y || edges_[j][1] == x)
        after = std::min(after, own.dot(shapes_[j].normal()));
    }
    after = std::min(after, own.dot(normalAcross(mesh, x, y, own)));
  }
  return after > kFold || after >= sharpest(mesh);
}

// The least cosine between the normals of two triangles at an edge, as the triangles are.
double Ring::sharpest(const EdgeMesh& mesh) const {
  double least = 1;
  for (const std::uint32_t t : star_) {
    const VertexIndex v[3] = {mesh.corner(t), mesh.corner(t + 1), mesh.corner(t + 2)};
    const base::FlatTriangle shape(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]));
    for (int i = 0; i < 3; ++i) {
      const Vec3 across = normalAcross(mesh, v[i], v[(i + 1) % 3], shape.normal());
      least = std::min(least, shape.normal().dot(across));
    }
  }
  return least;
}

Vec3 Ring::normalAcross(const EdgeMesh& mesh, VertexIndex x, VertexIndex y, const Vec3& own) {
  Vec3 normal = own;
  mesh.forTriangles(y, [&](std::uint32_t, VertexIndex next, VertexIndex last) {
    if (next != x) return;
    Vec3 found = (mesh.point(x) - mesh.point(y)).cross(mesh.point(last) - mesh.point(y));
    if (found.normalize()) normal = found;
  });
  return normal;
}

bool Ring::isNear(const Vec3& point, double enough) const {
  return std::any_of(shapes_.begin(), shapes_.end(), [&](const base::FlatTriangle& shape) {
    return shape.squaredHeight(point) <= enough && shape.squaredDistance(point) <= enough;
  });
}

std::pair<std::size_t, double> Ring::nearest(const Vec3& point, std::size_t first,
                                             double enough) const {
  std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
  if (double squared = 0; shapes_[first].isAbove(point, squared) && squared <= enough) {
    return {first, squared};
  }
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    double squared = 0;
    if (shapes_[i].isAbove(point, squared) && squared < best.second) best = {i, squared};
  }
  if (!std::isinf(best.second)) return best;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (shapes_[i].squaredHeight(point) >= best.second) continue;
    const double squared = shapes_[i].squaredDistance(point);
    if (squared < best.second) best = {i, squared};
  }
  return best;
}

}  // namespace tufa::refine
