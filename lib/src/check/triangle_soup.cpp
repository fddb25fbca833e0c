#include "check/triangle_soup.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "check/faces.h"

namespace tufa::checks {
namespace {

std::vector<Vec3> pointsOf(const Mesh& mesh, const grid::VoxelFrame& frame) {
  std::vector<Vec3> points(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), points.begin(),
                 [&](const Position& p) { return frame.fromWorld(p); });
  return points;
}

std::vector<Triangle> validTriangles(const Mesh& mesh) {
  std::vector<Triangle> triangles = triangulate(mesh);
  std::erase_if(triangles, [&](const Triangle& t) { return !isValid(t, mesh.positions); });
  return triangles;
}

double segmentDistanceSquared(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = along.squaredLength();
  const double t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (p - a - along * t).squaredLength();
}

/// Correct for triangles without area too: these are their edges.
double triangleDistanceSquared(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double size = normal.squaredLength();
  const bool beyondAb = (b - a).cross(p - a).dot(normal) < 0;
  const bool beyondBc = (c - b).cross(p - b).dot(normal) < 0;
  const bool beyondCa = (a - c).cross(p - c).dot(normal) < 0;
  if (size > 0 && !beyondAb && !beyondBc && !beyondCa) {
    const double height = (p - a).dot(normal);
    return height * height / size;
  }
  double least = std::numeric_limits<double>::infinity();
  if (!(size > 0) || beyondAb) least = std::min(least, segmentDistanceSquared(p, a, b));
  if (!(size > 0) || beyondBc) least = std::min(least, segmentDistanceSquared(p, b, c));
  if (!(size > 0) || beyondCa) least = std::min(least, segmentDistanceSquared(p, c, a));
  return least;
}

}  // namespace

TriangleSoup::TriangleSoup(const Mesh& mesh, const grid::VoxelFrame& frame, base::Job& job)
    : points_(pointsOf(mesh, frame)), triangles_(validTriangles(mesh)), tree_(boxes(job), job) {}

std::vector<Box> TriangleSoup::boxes(base::Job& job) const {
  std::vector<Box> result(triangles_.size());
  job.forRanges(result.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      result[t] = Box::empty();
      for (const VertexIndex v : triangles_[t].vertices) result[t].add(points_[v]);
    }
  });
  return result;
}

std::vector<VertexIndex> TriangleSoup::usedVertices() const {
  std::vector<bool> isUsed(points_.size());
  for (const Triangle& triangle : triangles_) {
    for (const VertexIndex v : triangle.vertices) isUsed[v] = true;
  }
  std::vector<VertexIndex> used;
  for (std::size_t v = 0; v < isUsed.size(); ++v) {
    if (isUsed[v]) used.push_back(static_cast<VertexIndex>(v));
  }
  return used;
}

double TriangleSoup::distanceSquared(const Vec3& from, std::uint32_t triangle) const {
  const auto& v = triangles_[triangle].vertices;
  return triangleDistanceSquared(from, points_[v[0]], points_[v[1]], points_[v[2]]);
}

double TriangleSoup::distance(const Vec3& from, std::uint32_t& hint) const {
  double best =
      hint == Bvh::kNone ? std::numeric_limits<double>::infinity() : distanceSquared(from, hint);
  const std::uint32_t found = tree_.nearest(
      from, best, [&](std::uint32_t triangle) { return distanceSquared(from, triangle); });
  if (found != Bvh::kNone) hint = found;
  return std::sqrt(best);
}

}  // namespace tufa::checks
