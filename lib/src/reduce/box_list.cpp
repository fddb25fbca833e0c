#include "reduce/box_list.h"

#include <algorithm>
#include <array>

namespace tufa::reduce {
namespace {

// Ten bits with two zeros between any two, for a Morton code.
Index spread(Index x) {
  x = (x | x << 16) & 0x30000ff;
  x = (x | x << 8) & 0x300f00f;
  x = (x | x << 4) & 0x30c30c3;
  return (x | x << 2) & 0x9249249;
}

}  // namespace

void BoxList::clear() {
  boxes_.clear();
  groups_.clear();
  tops_.clear();
  triangles_.clear();
}

void BoxList::build(const std::vector<std::pair<Box3f, Index>>& items, Slots& slots) {
  clear();
  Box3f all;
  for (const auto& item : items) all.add(item.first);
  const Vec3f d = all.upper - all.lower;
  const float scale = 511 / (std::max({d.x, d.y, d.z}) + 1e-6f);
  std::vector<std::array<Index, 2>> order(items.size());
  for (Index k = 0; k < items.size(); ++k) {
    const Vec3f m = (items[k].first.lower + items[k].first.upper - all.lower * 2) * scale;
    order[k] = {spread(static_cast<Index>(m.x)) | spread(static_cast<Index>(m.y)) << 1 |
                    spread(static_cast<Index>(m.z)) << 2,
                k};
  }
  std::sort(order.begin(), order.end());
  for (const auto& [code, k] : order) {
    slots[items[k].second] = kNone;
    put(items[k].second, items[k].first, slots);
  }
}

void BoxList::put(Index triangle, const Box3f& box, Slots& slots) {
  Index& slot = slots[triangle];
  if (slot == kNone) {
    slot = static_cast<Index>(triangles_.size());
    triangles_.push_back(triangle);
    if (slot % kGroup == 0) boxes_.emplace_back();
    if (boxes_.size() > groups_.size() * kGroup) groups_.emplace_back();
    if (groups_.size() > tops_.size() * kGroup) tops_.emplace_back();
  }
  const std::size_t g = slot / kGroup;
  boxes_[g].set(slot % kGroup, box);
  groups_[g / kGroup].add(g % kGroup, box);
  tops_[g / kGroup / kGroup].add(g / kGroup % kGroup, box);
}

void BoxList::remove(Index triangle, Slots& slots) {
  if (slots[triangle] == kNone) return;
  boxes_[slots[triangle] / kGroup].set(slots[triangle] % kGroup, {});
  slots[triangle] = kNone;
}

}  // namespace tufa::reduce
