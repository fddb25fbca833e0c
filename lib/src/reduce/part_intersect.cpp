// Explicit intersection tests beside narrow places and creases.
//
// A new triangle is tested against all triangles that have no vertex in common with it; those that
// have one are the star guards' business. Triangles without a narrow corner need no test, see
// clearance.h. Cost: some hundred nanoseconds a star.

#include "reduce/part.h"

namespace tufa::reduce {
namespace {

// Voxels that are kept between triangles. More would hold up creases along which vertices crowd, as
// those of a solid in line with the lattice. Less is left to the search in the finished mesh.
constexpr float kGap = 1e-4f;

}  // namespace

// Other parts write flags while this one works, but never those of foreign triangles, which stay.
bool Part::isNarrow(Index t) const {
  bool narrow = false;
  if (t < triangleCount_) {
    for (Index i = 0; i < 3; ++i) narrow |= (flags_[vertex_[3 * t + i]] & kNarrow) != 0;
  } else {
    const Index own = partition_->foreign(number_)[t - triangleCount_];
    for (const Index v : surface_->triangles[own].vertices) {
      narrow |= (surface_->flags[v] & kNarrow) != 0;
    }
  }
  return narrow;
}

void Part::makeBoxList() {
  hasBoxList_ = true;
  const Index all = triangleCount_ + static_cast<Index>(partition_->foreign(number_).size());
  boxSlots_.assign(all, kNone);
  std::vector<std::pair<Box3f, Index>> items;
  Vec3f p[3];
  for (Index t = 0; t < all; ++t) {
    if ((t < triangleCount_ && isDead(t)) || !isNarrow(t)) continue;
    triangleAt(t, p);
    items.emplace_back(boxOf(p), t);
  }
  boxList_.build(items, boxSlots_);
}

void Part::renewBox(Index t) {
  if (!isNarrow(t)) return;
  Vec3f p[3];
  triangleAt(t, p);
  boxList_.put(t, boxOf(p), boxSlots_);
}

// The vertex at a corner by its number in the part, kNone if it is another part's.
Index Part::cornerVertex(Index t, std::size_t i) const {
  if (t < triangleCount_) return vertex_[3 * t + i];
  const Index own = partition_->foreign(number_)[t - triangleCount_];
  const Index v = surface_->triangles[own].vertices[i];
  return partition_->partOf(v) == number_ ? partition_->localVertex(v) : kNone;
}

// Whether one of the new triangles comes near a triangle that has no vertex in common with it and
// stays, having none that is merged. Vertices of the new triangles have the stamp
// ringStamp_: most triangles have none of them.
bool Part::intersects(const NewTriangles& made, bool isMerging) {
  if (made.count == 0) return false;
  if (!hasBoxList_) makeBoxList();
  Box3f boxes[kMostRing], whole;
  for (int i = 0; i < made.count; ++i) {
    boxes[i] = boxOf(made.corners[i]);
    boxes[i].growBy(kGap);
    whole.add(boxes[i]);
  }
  return boxList_.any(whole, [&](Index t, const Box3f& box) {
    Index v[3];
    bool hasCommon = false;
    for (std::size_t j = 0; j < 3; ++j) {
      v[j] = cornerVertex(t, j);
      if (v[j] == kNone) continue;
      if (isMerging && isMerged(v[j])) return false;
      hasCommon |= stamp_[v[j]] == ringStamp_;
    }
    Vec3f other[3];
    triangleAt(t, other);
    for (int i = 0; i < made.count; ++i) {
      if (!boxes[i].meets(box)) continue;
      bool shares = false;
      for (int k = 0; hasCommon && k < 3; ++k) {
        const Index w = made.vertices[i][k];
        shares |= w != kNone && (w == v[0] || w == v[1] || w == v[2]);
      }
      if (!shares && !planeParts(made.corners[i], other, kGap)) return true;
    }
    return false;
  });
}

bool Part::starIntersects(std::span<const Index> merged) {
  unsigned atApex = 0;
  for (const Index v : merged) atApex |= flags_[v];
  unsigned all = atApex;
  for (int i = 0; i < size_; ++i) all |= flags_[ring_[i]];
  if ((all & kNarrow) == 0) return false;
  NewTriangles made;
  for (int i = 0; i < size_; ++i) {
    const Index x = ring_[i], y = ring_[i + 1];
    if (((atApex | flags_[x] | flags_[y]) & kNarrow) == 0) continue;
    Vec3f* corners = made.corners[made.count];
    corners[0] = place_, corners[1] = position_[x], corners[2] = position_[y];
    Index* vertices = made.vertices[made.count++];
    vertices[0] = kNone, vertices[1] = x, vertices[2] = y;
  }
  return intersects(made, true);
}

// Whether a component lies between the star as it was and as it would be: it would be passed over
// without an intersection before or after.
bool Part::passesOver(std::span<const Index> merged, std::span<const Index> vanishing) {
  unsigned all = 0;
  for (const Index v : merged) all |= flags_[v];
  for (int i = 0; i < size_; ++i) all |= flags_[ring_[i]];
  if ((all & kNarrow) == 0) return false;
  Box3f whole;
  whole.add(place_);
  for (const Index v : merged) whole.add(position_[v]);
  for (int i = 0; i < size_; ++i) whole.add(position_[ring_[i]]);
  return hasComponentIn(whole, [&](Vec3f p) {
    float winding = 0;
    for (int i = 0; i < size_; ++i) {
      const Vec3f x = position_[ring_[i]] - p, y = position_[ring_[i + 1]] - p;
      winding += solidAngle(place_ - p, x, y);
    }
    const auto without = [&](Index gone) {
      Vec3f q[3];
      triangleAt(gone, q);
      winding -= solidAngle(q[0] - p, q[1] - p, q[2] - p);
    };
    for (int i = 0; i < size_; ++i) without(at_[i] / 3);
    for (const Index gone : vanishing) without(gone);
    return winding;
  });
}

}  // namespace tufa::reduce
