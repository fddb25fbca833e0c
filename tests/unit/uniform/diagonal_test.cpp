#include "uniform/diagonal.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tufa::uniform {
namespace {

using Kind = uniform::VertexSheets::Kind;

/// A quad around the z axis, its corners at (-1,-1), (1,-1), (1,1), (-1,1) and the heights given.
Mesh quadOfHeights(double a, double b, double c, double d) {
  Mesh mesh;
  mesh.positions = {Position(-1, -1, a), Position(1, -1, b), Position(1, 1, c), Position(-1, 1, d)};
  mesh.quads = {Quad(0, 1, 2, 3)};
  return mesh;
}

bool isSecondBetter(const Mesh& mesh, const LatticeCrossing& crossing, double voxelSize = 1) {
  const SplitChooser chooser(mesh, mesh.quads[0], voxelSize);
  return chooser.isSecondDiagonalBetter([&] { return crossing; });
}

const LatticeCrossing kAtHeight0{Vec3(0, 0, 0), Vec3(0, 0, 1)};

TEST(SplitChooser, TakesTheDiagonalNearerToTheCrossing) {
  // The first diagonal passes at height 0, the second at 0.3; and the other way round.
  EXPECT_FALSE(isSecondBetter(quadOfHeights(0, 0.3, 0, 0.3), kAtHeight0));
  EXPECT_TRUE(isSecondBetter(quadOfHeights(0.3, 0, 0.3, 0), kAtHeight0));
  EXPECT_TRUE(isSecondBetter(quadOfHeights(0, 0.3, 0, 0.3), {Vec3(0, 0, 0.3), Vec3(0, 0, 1)}));
}

TEST(SplitChooser, LooksAtTheTriangleThatTheCrossingLiesIn) {
  // Off the diagonals: height 0.2 is on the first split's triangle (0, 1, 2) there.
  const Mesh mesh = quadOfHeights(0, 0.4, 0, -0.5);
  EXPECT_FALSE(isSecondBetter(mesh, {Vec3(0.5, -0.5, 0.2), Vec3(0, 0, 1)}));
}

TEST(SplitChooser, TakesTheShorterDiagonalOfFlatQuads) {
  Mesh mesh = quadOfHeights(0, 0, 0, 0);
  mesh.positions[2] = Position(2, 2, 0);
  EXPECT_TRUE(isSecondBetter(mesh, kAtHeight0));
  mesh.positions[2] = Position(0.2, 0.2, 0);
  EXPECT_FALSE(isSecondBetter(mesh, kAtHeight0));
}

TEST(SplitChooser, TakesTheInnerDiagonalOfConcaveQuads) {
  // Corner 0 is drawn in beyond the second diagonal, which is the shorter one but lies outside.
  Mesh mesh = quadOfHeights(0, 0, 0, 0);
  mesh.positions[0] = Position(0.4, 0.4, 0);
  mesh.positions[2] = Position(4, 4, 0);
  EXPECT_FALSE(isSecondBetter(mesh, {Vec3(1, 1, 0), Vec3(0, 0, 1)}));
}

TEST(SplitChooser, MeasuresInVoxels) {
  // A gap of 0.01 is nothing in voxels of 1, and much in voxels of 0.1: only then the crossing
  // counts.
  Mesh mesh = quadOfHeights(0.01, 0, 0.01, 0);
  mesh.positions[1] = Position(1.2, -1.2, 0);
  EXPECT_FALSE(isSecondBetter(mesh, kAtHeight0, 1));
  const SplitChooser chooser(mesh, mesh.quads[0], 0.1);
  bool asked = false;
  (void)chooser.isSecondDiagonalBetter([&] {
    asked = true;
    return kAtHeight0;
  });
  EXPECT_TRUE(asked);
}

TEST(SplitChooser, FollowsACreaseBeforeAllElse) {
  Mesh mesh = quadOfHeights(-1, 0, -1, 0);
  const float half = std::sqrt(0.5F);
  const Normal left(-half, 0, half), right(half, 0, half), up(0, 0, 1);
  mesh.normals = {left, up, right, up};
  uniform::VertexSheets sheets(4);
  sheets.setKinds(0, {Kind::Near, Kind::Near, Kind::Near, Kind::Near});
  sheets.setMeeting(1, {2, {left, right}});
  sheets.setMeeting(3, {2, {left, right}});
  const SplitChooser chooser(mesh, mesh.quads[0], 1);
  const auto below = [] { return LatticeCrossing{Vec3(0, 0, -1), Vec3(0, 0, 1)}; };
  EXPECT_FALSE(chooser.isSecondDiagonalBetter(below));
  EXPECT_TRUE(chooser.isSecondDiagonalBetterAtCrease(sheets, below));
}

}  // namespace
}  // namespace tufa::uniform
