#pragma once

#include <cstdint>
#include <vector>

#include "refine/collapse/edge_mesh.h"

namespace tufa::refine {

/// Curves on chunk faces beside a mesh, and the stretch of them that each vertex stands for. Two
/// vertices may be joined if their stretches follow each other on every curve that both touch,
/// inside one part of a closed curve; so each vertex keeps one stretch per curve, and strips never
/// use an edge twice. Vertices with stretches of different curves only may not be joined.
class Rim {
 public:
  /// Arcs of a curve, from `first` to `last`, both included.
  struct Stretch {
    std::uint32_t curve, part, first, last;
  };

  /// Adds a stretch that a vertex stands for; at most one of each curve.
  void add(VertexIndex vertex, const Stretch& stretch);
  [[nodiscard]] bool empty() const { return stretches_.empty(); }
  [[nodiscard]] bool mayJoin(VertexIndex a, VertexIndex b) const;
  /// Adds the stretches of `drop` to those of `keep`.
  void join(VertexIndex keep, VertexIndex drop);

 private:
  [[nodiscard]] const std::vector<Stretch>* find(VertexIndex vertex) const;

  std::vector<std::uint32_t> numbers_;  // of each vertex that has stretches, in stretches_
  std::vector<std::vector<Stretch>> stretches_;
};

}  // namespace tufa::refine
