// The leaves of adaptive meshes, through the public interface.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <tufa/contour.h>
#include <tufa/octree.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>
#include <vector>

#include "grid/vdb_coord.h"
#include "support/print.h"
#include "support/shape.h"

namespace tufa {
namespace {

// By the definition, pair by pair.
bool touchAndDiffer(const LeafCell& a, const LeafCell& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.corner[axis] + (1 << a.level) < b.corner[axis]) return false;
    if (b.corner[axis] + (1 << b.level) < a.corner[axis]) return false;
  }
  return std::abs(a.level - b.level) > 1;
}

bool overlap(const LeafCell& a, const LeafCell& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.corner[axis] + (1 << a.level) <= b.corner[axis]) return false;
    if (b.corner[axis] + (1 << b.level) <= a.corner[axis]) return false;
  }
  return a.level != b.level;
}

bool restrictedByDefinition(const std::vector<LeafCell>& leaves) {
  for (const LeafCell& a : leaves) {
    for (const LeafCell& b : leaves) {
      if (touchAndDiffer(a, b) || overlap(a, b)) return false;
    }
  }
  return true;
}

TEST(IsRestricted, AgreesWithItsDefinitionOnRandomLeaves) {
  std::mt19937 random(5);
  int yes = 0, no = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<LeafCell> leaves;
    const auto count = 2 + random() % 4;
    for (std::uint32_t k = 0; k < count; ++k) {
      const int level = static_cast<int>(random() % 4);
      const int side = 16 >> level;
      const auto place = [&] {
        return (static_cast<int>(random() % static_cast<unsigned>(side)) - side / 2) << level;
      };
      leaves.push_back({Coord(place(), place(), place()), level});
    }
    const bool expected = restrictedByDefinition(leaves);
    ASSERT_EQ(isRestricted(leaves), expected) << i;
    (expected ? yes : no)++;
  }
  EXPECT_GT(yes, 500);
  EXPECT_GT(no, 500);
}

std::vector<LeafCell> leavesOf(const openvdb::FloatGrid& grid, ContourOptions options) {
  options.keepLeaves = true;
  options.simplify = false;
  ContourReport report;
  (void)contour(grid, options, &report);
  return report.certificate->leaves;
}

// The cells that the surface passes, sample by sample.
std::set<Coord> surfaceCells(const openvdb::FloatGrid& grid) {
  std::set<Coord> cells;
  auto accessor = grid.getConstAccessor();
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    for (int corner = 0; corner < 8; ++corner) {
      const auto cell =
          value.getCoord().offsetBy(-(corner >> 2), -((corner >> 1) & 1), -(corner & 1));
      int inside = 0;
      for (int i = 0; i < 8; ++i) {
        inside += accessor.getValue(cell.offsetBy(i >> 2, (i >> 1) & 1, i & 1)) < 0 ? 1 : 0;
      }
      if (inside != 0 && inside != 8) cells.insert(grid::fromVdb(cell));
    }
  }
  return cells;
}

class LeavesOf : public testing::TestWithParam<Shape> {};

TEST_P(LeavesOf, AreARestrictedOctree) {
  const auto grid = test::shapeOf(GetParam(), 0.04);
  for (const double tolerance : {0.02, 0.3, 5.0}) {
    ContourOptions options;
    options.tolerance = tolerance;
    const auto leaves = leavesOf(*grid, options);
    ASSERT_FALSE(leaves.empty());
    EXPECT_TRUE(isRestricted(leaves)) << tolerance;
    for (const LeafCell& leaf : leaves) {
      EXPECT_EQ(leaf.corner & ((1 << leaf.level) - 1), Coord(0)) << leaf.corner;
    }
  }
}

TEST_P(LeavesOf, HoldEachSurfaceCellOnce) {
  const auto grid = test::shapeOf(GetParam(), 0.04);
  ContourOptions options;
  options.tolerance = 0.3;
  const auto leaves = leavesOf(*grid, options);
  const std::set<Coord> cells = surfaceCells(*grid);
  std::set<Coord> corners[21];
  for (const LeafCell& leaf : leaves) {
    EXPECT_TRUE(corners[leaf.level].insert(leaf.corner).second) << "twice: " << leaf.corner;
  }
  std::set<std::pair<int, Coord>> used;
  for (const Coord& cell : cells) {
    int holding = 0;
    for (int level = 0; level <= 20; ++level) {
      const Coord corner = (cell >> level) << level;
      if (corners[level].count(corner) == 0) continue;
      ++holding;
      used.insert({level, corner});
    }
    ASSERT_EQ(holding, 1) << cell;
  }
  EXPECT_EQ(used.size(), leaves.size()) << "leaves that the surface does not pass";
}

TEST_P(LeavesOf, AreFewerAtALargerTolerance) {
  const auto grid = test::shapeOf(GetParam(), 0.04);
  std::size_t before = surfaceCells(*grid).size();
  for (const double tolerance : {0.02, 0.1, 0.5}) {
    ContourOptions options;
    options.tolerance = tolerance;
    const std::size_t count = leavesOf(*grid, options).size();
    EXPECT_LT(count, before) << tolerance;
    before = count;
  }
}

int largestLevel(const std::vector<LeafCell>& leaves) {
  int largest = 0;
  for (const LeafCell& leaf : leaves) largest = std::max(largest, leaf.level);
  return largest;
}

TEST_P(LeavesOf, AreAsLargeAsTheLargestCellAndNoLarger) {
  const auto grid = test::shapeOf(GetParam(), 0.04);
  ContourOptions options;
  options.tolerance = 10;
  const int free = largestLevel(leavesOf(*grid, options));
  ASSERT_GE(free, 2);
  for (const int level : {0, 1, 3}) {
    options.maxCell = 1 << level;
    EXPECT_EQ(largestLevel(leavesOf(*grid, options)), std::min(level, free));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, LeavesOf,
                         testing::Values(Shape::Sphere, Shape::Torus, Shape::Gyroid),
                         [](const auto& shape) {
                           return std::string(shapeNames()[static_cast<std::size_t>(shape.param)]);
                         });

TEST(Leaves, OfAMeshWithoutToleranceAreTheSmallestCellsOrWhatIsForced) {
  for (const Shape shape : {Shape::Sphere, Shape::Torus}) {
    const auto grid = test::shapeOf(shape, 0.04);
    ContourOptions options;
    options.tolerance = 0;
    const auto leaves = leavesOf(*grid, options);
    EXPECT_EQ(largestLevel(leaves), 0);
    EXPECT_EQ(leaves.size(), surfaceCells(*grid).size());
    options.minCell = 4;
    const auto forced = leavesOf(*grid, options);
    EXPECT_EQ(largestLevel(forced), 2);
    EXPECT_LT(forced.size(), leaves.size() / 8) << "merged whatever the tolerance";
  }
}

}  // namespace
}  // namespace tufa
