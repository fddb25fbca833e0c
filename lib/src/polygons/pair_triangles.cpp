#include <tufa/error.h>
#include <tufa/quads.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/polygons.h"
#include "base/vec3.h"

namespace tufa {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// Cosine of 20 degrees.
constexpr double kFlat = 0.94;
// Cosine of 15 degrees: corners of quads are between that and 165 degrees.
constexpr double kStraight = 0.966;
// A vertex of fewer edges would have two faces that share two edges.
constexpr std::uint32_t kLeastEdges = 3;

// Two triangles that may make a quad.
struct Candidate {
  std::array<std::uint32_t, 2> triangles;
  Quad quad;
  double worst;  // largest cosine of its corners, 0 for a rectangle
};

struct Edge {
  VertexIndex low, high;
  std::uint32_t triangle;  // kNone: of another face
  std::uint8_t corner;     // the one opposite the edge
};

class Pairing {
 public:
  Pairing(Mesh& mesh, double mostWarp)
      : mesh_(mesh), mostWarp_(mostWarp), edgesAt_(mesh.positions.size()) {}

  std::size_t run() {
    findCandidates();
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.worst < b.worst; });
    candidatesAt_.assign(mesh_.triangles.size(), {kNone, kNone, kNone});
    chosenAt_.assign(mesh_.triangles.size(), kNone);
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      for (const std::uint32_t triangle : candidates_[i].triangles) {
        auto& own = candidatesAt_[triangle];
        *std::find(own.begin(), own.end(), kNone) = i;
      }
    }
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      if (isFree(i)) choose(i);
    }
    while (exchangeAll()) continue;
    return write();
  }

 private:
  [[nodiscard]] Vec3 pointOf(VertexIndex vertex) const { return Vec3(mesh_.positions[vertex]); }

  void findCandidates() {
    std::vector<Edge> edges;
    edges.reserve(3 * mesh_.triangles.size() + 4 * mesh_.quads.size());
    const auto add = [&](VertexIndex a, VertexIndex b, std::uint32_t triangle, int corner) {
      edges.push_back(
          {std::min(a, b), std::max(a, b), triangle, static_cast<std::uint8_t>(corner)});
    };
    for (const Quad& quad : mesh_.quads) {
      for (std::size_t i = 0; i < 4; ++i)
        add(quad.vertices[i], quad.vertices[(i + 1) % 4], kNone, 0);
    }
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& v = mesh_.triangles[t].vertices;
      for (std::size_t i = 0; i < 3; ++i)
        add(v[(i + 1) % 3], v[(i + 2) % 3], t, static_cast<int>(i));
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tuple(a.low, a.high, a.triangle) < std::tuple(b.low, b.high, b.triangle);
    });
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
      while (next < edges.size() && edges[next].low == edges[i].low &&
             edges[next].high == edges[i].high) {
        ++next;
      }
      ++edgesAt_[edges[i].low], ++edgesAt_[edges[i].high];
      if (next == i + 2 && edges[i + 1].triangle != kNone) propose(edges[i], edges[i + 1]);
    }
  }

  // The quad runs from the start of the shared edge, as its first triangle has it, around the
  // second triangle.
  void propose(const Edge& first, const Edge& second) {
    if (first.triangle == kNone) return;
    const auto& a = mesh_.triangles[first.triangle].vertices;
    const auto& b = mesh_.triangles[second.triangle].vertices;
    const VertexIndex from = a[(first.corner + 1U) % 3], to = a[(first.corner + 2U) % 3];
    const VertexIndex left = a[first.corner], right = b[second.corner];
    // Neither on a mesh that is not oriented, nor of two faces back to back.
    if (b[(second.corner + 1U) % 3] != to || left == right) return;
    const Quad quad(from, right, to, left);
    const double worst = worstCorner(quad);
    if (worst < kStraight && isFlat(quad)) {
      candidates_.push_back({{first.triangle, second.triangle}, quad, worst});
    }
  }

  // The largest cosine of a corner; 1 where the quad is not convex, seen along its normal.
  [[nodiscard]] double worstCorner(const Quad& quad) const {
    const auto& v = quad.vertices;
    const Vec3 normal =
        (pointOf(v[2]) - pointOf(v[0])).cross(pointOf(v[3]) - pointOf(v[1])).unitOrX();
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 before = pointOf(v[(i + 3) % 4]) - pointOf(v[i]);
      const Vec3 after = pointOf(v[(i + 1) % 4]) - pointOf(v[i]);
      if (!(after.cross(before).dot(normal) > 0)) return 1;
      worst = std::max(worst, std::abs(before.dot(after)) / (before.length() * after.length()));
    }
    return worst;
  }

  [[nodiscard]] bool isFlat(const Quad& quad) const {
    const auto& v = quad.vertices;
    const Vec3 a = pointOf(v[0]), b = pointOf(v[1]), c = pointOf(v[2]), d = pointOf(v[3]);
    const Vec3 one = (b - a).cross(c - a), other = (c - a).cross(d - a);
    if (!(one.dot(other) > kFlat * one.length() * other.length())) return false;
    // The diagonals of a convex quad pass each other at the distance of the lines that hold them.
    const Vec3 across = (c - a).cross(d - b);
    return std::abs(across.dot(b - a)) <= mostWarp_ * across.length();
  }

  [[nodiscard]] bool keepsEdges(const Candidate& candidate) const {
    const auto& v = candidate.quad.vertices;
    return edgesAt_[v[0]] > kLeastEdges && edgesAt_[v[2]] > kLeastEdges;
  }
  [[nodiscard]] bool isFree(std::uint32_t candidate) const {
    const auto& [a, b] = candidates_[candidate].triangles;
    return chosenAt_[a] == kNone && chosenAt_[b] == kNone && keepsEdges(candidates_[candidate]);
  }
  void set(std::uint32_t candidate, std::uint32_t value, std::uint32_t edges) {
    for (const std::uint32_t triangle : candidates_[candidate].triangles)
      chosenAt_[triangle] = value;
    const auto& v = candidates_[candidate].quad.vertices;
    edgesAt_[v[0]] += edges, edgesAt_[v[2]] += edges;
  }
  void choose(std::uint32_t candidate) { set(candidate, candidate, ~std::uint32_t{0}); }
  void release(std::uint32_t candidate) { set(candidate, kNone, 1); }

  // Whether a single triangle was paired: with a single neighbour, or with one half of a pair whose
  // other half then pairs with a single one.
  bool exchangeAll() {
    bool any = false;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (chosenAt_[t] == kNone) any |= pairOne(t);
    }
    return any;
  }

  bool pairOne(std::uint32_t single) {
    for (const std::uint32_t first : candidatesAt_[single]) {
      if (first == kNone) break;
      if (isFree(first)) return choose(first), true;
      const std::uint32_t taken = otherOf(first, single);
      const std::uint32_t pair = chosenAt_[taken];
      if (pair == kNone) continue;
      const std::uint32_t left = otherOf(pair, taken);
      release(pair);
      if (isFree(first)) {
        choose(first);
        for (const std::uint32_t second : candidatesAt_[left]) {
          if (second == kNone) break;
          if (second != pair && isFree(second)) return choose(second), true;
        }
        release(first);
      }
      choose(pair);
    }
    return false;
  }

  [[nodiscard]] std::uint32_t otherOf(std::uint32_t candidate, std::uint32_t triangle) const {
    const auto& [a, b] = candidates_[candidate].triangles;
    return a == triangle ? b : a;
  }

  std::size_t write() {
    const std::size_t before = mesh_.quads.size();
    std::vector<Triangle> left;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (chosenAt_[t] == kNone) {
        left.push_back(mesh_.triangles[t]);
      } else if (const Candidate& pair = candidates_[chosenAt_[t]]; pair.triangles[0] == t) {
        mesh_.quads.push_back(pair.quad);
      }
    }
    mesh_.triangles = std::move(left);
    return mesh_.quads.size() - before;
  }

  Mesh& mesh_;
  double mostWarp_;
  std::vector<std::uint32_t> edgesAt_;  // of each vertex
  std::vector<Candidate> candidates_;
  std::vector<std::array<std::uint32_t, 3>> candidatesAt_;  // of each triangle
  std::vector<std::uint32_t> chosenAt_;                     // the candidate of each triangle
};

}  // namespace

std::size_t pairTriangles(Mesh& mesh, double mostWarp) {
  if (!(mostWarp >= 0)) {
    throw Error(ErrorCode::InvalidArgument,
                "the distance between the diagonals of a quad must be 0 or more");
  }
  base::forPolygons(mesh, [&](base::PolygonIndex polygon, base::Corners corners) {
    for (const VertexIndex vertex : corners) {
      if (vertex < mesh.positions.size()) continue;
      throw Error(ErrorCode::InvalidArgument, "face " + std::to_string(polygon) + " has vertex " +
                                                  std::to_string(vertex) + ", and the mesh has " +
                                                  std::to_string(mesh.positions.size()));
    }
  });
  return Pairing(mesh, mostWarp).run();
}

}  // namespace tufa
