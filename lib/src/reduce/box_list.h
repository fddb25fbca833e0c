#pragma once

#include <utility>
#include <vector>

#include "reduce/box3f.h"
#include "reduce/box_group.h"
#include "reduce/corners.h"

namespace tufa::reduce {

/// Boxes of triangles that change all the time, for explicit intersection tests.
///
/// They lie in the order of a space-filling curve, in three levels: sixteen of them share a larger
/// box, sixteen of those a still larger one. A box is renewed in place; larger ones only grow until
/// the next build(). Beside a tree that costs nothing to keep up, and a part has few enough of
/// them.
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
    const auto inGroup = [&](std::size_t g) {
      return boxes_[g].any(
          box, [&](std::size_t i) { return f(triangles_[g * kGroup + i], boxes_[g].at(i)); });
    };
    for (std::size_t top = 0; top < tops_.size(); ++top) {
      const bool isDone = tops_[top].any(box, [&](std::size_t i) {
        return groups_[top * kGroup + i].any(
            box, [&](std::size_t k) { return inGroup((top * kGroup + i) * kGroup + k); });
      });
      if (isDone) return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kGroup = BoxGroup::kSize;
  std::vector<BoxGroup> boxes_, groups_, tops_;  ///< of triangles, of boxes_, of groups_
  std::vector<Index> triangles_;
};

}  // namespace tufa::reduce
