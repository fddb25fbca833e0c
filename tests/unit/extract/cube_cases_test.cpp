// The table of marching cubes, exhaustively: all 256 masks with all bits of their ambiguous faces.

#include "extract/cube_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "unit/extract/cube_symmetry.h"
#include "unit/uniform/cell_oracle.h"

namespace tufa::extraction {
namespace {

using cells::CubeSymmetry;
using uniform::cells::forAllCells;

/// Directed edges of the triangles, and how often each is passed.
using Sides = std::map<std::pair<int, int>, int>;

Sides sidesOf(const CubeCase& cell) {
  Sides sides;
  for (int i = 0; i < cell.count; ++i) {
    const auto& t = cell.triangles[i];
    for (int side = 0; side < 3; ++side) ++sides[{t[side], t[(side + 1) % 3]}];
  }
  return sides;
}

/// Arcs of the loops, in their direction.
std::set<std::pair<int, int>> arcsOfLoops(const Loops& loops) {
  std::set<std::pair<int, int>> arcs;
  for (int i = 0; i < loops.count; ++i) {
    const Loop& loop = loops.loops[i];
    for (int k = 0; k < loop.size; ++k) {
      arcs.emplace(loop.edges[k], loop.edges[(k + 1) % loop.size]);
    }
  }
  return arcs;
}

/// Sides that no other triangle of the cell has.
std::set<std::pair<int, int>> rimOf(const CubeCase& cell) {
  const Sides sides = sidesOf(cell);
  std::set<std::pair<int, int>> rim;
  for (const auto& [side, times] : sides) {
    if (sides.count({side.second, side.first}) == 0) rim.insert(side);
  }
  return rim;
}

/// What the chords of a triangulation cost, those of a fan around the centre left out.
int costOf(const CubeCase& cell) {
  const auto rim = rimOf(cell);
  int cost = 0;
  for (const auto& [side, times] : sidesOf(cell)) {
    const auto [a, b] = side;
    if (a > b || b == kCentre || rim.count({a, b}) != 0 || rim.count({b, a}) != 0) continue;
    cost += kChordCosts[a][b];
  }
  return cost;
}

TEST(CubeCases, LoopsAreTheArcsOfTheFaces) {
  int cells = 0;
  forAllCells([&](CornerMask mask, FaceBits joined) {
    ++cells;
    std::set<std::pair<int, int>> found;
    for (const auto& [a, b] : arcsOfLoops(loopsOf(mask, joined))) {
      EXPECT_TRUE(found.emplace(std::min(a, b), std::max(a, b)).second) << int{mask};
    }
    std::set<std::pair<int, int>> expected;
    for (const auto& arc : uniform::cells::arcsOf(mask, joined)) {
      expected.emplace(std::min(arc.first, arc.second), std::max(arc.first, arc.second));
    }
    EXPECT_EQ(found, expected) << int{mask} << " " << int{joined};
  });
  EXPECT_EQ(cells, 656);
}

TEST(CubeCases, TrianglesFillEachLoopWithADisk) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    const CubeCase& cell = caseOf(codeOf(mask, joined));
    const Loops loops = loopsOf(mask, joined);
    const Sides sides = sidesOf(cell);
    std::set<int> vertices;
    std::set<std::pair<int, int>> edges;
    for (const auto& [side, times] : sides) {
      EXPECT_EQ(times, 1);
      vertices.insert(side.first);
      edges.emplace(std::min(side.first, side.second), std::max(side.first, side.second));
    }
    EXPECT_EQ(rimOf(cell), arcsOfLoops(loops)) << int{mask} << " " << int{joined};
    const auto euler =
        static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + cell.count;
    EXPECT_EQ(euler, loops.count) << int{mask} << " " << int{joined};
    EXPECT_EQ(vertices.count(kCentre), cell.centreCount);
  });
}

TEST(CubeCases, NoEdgeOfTwoTrianglesLiesInAFace) {
  int centres = 0;
  forAllCells([&](CornerMask mask, FaceBits joined) {
    const CubeCase& cell = caseOf(codeOf(mask, joined));
    const auto rim = rimOf(cell);
    for (const auto& [side, times] : sidesOf(cell)) {
      const auto [a, b] = side;
      if (a == kCentre || b == kCentre || rim.count({a, b}) != 0) continue;
      EXPECT_FALSE(shareFace(a, b)) << int{mask} << " " << int{joined};
    }
    centres += cell.centreCount;
    const bool oneWay = joined == 0 || joined == uniform::ambiguousFaces(mask);
    EXPECT_FALSE(oneWay && cell.centreCount != 0) << int{mask};
  });
  EXPECT_EQ(centres, 116);
}

TEST(CubeCases, RotationsAndReflectionsCarryLoopsToLoops) {
  for (const CubeSymmetry& symmetry : CubeSymmetry::all()) {
    forAllCells([&](CornerMask mask, FaceBits joined) {
      std::set<std::pair<int, int>> carried;
      for (const auto& [a, b] : arcsOfLoops(loopsOf(mask, joined))) {
        const int from = symmetry.edge(a), to = symmetry.edge(b);
        carried.insert(symmetry.reflects() ? std::pair(to, from) : std::pair(from, to));
      }
      EXPECT_EQ(carried, arcsOfLoops(loopsOf(symmetry.mask(mask), symmetry.faces(joined))));
    });
  }
}

// A loop that a rotation maps to itself, such as a square, may have several triangulations of the
// same cost; the table holds one of them.
TEST(CubeCases, RotationsAndReflectionsCarryTrianglesToAsGoodOnes) {
  for (const CubeSymmetry& symmetry : CubeSymmetry::all()) {
    forAllCells([&](CornerMask mask, FaceBits joined) {
      const CubeCase& cell = caseOf(codeOf(mask, joined));
      const CubeCase& carried = caseOf(codeOf(symmetry.mask(mask), symmetry.faces(joined)));
      EXPECT_EQ(cell.count, carried.count);
      EXPECT_EQ(cell.centreCount, carried.centreCount);
      EXPECT_EQ(costOf(cell), costOf(carried)) << int{mask} << " " << int{joined};
    });
  }
}

TEST(CubeCases, ComplementsAreTheSameSurfaceTurnedOver) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    const auto complement = static_cast<CornerMask>(~mask);
    const auto others = static_cast<FaceBits>(uniform::ambiguousFaces(mask) & ~joined);
    std::set<std::pair<int, int>> reversed;
    for (const auto& [a, b] : arcsOfLoops(loopsOf(mask, joined))) reversed.emplace(b, a);
    EXPECT_EQ(reversed, arcsOfLoops(loopsOf(complement, others)));
    EXPECT_EQ(costOf(caseOf(codeOf(mask, joined))), costOf(caseOf(codeOf(complement, others))));
  });
}

}  // namespace
}  // namespace tufa::extraction
