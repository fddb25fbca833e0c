#include "base/vertex_welder.h"

#include <bit>

namespace tufa::base {

VertexWelder::VertexWelder(std::vector<Position>& positions)
    : positions_(positions), slots_(1024, kFree) {}

std::size_t VertexWelder::slotOf(const Position& position) const {
  std::uint64_t hash = 0;
  for (const double x : {position.x, position.y, position.z}) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  }
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash & mask;
  while (slots_[slot] != kFree && !(positions_[slots_[slot]] == position)) slot = (slot + 1) & mask;
  return slot;
}

VertexIndex VertexWelder::indexOf(Position position) {
  // Adding zero makes 0 of -0, which equals it but has other bits.
  position = {position.x + 0.0, position.y + 0.0, position.z + 0.0};
  std::size_t slot = slotOf(position);
  if (slots_[slot] != kFree) return slots_[slot];
  if (2 * (positions_.size() + 1) > slots_.size()) {
    grow();
    slot = slotOf(position);
  }
  const VertexIndex index = static_cast<VertexIndex>(positions_.size());
  positions_.push_back(position);
  slots_[slot] = index;
  return index;
}

void VertexWelder::grow() {
  slots_.assign(4 * slots_.size(), kFree);
  for (std::size_t n = 0; n < positions_.size(); ++n) {
    slots_[slotOf(positions_[n])] = static_cast<VertexIndex>(n);
  }
}

}  // namespace tufa::base
