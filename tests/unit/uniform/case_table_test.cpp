#include "uniform/case_table.h"

#include <gtest/gtest.h>

#include <map>

#include "unit/uniform/cell_oracle.h"

namespace tufa::uniform {
namespace {

using cells::Arcs;
using cells::arcsOf;
using cells::forAllCells;
using cells::Partition;
using cells::partitionOf;

TEST(CaseTable, NumbersFollowFromCoordinates) {
  for (int edge = 0; edge < kEdges; ++edge) {
    const auto [lower, upper] = edgeCorners(edge);
    EXPECT_EQ(cells::edgeOf(lower, upper), edge);
    EXPECT_LT(lower, upper);
    EXPECT_EQ(edgeBetween(lower, upper), edge);
  }
  for (int face = 0; face < kFaces; ++face) {
    const auto corners = faceCorners(face);
    const auto expected = cells::cornersOf(face);
    EXPECT_EQ(std::set<int>(corners.begin(), corners.end()),
              std::set<int>(expected.begin(), expected.end()));
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(cells::edgeOf(corners[i], corners[(i + 1) % 4]), kFaceEdges[face][i]);
    }
  }
}

TEST(CaseTable, AmbiguousFacesAreThoseOfFourCrossings) {
  for (int mask = 0; mask < 256; ++mask) {
    for (int face = 0; face < kFaces; ++face) {
      const bool ambiguous = arcsOf(static_cast<CornerMask>(mask), face, false).size() == 2;
      EXPECT_EQ(isAmbiguous(static_cast<CornerMask>(mask), face), ambiguous);
      EXPECT_EQ(((ambiguousFaces(static_cast<CornerMask>(mask)) >> face) & 1) != 0, ambiguous);
    }
  }
}

TEST(CaseTable, EveryCrossingBelongsToTheLoopThatItsArcsForm) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    const Components components = componentsOf(mask, joined);
    ASSERT_EQ(partitionOf(components, mask, 0), partitionOf(mask, joined, 0))
        << "mask " << int{mask} << " joined " << int{joined};
    ASSERT_LE(components.count(), 4);
    ASSERT_EQ(components.count() == 0, mask == 0 || mask == 255);
  });
}

TEST(CaseTable, ComponentsAreClosedLoops) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    std::map<int, int> ends;
    for (const auto& [a, b] : arcsOf(mask, joined)) {
      ++ends[a];
      ++ends[b];
    }
    for (int edge = 0; edge < kEdges; ++edge) {
      ASSERT_EQ(ends[edge], isCrossed(mask, edge) ? 2 : 0);
    }
    // Connected and of degree two everywhere: one cycle, of three crossings at least.
    for (const std::set<int>& loop : partitionOf(componentsOf(mask, joined), mask, 0)) {
      ASSERT_GE(loop.size(), 3U);
    }
  });
}

TEST(CaseTable, ComponentsAreNumberedByTheirLowestEdge) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    const Components components = componentsOf(mask, joined);
    int next = 0;
    for (int edge = 0; edge < kEdges; ++edge) {
      if (!isCrossed(mask, edge)) continue;
      ASSERT_LE(components.of(edge), next);
      next = std::max(next, components.of(edge) + 1);
    }
    ASSERT_EQ(next, components.count());
  });
}

TEST(CaseTable, BitsOfOtherFacesMeanNothing) {
  for (int mask = 0; mask < 256; ++mask) {
    for (int joined = 0; joined < 64; ++joined) {
      const auto corners = static_cast<CornerMask>(mask);
      const auto meant = static_cast<FaceBits>(joined & ambiguousFaces(corners));
      EXPECT_EQ(partitionOf(componentsOf(corners, static_cast<FaceBits>(joined)), corners, 0),
                partitionOf(componentsOf(corners, meant), corners, 0));
    }
  }
}

TEST(CaseTable, SeparatingInsideIsJoiningOutside) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    const auto complement = static_cast<CornerMask>(~mask);
    const auto swapped = static_cast<FaceBits>(~joined & ambiguousFaces(mask));
    ASSERT_EQ(partitionOf(componentsOf(mask, joined), mask, 0),
              partitionOf(componentsOf(complement, swapped), complement, 0));
  });
}

TEST(CaseTable, SplittingAFaceNeverMergesComponentsThatOwnBothItsArcs) {
  // What makes one sweep of flips enough: where a cell owns both arcs of a face in one component,
  // joining the face the other way splits that component.
  forAllCells([](CornerMask mask, FaceBits joined) {
    for (int face = 0; face < kFaces; ++face) {
      if (!isAmbiguous(mask, face)) continue;
      const Arcs arcs = arcsOf(mask, face, ((joined >> face) & 1) != 0);
      const Components before = componentsOf(mask, joined);
      if (before.of(arcs[0].first) != before.of(arcs[1].first)) continue;
      const auto flipped = static_cast<FaceBits>(joined ^ 1 << face);
      const Components after = componentsOf(mask, flipped);
      ASSERT_EQ(after.count(), before.count() + 1);
      const Arcs flippedArcs = arcsOf(mask, face, ((flipped >> face) & 1) != 0);
      ASSERT_NE(after.of(flippedArcs[0].first), after.of(flippedArcs[1].first));
    }
  });
}

// The arcs of one face as the code joins them: with all edges off the face cut, nothing else joins.
Partition facePartition(CornerMask mask, FaceBits joined, int face) {
  unsigned cut = 0xfff;
  for (const int edge : kFaceEdges[face]) cut &= ~(1U << edge);
  return partitionOf(joinCrossings(mask, joined, cut), mask, cut);
}

Partition movedAlong(const Partition& parts, int axis) {
  Partition moved;
  for (const std::set<int>& part : parts) {
    std::set<int> edges;
    for (const int edge : part) {
      const auto [lower, upper] = edgeCorners(edge);
      edges.insert(cells::edgeOf(lower ^ 1 << (2 - axis), upper ^ 1 << (2 - axis)));
    }
    moved.insert(edges);
  }
  return moved;
}

TEST(CaseTable, CellsThatShareAFaceSeeTheSameArcs) {
  for (int axis = 0; axis < 3; ++axis) {
    const int step = 1 << (2 - axis);
    for (int lower = 0; lower < 256; ++lower) {
      for (int upper = 0; upper < 256; ++upper) {
        bool fits = true;
        for (const int corner : cells::cornersOf(axis * 2)) {
          fits &= ((lower >> (corner | step)) & 1) == ((upper >> corner) & 1);
        }
        if (!fits) continue;
        for (int joined = 0; joined < 2; ++joined) {
          const auto below =
              facePartition(static_cast<CornerMask>(lower),
                            static_cast<FaceBits>(joined << (axis * 2 + 1)), axis * 2 + 1);
          const auto above = facePartition(static_cast<CornerMask>(upper),
                                           static_cast<FaceBits>(joined << (axis * 2)), axis * 2);
          ASSERT_EQ(movedAlong(below, axis), above) << lower << " " << upper;
        }
      }
    }
  }
}

TEST(CaseTable, CutEdgesLeaveTheChainsBetweenThem) {
  forAllCells([](CornerMask mask, FaceBits joined) {
    unsigned crossed = 0;
    for (int edge = 0; edge < kEdges; ++edge) crossed |= isCrossed(mask, edge) ? 1U << edge : 0;
    // Every subset of the crossings; of the 4096 of the checkerboard, some.
    const unsigned step = crossed == 0xfff ? 13 : 1;
    for (unsigned cut = 0; cut <= crossed; cut += step) {
      if ((cut & crossed) != cut) continue;
      const Components components = joinCrossings(mask, joined, cut);
      ASSERT_EQ(partitionOf(components, mask, cut), partitionOf(mask, joined, cut))
          << "mask " << int{mask} << " joined " << int{joined} << " cut " << cut;
    }
  });
}

}  // namespace
}  // namespace tufa::uniform
