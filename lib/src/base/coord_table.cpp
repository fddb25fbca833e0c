#include "base/coord_table.h"

#include <bit>

namespace tufa::base {
namespace {

std::size_t hashOf(const Coord& at) {
  const auto mix = [](std::uint64_t hash, std::int32_t value) {
    hash ^= static_cast<std::uint32_t>(value);
    hash *= 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
  };
  return mix(mix(mix(0, at[0]), at[1]), at[2]);
}

}  // namespace

void CoordTable::reserve(std::size_t count) { entries_.assign(std::bit_ceil(2 * count + 2), {}); }

std::uint32_t CoordTable::tryEmplace(const Coord& at, std::uint32_t number) {
  Entry& entry = entries_[slotOf(at)];
  if (entry.number == kNone) entry = {at, number};
  return entry.number;
}

std::size_t CoordTable::slotOf(const Coord& at) const {
  const std::size_t mask = entries_.size() - 1;
  std::size_t slot = hashOf(at) & mask;
  while (entries_[slot].number != kNone && entries_[slot].at != at) slot = (slot + 1) & mask;
  return slot;
}

}  // namespace tufa::base
