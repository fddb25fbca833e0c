#include "check/faces.h"

#include <cmath>
#include <numeric>
#include <tuple>

#include "base/parallel_sort.h"
#include "check/exact.h"

namespace tufa::checks {
namespace {

bool isFinite(const Position& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// For each position the first one that equals it; 0 and -0 are equal, NaN equals nothing.
std::vector<VertexIndex> firstEqual(const std::vector<Position>& positions) {
  std::vector<VertexIndex> order(positions.size());
  std::iota(order.begin(), order.end(), VertexIndex{0});
  std::vector<VertexIndex> first = order;
  // NaN has no place in an order, and a vertex that is not finite spoils its faces in any case.
  std::erase_if(order, [&](VertexIndex v) { return !isFinite(positions[v]); });
  const auto less = [&](VertexIndex a, VertexIndex b) {
    const Position& p = positions[a];
    const Position& q = positions[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  };
  base::parallelSort(order.begin(), order.end(), less);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (positions[order[i]] == positions[order[i - 1]]) first[order[i]] = first[order[i - 1]];
  }
  return first;
}

std::size_t countRepresentatives(const std::vector<VertexIndex>& first) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < first.size(); ++v) count += first[v] == v ? 1 : 0;
  return count;
}

}  // namespace

bool isValid(const Triangle& triangle, const std::vector<Position>& positions) {
  for (const VertexIndex v : triangle.vertices) {
    if (v >= positions.size() || !isFinite(positions[v])) return false;
  }
  return true;
}

Faces sortFaces(const Mesh& mesh, bool weld, base::Job& job) {
  Faces faces(mesh.positions);
  faces.positionCount = mesh.positions.size();
  std::vector<VertexIndex> first;
  if (weld) {
    first = firstEqual(mesh.positions);
    faces.positionCount = countRepresentatives(first);
  }

  std::vector<Triangle> all = triangulate(mesh);
  faces.triangleCount = all.size();
  enum : std::uint8_t { kInvalid, kCollapsed, kCollinear, kSolid };
  std::vector<std::uint8_t> kinds(all.size());
  job.forRanges(all.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (!isValid(all[f], mesh.positions)) {
        kinds[f] = kInvalid;
        continue;
      }
      auto& v = all[f].vertices;
      if (weld) v = {first[v[0]], first[v[1]], first[v[2]]};
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        kinds[f] = kCollapsed;
      } else {
        kinds[f] = areCollinear(mesh.positions, all[f]) ? kCollinear : kSolid;
      }
    }
  });

  for (const std::uint8_t kind : kinds) {
    faces.invalidCount += kind == kInvalid ? 1 : 0;
    faces.collapsedCount += kind == kCollapsed ? 1 : 0;
    faces.collinearCount += kind == kCollinear ? 1 : 0;
  }
  if (faces.collinearCount > 0) {
    for (std::size_t f = 0; f < all.size(); ++f) {
      if (kinds[f] == kSolid) faces.noncollinear.push_back(all[f]);
    }
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < all.size(); ++f) {
    if (kinds[f] >= kCollinear) all[kept++] = all[f];
  }
  all.resize(kept);
  faces.proper = std::move(all);
  return faces;
}

}  // namespace tufa::checks
