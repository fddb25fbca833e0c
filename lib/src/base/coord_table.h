#pragma once

#include <tufa/coord.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tufa::base {

/// A hash table from coordinates of cells, blocks or regions to indices, in one array: cheap to
/// build and to free.
class CoordTable {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  CoordTable() { reserve(0); }
  /// Empties the table and makes room for exactly so many coordinates.
  void reserve(std::size_t count);
  /// Assigns `number` to coordinates that have none yet. Returns the number that they have then.
  std::uint32_t tryEmplace(const Coord& at, std::uint32_t number);
  [[nodiscard]] std::uint32_t find(const Coord& at) const { return entries_[slotOf(at)].number; }

 private:
  struct Entry {
    Coord at;
    std::uint32_t number = kNone;
  };
  [[nodiscard]] std::size_t slotOf(const Coord& at) const;

  std::vector<Entry> entries_;  ///< open addressing; a power of two, at most half full
};

}  // namespace tufa::base
