#pragma once

#include "reduce/overlay_path.h"

namespace tufa::reduce {

// The map of certify() is continuous. It reaches every point of a closed component of the surface
// if its degree there is one: then each point is covered once, counted by direction. That holds by
// itself unless the reference's component is thinner than twice the distance everywhere, so that
// both of its sides may go to one side of the surface, and the other lies anywhere. The degree is
// the same at all points of a component: counting at one vertex is enough.

/// Counts how often the map covers a vertex of the surface: as often as the loops of faces are
/// pulled over it one way more than the other way. Only faces within the limit of the vertex can
/// be, and all of them must have ways. `M` as in overlay_path.h.
template <class M>
class MapDegree {
 public:
  /// `at`: a triangle at the vertex, around which triangles go all the way.
  MapDegree(const M& mesh, Index vertex, Index at) : mesh_(mesh), vertex_(vertex) {
    Index t = at;
    do {
      t = next(t);
      ++triangles_;
    } while (t != at && t != kNone);
  }

  /// As overlayBound2() wants it.
  void operator()(const OverlayTurn& turn) {
    if (turn.vertex != vertex_) return;
    const int turns = turn.steps / triangles_;
    degree_ += next(turn.from) == turn.to ? turns : -turns;
  }

  [[nodiscard]] int degree() const { return degree_; }

 private:
  // The triangle after one around the vertex, in the direction of its corners.
  [[nodiscard]] Index next(Index t) const {
    int i = 0;
    while (mesh_.vertex(t, i) != vertex_) ++i;
    return mesh_.across(t, (i + 1) % 3);
  }

  const M& mesh_;
  Index vertex_;
  int triangles_ = 0;
  int degree_ = 0;
};

}  // namespace tufa::reduce
