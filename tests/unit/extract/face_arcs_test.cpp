// Marching squares on the faces of cells.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "extract/cube_cases.h"
#include "extract/face_arcs.h"

namespace tufa::extraction {
namespace {

using uniform::kFaceCorners;
using uniform::kFaceEdges;

constexpr double kLeastCosine = 0.9;

/// The crossing at a place of a face, with a tangent line whose outward normal has this angle, in
/// degrees from the first axis.
FaceCrossing crossing(double u, double v, double degrees) {
  const double angle = degrees * std::acos(-1.0) / 180;
  FaceCrossing made;
  made.at = {u, v};
  made.plane = {std::cos(angle), std::sin(angle)};
  made.normal = {static_cast<float>(made.plane[0]), static_cast<float>(made.plane[1]), 0};
  return made;
}

TEST(FaceArcs, AreThoseOfTheLoopsOfBothCells) {
  for (int number = 0; number < 256; ++number) {
    const auto mask = static_cast<CornerMask>(number);
    for (int bits = 0; bits < 64; ++bits) {
      const CaseCode code = codeOf(mask, static_cast<FaceBits>(bits));
      const FaceBits faces = uniform::ambiguousFaces(mask);
      EXPECT_EQ(joinedFacesOf(code), bits & faces);
      EXPECT_EQ(maskOf(code), mask);
      const CubeCase& cell = caseOf(code);
      int arcs = 0;
      for (int face = 0; face < kFaces; ++face) {
        const FaceArcs all = arcsOf(mask, face, ((bits >> face) & 1) != 0);
        for (int i = 0; i < all.count; ++i, ++arcs) {
          const int from = kFaceEdges[face][all.arcs[i].from];
          const int to = kFaceEdges[face][all.arcs[i].to];
          // The loops of the cells on both sides run in opposite directions.
          EXPECT_TRUE(runsCounterClockwise(face) ? cell.next[from] == to : cell.next[to] == from);
          EXPECT_EQ(arcWith(mask, face, from, to), i);
        }
      }
      int crossed = 0;
      for (int edge = 0; edge < kEdges; ++edge) crossed += cell.next[edge] >= 0 ? 1 : 0;
      EXPECT_EQ(arcs, crossed) << number;
    }
  }
}

TEST(FaceArcs, HaveASharpPointWhereTheirTangentLinesMeet) {
  // The inside is the corner (0, 0), cut off by the lines v = 0.6 and u = 0.7.
  const FaceCrossing from = crossing(0, 0.6, 90), to = crossing(0.7, 0, 0);
  EXPECT_TRUE(isSharp(from, to, kLeastCosine));
  const auto point = sharpPoint(from, to, kLeastCosine);
  ASSERT_TRUE(point);
  EXPECT_NEAR((*point)[0], 0.7, 1e-12);
  EXPECT_NEAR((*point)[1], 0.6, 1e-12);
}

TEST(FaceArcs, HaveNoSharpPointWhereTheyAreSmoothOrLinesMeetElsewhere) {
  // 20 degrees apart.
  EXPECT_FALSE(sharpPoint(crossing(0, 0.6, 55), crossing(0.7, 0, 35), kLeastCosine));
  // The lines meet at (1.4, 0.6), beyond the face.
  EXPECT_FALSE(sharpPoint(crossing(0, 0.6, 90), crossing(0.7, 0, -40.601294), kLeastCosine));
  // The same lines walked the other way: the point is behind the start.
  EXPECT_FALSE(sharpPoint(crossing(0.7, 0, 0), crossing(0, 0.6, 90), kLeastCosine));
  // Opposite sides of a plate: parallel.
  EXPECT_FALSE(sharpPoint(crossing(0, 0.6, 90), crossing(0.4, 0, -90), kLeastCosine));
  EXPECT_FALSE(isInFace({0.5, 1}));
  EXPECT_TRUE(isInFace({0.5, 0.9}));
}

/// The crossings of face 4 (u and v are the axes 0 and 1) with the corners (0, 0) and (1, 1)
/// inside, each with a sharp corner at the tip towards the other.
std::array<FaceCrossing, 4> tips(double first, double second) {
  // Edges v = 0, u = 1, v = 1, u = 0. The tips are at (first, first) and (second, second).
  return {crossing(first, 0, 0), crossing(1, second, -90), crossing(second, 1, 180),
          crossing(0, first, 90)};
}

TEST(FaceArcs, JoinAnAmbiguousFaceSoThatTheyDoNotIntersect) {
  const auto& corners = kFaceCorners[4];
  const auto mask = static_cast<CornerMask>(1 << corners[0] | 1 << corners[2]);
  ASSERT_TRUE(uniform::isAmbiguous(mask, 4));
  for (const bool otherwise : {false, true}) {
    // Two squares that overlap can only be joined, and only be kept apart if they do not.
    EXPECT_TRUE(joinsInside(mask, 4, tips(0.8, 0.2), kLeastCosine, otherwise));
    EXPECT_FALSE(joinsInside(mask, 4, tips(0.3, 0.7), kLeastCosine, otherwise));
    // Bevelled corners tell nothing.
    const std::array<FaceCrossing, 4> bevels = {crossing(0.3, 0, 45), crossing(1, 0.7, 225),
                                                crossing(0.7, 1, 225), crossing(0, 0.3, 45)};
    EXPECT_EQ(joinsInside(mask, 4, bevels, kLeastCosine, otherwise), otherwise);
  }
  // Inside and outside exchanged, and the normals turned: now the outside corners are joined.
  std::array<FaceCrossing, 4> turned = tips(0.8, 0.2);
  for (FaceCrossing& one : turned) {
    for (double& x : one.plane) x = -x;
    one.normal = {-one.normal.x, -one.normal.y, 0};
  }
  const auto inverse = static_cast<CornerMask>(~mask);
  for (const bool otherwise : {false, true}) {
    EXPECT_FALSE(joinsInside(inverse, 4, turned, kLeastCosine, otherwise));
  }
}

}  // namespace
}  // namespace tufa::extraction
