#pragma once

#include <cstdint>
#include <vector>

#include "refine/collapse/edge_mesh.h"

namespace tufa::refine {

/// Curves beside a mesh that its vertices stand for, each vertex for a stretch. Vertices may be
/// joined as long as each still stands for one stretch of every curve, inside one of its parts; two
/// with stretches of different curves alone may not.
class Rim {
 public:
  /// Places on a curve, from `first` to `last`.
  struct Stretch {
    std::uint32_t curve, part, first, last;
  };

  /// Says what a vertex stands for. Stretches of one vertex are of different curves.
  void add(VertexIndex vertex, const Stretch& stretch);
  [[nodiscard]] bool empty() const { return stretches_.empty(); }
  [[nodiscard]] bool mayJoin(VertexIndex a, VertexIndex b) const;
  /// `keep` stands for what `drop` stood for, too.
  void join(VertexIndex keep, VertexIndex drop);

 private:
  [[nodiscard]] const std::vector<Stretch>* find(VertexIndex vertex) const;

  std::vector<std::uint32_t> numbers_;  // of each vertex that has stretches, in stretches_
  std::vector<std::vector<Stretch>> stretches_;
};

}  // namespace tufa::refine
