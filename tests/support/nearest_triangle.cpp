#include "support/nearest_triangle.h"

#include <openvdb/math/Proximity.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

namespace tufa::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Corners {
  openvdb::Vec3d at[3];
};

openvdb::Vec3d vec(const Position& p) { return {p.x, p.y, p.z}; }

double distanceTo(const Corners& corners, const openvdb::Vec3d& point) {
  openvdb::Vec3d weights;
  return (openvdb::math::closestPointOnTriangleToPoint(corners.at[0], corners.at[1], corners.at[2],
                                                       point, weights) -
          point)
      .length();
}

// Triangles by the cubes of edge `reach` that they pass, or nearly so.
class Buckets {
 public:
  Buckets(const Mesh& mesh, double reach) : reach_(reach) {
    for (const Triangle& triangle : triangulate(mesh)) {
      Corners corners;
      for (int i = 0; i < 3; ++i) corners.at[i] = vec(mesh.positions[triangle.vertices[i]]);
      openvdb::BBoxd box(corners.at[0], corners.at[0]);
      box.expand(corners.at[1]);
      box.expand(corners.at[2]);
      const openvdb::CoordBBox cells(bucketOf(box.min()), bucketOf(box.max()));
      for (auto cell = cells.begin(); cell; ++cell) {
        const openvdb::Vec3d middle = ((*cell).asVec3d() + 0.5) * reach;
        if (distanceTo(corners, middle) < reach) buckets_[*cell].push_back(corners);
      }
    }
  }

  [[nodiscard]] double distance(const openvdb::Vec3d& point) const {
    double nearest = kInfinity;
    const openvdb::Vec3d reach(reach_);
    const openvdb::CoordBBox around(bucketOf(point - reach), bucketOf(point + reach));
    for (auto cell = around.begin(); cell; ++cell) {
      const auto bucket = buckets_.find(*cell);
      if (bucket == buckets_.end()) continue;
      for (const Corners& c : bucket->second) nearest = std::min(nearest, distanceTo(c, point));
    }
    return nearest <= reach_ ? nearest : kInfinity;
  }

 private:
  [[nodiscard]] openvdb::Coord bucketOf(const openvdb::Vec3d& point) const {
    return openvdb::Coord::floor(point / reach_);
  }

  double reach_;
  std::map<openvdb::Coord, std::vector<Corners>> buckets_;
};

}  // namespace

double largestDistance(const Mesh& from, const Mesh& to, double most) {
  const Buckets buckets(to, most);
  double largest = 0;
  for (const Position& p : from.positions) largest = std::max(largest, buckets.distance(vec(p)));
  for (const Triangle& triangle : triangulate(from)) {
    const auto& v = triangle.vertices;
    openvdb::Vec3d middle(0.0);
    for (int i = 0; i < 3; ++i) {
      const openvdb::Vec3d a = vec(from.positions[v[i]]), b = vec(from.positions[v[(i + 1) % 3]]);
      middle += a / 3;
      largest = std::max(largest, buckets.distance((a + b) / 2));
    }
    largest = std::max(largest, buckets.distance(middle));
  }
  return largest;
}

}  // namespace tufa::test
