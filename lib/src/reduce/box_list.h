#pragma once

#include <utility>
#include <vector>

#include "reduce/box3f.h"
#include "reduce/corners.h"

namespace tufa::reduce {

/// Boxes of triangles that change all the time, for explicit intersection tests.
///
/// They lie in the order of a space-filling curve, kGroup of them in a larger box and kGroup of
/// those in a still larger one. A box is renewed in place; larger ones only grow until the next
/// build(). Beside a tree that costs nothing to keep up, and a part has few enough of them.
class BoxList {
 public:
  /// What it knows of each triangle: where its box is, kNone if it is not in the list.
  using Slots = std::vector<Index>;

  void clear();
  void build(const std::vector<std::pair<Box3f, Index>>& items, Slots& slots);
  /// Adds a triangle, or renews its box.
  void put(Index triangle, const Box3f& box, Slots& slots);
  void remove(Index triangle, Slots& slots);

  /// Calls f(triangle, box) for all that meet `box` until f returns true; returns whether it did.
  template <class F>
  bool any(const Box3f& box, F&& f) const {
    for (std::size_t top = 0; top < tops_.size(); ++top) {
      if (!box.meets(tops_[top])) continue;
      const std::size_t groupEnd = std::min(groups_.size(), (top + 1) * kGroup);
      for (std::size_t g = top * kGroup; g < groupEnd; ++g) {
        if (!box.meets(groups_[g])) continue;
        const std::size_t end = std::min(boxes_.size(), (g + 1) * kGroup);
        for (std::size_t i = g * kGroup; i < end; ++i) {
          if (box.meets(boxes_[i]) && f(triangles_[i], boxes_[i])) return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::size_t kGroup = 16;
  std::vector<Box3f> boxes_, groups_, tops_;
  std::vector<Index> triangles_;
};

}  // namespace tufa::reduce
