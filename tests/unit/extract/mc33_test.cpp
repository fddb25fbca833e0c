// The topology of each cell against that of the trilinear surface itself, by oracles of another
// kind.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

#include "unit/extract/cube_symmetry.h"
#include "unit/extract/mc33_cells.h"
#include "unit/uniform/cell_oracle.h"

namespace tufa::extraction {
namespace {

using cells::Cells;
using cells::chosenFor;
using cells::maskOf;
using cells::Topology;
using cells::topologyOf;
using cells::trilinear;
using cells::TrilinearCell;

TEST(Mc33, HasTheTopologyOfTheTrilinearSurfaceInAMillionRandomCells) {
  Cells cells(1);
  int mismatches = 0, uncertain = 0, tubes = 0;
  std::set<std::pair<int, int>> seen;
  for (int i = 0; i < 1'000'000; ++i) {
    const CornerValues values = cells.next();
    bool certain = true;
    const Topology expected = trilinear(values, certain);
    if (!certain) {
      ++uncertain;
      continue;
    }
    const Topology found = topologyOf(chosenFor(values));
    tubes += found.euler < found.components ? 1 : 0;
    seen.emplace(found.components, found.euler);
    if (found == expected) continue;
    if (++mismatches < 5) ADD_FAILURE() << int{maskOf(values)} << ": " << found << ", " << expected;
  }
  EXPECT_EQ(mismatches, 0);
  EXPECT_LT(uncertain, 100);
  EXPECT_GT(tubes, 1000);
  EXPECT_TRUE(seen.count({4, 4}));  // four disks, and a disk beside a tube
  EXPECT_TRUE(seen.count({2, 1}));
}

TEST(Mc33, HasTheComponentsThatAFineLatticeShows) {
  Cells cells(2);
  int compared = 0, tubes = 0;
  for (int i = 0; i < 8'000; ++i) {
    const CornerValues values = cells.next();
    const CornerMask mask = maskOf(values);
    if (mask == 0 || mask == 255) continue;
    const CubeCase chosen = chosenFor(values);
    // Most cells are a single disk: a few of them will do.
    if (chosen.loopCount == 1 && i % 50 != 0) continue;
    const TrilinearCell cell(values);
    const auto sides = cell.componentsOnLattice(18, false);
    if (sides != cell.componentsOnLattice(18, true)) continue;
    const Topology found = topologyOf(chosen);
    // Both sides and the surface between them fill a ball (Mayer and Vietoris).
    EXPECT_EQ(found.components, sides[0] + sides[1] - 1) << int{mask};
    ++compared;
    tubes += found.euler < found.components ? 1 : 0;
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(tubes, 20);
}

TEST(Mc33, SweepsAlongAnyAxisAlike) {
  Cells cells(3);
  const auto symmetries = cells::CubeSymmetry::all();
  for (int i = 0; i < 20'000; ++i) {
    const CornerValues values = cells.next();
    const Topology found = topologyOf(chosenFor(values));
    const auto& symmetry = symmetries[static_cast<std::size_t>(i) % symmetries.size()];
    CornerValues turned, opposite;
    for (int corner = 0; corner < 8; ++corner) {
      turned[symmetry.corner(corner)] = values[corner];
      opposite[corner] = -values[corner];
    }
    EXPECT_EQ(topologyOf(chosenFor(turned)), found);
    EXPECT_EQ(topologyOf(chosenFor(opposite)), found);
  }
}

TEST(Mc33, CasesHaveNoEdgeOfTwoTrianglesInAFace) {
  int tubes = 0;
  uniform::cells::forAllCells([&](CornerMask mask, FaceBits joined) {
    const Loops loops = loopsOf(mask, joined);
    for (int tunnel = 1; tunnel <= kTunnels; ++tunnel) {
      if (!mayHave(loops, tunnel)) continue;
      ++tubes;
      const CubeCase& cell = caseOf(codeOf(mask, joined, tunnel));
      std::set<std::pair<int, int>> sides;
      for (int t = 0; t < cell.count; ++t) {
        for (int k = 0; k < 3; ++k) {
          const auto side = std::pair(cell.triangles[t][k], cell.triangles[t][(k + 1) % 3]);
          EXPECT_TRUE(sides.insert(side).second) << int{mask};
        }
      }
      int rim = 0;
      for (const auto& [a, b] : sides) {
        const bool isRim = sides.count({b, a}) == 0;
        rim += isRim ? 1 : 0;
        EXPECT_TRUE(isRim || std::max(a, b) >= kCentre || !shareFace(a, b)) << int{mask};
      }
      int crossings = 0;
      for (int i = 0; i < loops.count; ++i) crossings += loops.loops[i].size;
      EXPECT_EQ(rim, crossings) << int{mask};
      EXPECT_EQ(topologyOf(cell), (Topology{loops.count - 1, loops.count - 2}));
    }
  });
  EXPECT_EQ(tubes, 408);
}

}  // namespace
}  // namespace tufa::extraction
