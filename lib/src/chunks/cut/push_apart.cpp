#include "chunks/cut/push_apart.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "chunks/cut/turned.h"

namespace tufa::chunks {
namespace {

constexpr double kMostDepth = 0.02;

// The vertices of a triangle on one side of a plane, and where they go.
struct Push {
  std::vector<std::pair<VertexIndex, Vec3>> moves;
  double depth = kMostDepth;  // of the deepest one; less than that if there are any
};

// Puts the vertices of `moving` on one side of the plane of `other` to the other side, into `least`
// if that is a shorter way.
void findPush(const Triangle& moving, const Triangle& other, const std::vector<Vec3>& points,
              double margin, const std::function<bool(VertexIndex, const Vec3&)>& mayMove,
              Push& least) {
  const Vec3 o = points[other.vertices[0]];
  const Vec3 normal =
      (points[other.vertices[1]] - o).cross(points[other.vertices[2]] - o).unitOrX();
  for (const double side : {1.0, -1.0}) {
    Push push{{}, 0};
    bool isAllowed = true;
    for (const VertexIndex v : moving.vertices) {
      const double height = side * normal.dot(points[v] - o);
      if (has(other, v) || height >= margin) continue;
      const Vec3 to = points[v] + normal * (side * (margin - height));
      push.depth = std::max(push.depth, std::abs(height));
      isAllowed &= mayMove(v, to);
      push.moves.emplace_back(v, to);
    }
    if (isAllowed && !push.moves.empty() && push.depth < least.depth) least = std::move(push);
  }
}

}  // namespace

void pushApart(const std::vector<Triangle>& triangles,
               const std::vector<intersect::PolygonPair>& pairs, double margin,
               const std::function<bool(VertexIndex, const Vec3&)>& mayMove,
               std::vector<Vec3>& points, std::vector<MovedVertex>& changed) {
  std::map<VertexIndex, Vec3> places;
  for (const intersect::PolygonPair& pair : pairs) {
    const Triangle &a = triangles[pair.a], &b = triangles[pair.b];
    Push least;
    findPush(a, b, points, margin, mayMove, least);
    findPush(b, a, points, margin, mayMove, least);
    for (const auto& [v, to] : least.moves) places.emplace(v, to);
  }
  for (const auto& [v, to] : places) {
    changed.push_back({v, (to - points[v]).length()});
    points[v] = to;
  }
}

}  // namespace tufa::chunks
