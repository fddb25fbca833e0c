#pragma once

#include <tufa/mesh.h>
#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/bvh.h"
#include "base/job.h"
#include "base/polygons.h"

namespace tufa::intersect {

using base::Corners;
using base::PolygonIndex;

/// Two polygons that intersect elsewhere than in what they share, the lower index first; twice the
/// same one is a quad that is folded onto itself.
struct PolygonPair {
  PolygonIndex a, b;
  friend auto operator<=>(const PolygonPair&, const PolygonPair&) = default;
};

/// The triangles of a polygon, a quad split from its first vertex to its third. Returns how many.
inline int trianglesOf(Corners v, std::array<Triangle, 2>& out) {
  if (v.empty()) return 0;
  out[0] = {v[0], v[1], v[2]};
  if (v.size() == 3) return 1;
  out[1] = {v[0], v[2], v[3]};
  return 2;
}

/// The polygons of pairs, each as often as it occurs.
[[nodiscard]] std::vector<PolygonIndex> polygonsOf(const std::vector<PolygonPair>& pairs);

/// The same, sorted and each once.
[[nodiscard]] std::vector<PolygonIndex> distinctPolygonsOf(const std::vector<PolygonPair>& pairs);

/// Those of some pairs of a mesh's polygons that intersect with other positions of the vertices.
[[nodiscard]] std::vector<PolygonPair> intersectingAmong(const std::vector<PolygonPair>& pairs,
                                                         const Mesh& mesh,
                                                         std::span<const Position> positions,
                                                         base::Job& job);

/// The vertices of polygons of a mesh, sorted.
[[nodiscard]] std::vector<VertexIndex> verticesOf(const Mesh& mesh,
                                                  const std::vector<PolygonIndex>& polygons);

/// Whether two polygons, or if they are the `same` the triangles of one, intersect elsewhere than
/// in what they share.
[[nodiscard]] bool intersectElsewhere(std::span<const Position> positions, Corners a, Corners b,
                                      bool same);

/// The polygons of a mesh while they change, with an index of where they lie.
///
/// Neighbours in a mesh are mostly neighbours in its arrays too, so runs of consecutive polygons
/// have small boxes; these, and the boxes of sections of runs, are the whole index. Boxes only
/// grow: one that a polygon has left is too large but never wrong. Quads keep their indices while
/// others are removed.
class Surface {
 public:
  Surface(Mesh& mesh, base::Job& job);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] std::size_t size() const { return mesh_.quads.size() + mesh_.triangles.size(); }
  /// The vertices of a polygon: 3, 4, or none if it was removed.
  [[nodiscard]] Corners corners(PolygonIndex polygon) const {
    if (polygon >= mesh_.quads.size()) {
      return mesh_.triangles[polygon - mesh_.quads.size()].vertices;
    }
    const auto& v = mesh_.quads[polygon].vertices;
    if (v[0] == v[1]) return {};
    return v;
  }
  [[nodiscard]] base::Box box(PolygonIndex polygon) const;
  [[nodiscard]] bool isQuad(PolygonIndex polygon) const { return polygon < mesh_.quads.size(); }

  /// Moves a vertex. The caller then calls update() for the polygons around it.
  void move(VertexIndex vertex, const Position& to) { mesh_.positions[vertex] = to; }
  /// Flips the diagonal of a quad.
  void turn(PolygonIndex quad);
  /// Replaces a quad by four triangles around a new vertex; they get the last indices.
  void fan(PolygonIndex quad, const Position& centre);
  /// Extends the index by where a polygon lies now.
  void update(PolygonIndex polygon);
  /// Removes the quads that fans replaced from the mesh, which changes indices. Must be the last
  /// call.
  void finish();

  static constexpr std::size_t kRun = 32;      ///< polygons
  static constexpr std::size_t kSection = 32;  ///< runs
  [[nodiscard]] std::size_t sectionCount() const { return sections_.size(); }
  [[nodiscard]] const base::Box& sectionBox(std::size_t section) const {
    return sections_[section];
  }
  [[nodiscard]] std::size_t sectionEnd(std::size_t section) const {
    return std::min((section + 1) * kSection, runs_.size());
  }
  [[nodiscard]] std::size_t runCount() const { return runs_.size(); }
  [[nodiscard]] const base::Box& runBox(std::size_t run) const { return runs_[run]; }
  [[nodiscard]] PolygonIndex runBegin(std::size_t run) const {
    return static_cast<PolygonIndex>(run * kRun);
  }
  [[nodiscard]] PolygonIndex runEnd(std::size_t run) const {
    return static_cast<PolygonIndex>(std::min((run + 1) * kRun, size()));
  }

 private:
  Mesh& mesh_;
  std::vector<base::Box> runs_;
  std::vector<base::Box> sections_;
  bool fanned_ = false;
};

/// What findClosePairs() finds.
struct ClosePairs {
  std::vector<PolygonPair> intersecting;
  /// These, and those that may come to intersect if each vertex moves by half of the margin.
  std::vector<PolygonPair> close;
};

/// Takes what was found for some polygons, sorted, that have changed in the place of what was known
/// of them.
void renewPairsOf(const std::vector<PolygonIndex>& changed, const ClosePairs& found,
                  ClosePairs& known);

/// Of the pairs of which at least one polygon is among `candidates`, those that intersect and those
/// that are close to it. Both sorted. `matters` as for findPairs(), whose cost it has.
[[nodiscard]] ClosePairs findClosePairs(
    const Surface& surface, const std::vector<PolygonIndex>& candidates, double margin,
    base::Job& job, const std::function<bool(PolygonIndex, PolygonIndex)>& matters = nullptr);

/// All pairs of which at least one polygon is among `candidates`, sorted; if there is a function
/// `matters`, only those for which it is true. The result does not depend on the number of threads.
/// Cost: a tree over the candidates, and one query for each run of polygons.
[[nodiscard]] std::vector<PolygonPair> findPairs(
    const Surface& surface, const std::vector<PolygonIndex>& candidates, base::Job& job,
    const std::function<bool(PolygonIndex, PolygonIndex)>& matters = nullptr);

/// The polygons of a mesh that intersect another one, rising.
[[nodiscard]] std::vector<PolygonIndex> findIntersecting(Mesh& mesh, base::Job& job);

}  // namespace tufa::intersect
