#include "refine/collapse/sample_lists.h"

#include <algorithm>
#include <limits>

#include "base/flat_triangle.h"

namespace tufa::refine {

namespace {

// A sample is taken as found if its squared distance to a triangle is at most this share of that to
// the nearest corner.
constexpr double kNearShare = 0.05;

}  // namespace

std::uint32_t locateSample(const EdgeMesh& mesh, const Mesh& given, const Sample& sample) {
  const std::size_t polygon = sample.polygon, quads = given.quads.size();
  const Vec3 at(sample.point.x, sample.point.y, sample.point.z);
  std::uint32_t nearest = kNone;
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](std::uint32_t t) {
    const Vec3 &a = mesh.point(mesh.corner(t)), &b = mesh.point(mesh.corner(t + 1)),
               &c = mesh.point(mesh.corner(t + 2));
    const double squared = base::squaredDistanceTo(at, a, b, c);
    if (squared >= least) return;
    least = squared;
    nearest = t;
  };
  const auto lookAround = [&](VertexIndex vertex) {
    mesh.forTriangles(mesh.rootOf(vertex),
                      [&](std::uint32_t t, VertexIndex, VertexIndex) { look(t); });
  };
  const auto lookFrom = [&](const auto& vertices) {
    // Mostly the triangle is one around the nearest corner.
    const auto squaredTo = [&](VertexIndex v) {
      return (mesh.point(mesh.rootOf(v)) - at).squaredLength();
    };
    const VertexIndex corner = *std::min_element(
        vertices.begin(), vertices.end(),
        [&](VertexIndex v, VertexIndex w) { return squaredTo(v) < squaredTo(w); });
    lookAround(corner);
    if (least <= kNearShare * squaredTo(corner)) return;
    std::for_each(vertices.begin(), vertices.end(), lookAround);
  };
  polygon < quads ? lookFrom(given.quads[polygon].vertices)
                  : lookFrom(given.triangles[polygon - quads].vertices);
  return nearest;
}

}  // namespace tufa::refine
