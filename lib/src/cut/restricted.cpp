#include <openvdb/openvdb.h>

#include <tufa/octree.h>

#include <algorithm>
#include <unordered_set>

namespace tufa {

bool isRestricted(const std::vector<LeafCell>& leaves) {
  // The leaves of each level, by their coordinates in cells of that level.
  std::vector<std::unordered_set<openvdb::Coord>> levels;
  for (const LeafCell& leaf : leaves) {
    const auto level = static_cast<std::size_t>(leaf.level);
    if (levels.size() <= level) levels.resize(level + 1);
    const auto& c = leaf.corner;
    levels[level].emplace(c[0] >> leaf.level, c[1] >> leaf.level, c[2] >> leaf.level);
  }
  // Seen from the smaller leaf: none of the cells of its size around it, nor its own, may be part
  // of a leaf two levels up; its own may not be part of any.
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (const openvdb::Coord& cell : levels[level]) {
      for (int i = 0; i < 27; ++i) {
        const openvdb::Coord near = cell.offsetBy(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
        for (std::size_t above = level + (near == cell ? 1 : 2); above < levels.size(); ++above) {
          const int up = static_cast<int>(above - level);
          if (levels[above].count({near[0] >> up, near[1] >> up, near[2] >> up}) != 0) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace tufa
