#include <tufa/error.h>
#include <tufa/octree.h>

#include <limits>
#include <string>

#include "base/coord_table.h"

namespace tufa {
namespace {

// The leaves of one level, by their coordinates in cells of that level.
struct LevelLeaves {
  std::vector<Coord> cells;
  base::CoordTable table;

  void index() {
    table.reserve(cells.size());
    for (const Coord& cell : cells) table.tryEmplace(cell, 0);
  }
  [[nodiscard]] bool has(const Coord& cell) const {
    return table.find(cell) != base::CoordTable::kNone;
  }
};

/// Whether a step of at most one leads past the ends of 32-bit integers.
bool leavesCoordinates(const Coord& cell, const Coord& step) {
  using Limits = std::numeric_limits<std::int32_t>;
  bool leaves = false;
  for (int axis = 0; axis < 3; ++axis) {
    leaves |= step[axis] > 0 && cell[axis] == Limits::max();
    leaves |= step[axis] < 0 && cell[axis] == Limits::min();
  }
  return leaves;
}

}  // namespace

bool isRestricted(const std::vector<LeafCell>& leaves) {
  std::vector<LevelLeaves> levels;
  constexpr int kMostLevel = 31;  // then a cell is half of all coordinates
  for (const LeafCell& leaf : leaves) {
    if (leaf.level < 0 || leaf.level > kMostLevel) {
      throw Error(ErrorCode::InvalidArgument, "a leaf has level " + std::to_string(leaf.level) +
                                                  ", not 0 to " + std::to_string(kMostLevel));
    }
    const auto level = static_cast<std::size_t>(leaf.level);
    if (levels.size() <= level) levels.resize(level + 1);
    levels[level].cells.push_back(leaf.corner >> leaf.level);
  }
  for (LevelLeaves& level : levels) level.index();
  // From each leaf as the smaller one: none of the cells of its size around it may be part of a
  // leaf two levels up or more, and it may not itself be part of any larger leaf.
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (const Coord& cell : levels[level].cells) {
      for (int i = 0; i < 27; ++i) {
        const Coord step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
        if (leavesCoordinates(cell, step)) continue;
        const Coord near = cell.offsetBy(step[0], step[1], step[2]);
        for (std::size_t above = level + (near == cell ? 1 : 2); above < levels.size(); ++above) {
          if (levels[above].has(near >> static_cast<int>(above - level))) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace tufa
