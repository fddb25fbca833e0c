#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "intersect/surface.h"
#include "refine/placement_conflict.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// Finds what stands in the way of the places of a surface's vertices, see withdrawPlacements():
/// once everywhere, and then around the vertices that have moved.
class ConflictFinder {
 public:
  /// Which pairs of quads are looked at around vertices that have moved.
  enum class Pairs {
    WithCandidate,  ///< those with a candidate
    All,
  };

  /// `margin`: as for intersect::findCandidates().
  ConflictFinder(uniform::UniformSurface& surface, double margin, base::Job& job);

  /// Vertices of one quad that were placed at the same point of a crease, at least one of them out
  /// of its cell.
  [[nodiscard]] std::vector<Conflict> findCoincident();
  /// All folds and pairs. Cost: two passes over the triangles, one over the quads, and a search for
  /// the pairs of candidates.
  [[nodiscard]] std::vector<Conflict> findEverywhere();
  /// Tells that vertices, given in rising order, have moved. Chooses the diagonals of their quads
  /// again.
  void noteMoved(const std::vector<VertexIndex>& vertices);
  /// Folds and pairs of the quads at the vertices that moved last; others were there before. Cost:
  /// one pass over the blocks of these vertices and those beside them.
  [[nodiscard]] std::vector<Conflict> findAroundMoved(Pairs which);

  /// Whether a conflict is one still, whatever has moved.
  [[nodiscard]] bool isConflict(const Conflict& conflict, const Trial& trial) const;
  /// Whether one of a quad's triangles is turned over.
  [[nodiscard]] bool isTurnedOver(std::uint32_t quad, const Trial& trial = {}) const;
  [[nodiscard]] bool isWithin(double voxels, VertexIndex a, VertexIndex b,
                              const Trial& trial = {}) const;
  [[nodiscard]] Involved involvedIn(const Conflict& conflict) const;

  /// The candidates of the mesh as it was at the last search. Sorted.
  [[nodiscard]] const std::vector<std::uint32_t>& candidates() const { return candidates_; }
  /// And its pairs of quads that intersect, or may once each vertex moves by half of the margin.
  [[nodiscard]] const intersect::ClosePairs& pairs() const { return pairs_; }

 private:
  struct EdgeFace;

  [[nodiscard]] Triangle cornersOf(std::uint32_t face) const;
  [[nodiscard]] Vec3 pointOf(VertexIndex vertex, const Trial& trial) const {
    return Vec3(vertex == trial.vertex ? trial.to : mesh_.positions[vertex]);
  }
  [[nodiscard]] Vec3 normalOf(std::uint32_t face, const Trial& trial) const;
  using Off = std::array<bool, 2>;  // of a quad's triangles
  [[nodiscard]] Off offIn(std::uint32_t quad, const Trial& trial = {}) const;
  void addOff(std::uint32_t quad, std::vector<std::uint32_t>& faces) const;
  [[nodiscard]] bool isFold(const EdgeFace& a, const EdgeFace& b, const Trial& trial = {}) const;
  [[nodiscard]] bool intersect(std::uint32_t a, std::uint32_t b, const Trial& trial) const;
  [[nodiscard]] bool isSharpAt(VertexIndex vertex, const Vec3& na, const Vec3& nb) const;
  void addFolds(const std::vector<std::uint32_t>& off, std::vector<Conflict>& conflicts);
  /// The quads with some vertices, given in rising order. Rising.
  [[nodiscard]] std::vector<std::uint32_t> quadsAt(const std::vector<VertexIndex>& vertices);
  void mark(const std::vector<VertexIndex>& vertices, std::uint8_t value);

  uniform::UniformSurface& surface_;
  Mesh& mesh_;
  double margin_;
  base::Job& job_;
  intersect::Surface polygons_;
  std::vector<std::uint32_t> candidates_;
  intersect::ClosePairs pairs_;
  std::vector<std::uint32_t> touched_;  // quads at the vertices that moved last, rising
  std::vector<std::uint8_t> marks_;     // of vertices, all 0 between searches
};

}  // namespace tufa::refine
