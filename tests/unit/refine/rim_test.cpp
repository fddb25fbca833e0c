#include "refine/collapse/rim.h"

#include <gtest/gtest.h>

namespace tufa::refine {
namespace {

TEST(Rim, LetsAnyVerticesJoinWithoutCurves) {
  EXPECT_TRUE(Rim().mayJoin(0, 1));
  Rim rim;
  rim.add(1, {0, 0, 4, 6});
  EXPECT_TRUE(rim.mayJoin(0, 1));
  EXPECT_TRUE(rim.mayJoin(1, 7));
}

TEST(Rim, JoinsStretchesThatFollowEachOther) {
  Rim rim;
  rim.add(1, {0, 0, 0, 2});
  rim.add(2, {0, 0, 3, 3});
  rim.add(3, {0, 0, 4, 9});
  EXPECT_TRUE(rim.mayJoin(1, 2));
  EXPECT_TRUE(rim.mayJoin(3, 2));
  EXPECT_FALSE(rim.mayJoin(1, 3));  // 2 would be cut off
  rim.join(3, 2);
  EXPECT_TRUE(rim.mayJoin(1, 3));
  EXPECT_TRUE(rim.mayJoin(3, 1));
}

TEST(Rim, KeepsPartsOfACurveApart) {
  Rim rim;
  rim.add(1, {5, 0, 0, 2});
  rim.add(2, {5, 1, 3, 4});
  EXPECT_FALSE(rim.mayJoin(1, 2));
}

TEST(Rim, AsksForAllCurvesInCommonAndAtLeastOne) {
  Rim rim;
  rim.add(1, {0, 0, 7, 8});
  rim.add(2, {1, 0, 0, 1});
  EXPECT_FALSE(rim.mayJoin(1, 2));  // across the surface between two curves
  rim.add(1, {1, 0, 2, 2});
  EXPECT_TRUE(rim.mayJoin(1, 2));
  rim.add(2, {0, 0, 3, 4});
  EXPECT_FALSE(rim.mayJoin(1, 2));  // they follow each other on one curve only
}

TEST(Rim, PassesOnWhatAVertexStandsFor) {
  Rim rim;
  rim.add(1, {0, 0, 0, 0});
  rim.join(9, 1);  // a vertex inside takes a place on the rim
  rim.add(2, {0, 0, 1, 1});
  rim.add(3, {0, 0, 2, 2});
  EXPECT_TRUE(rim.mayJoin(9, 2));
  EXPECT_FALSE(rim.mayJoin(9, 3));
}

}  // namespace
}  // namespace tufa::refine
