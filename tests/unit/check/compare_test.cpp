#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/compare.h>
#include <tufa/error.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <string>

#include "support/expect_error.h"
#include "support/fields.h"
#include "support/shape.h"

namespace tufa {
namespace {

openvdb::FloatGrid::Ptr smallNoise() {
  test::NoiseOptions options;
  options.size = 8;
  return test::noise<openvdb::FloatGrid>(options);
}

const MethodResult& resultOf(const Comparison& all, const std::string& name) {
  const auto found = std::find_if(all.methods.begin(), all.methods.end(),
                                  [&](const MethodResult& one) { return one.name == name; });
  if (found == all.methods.end()) throw std::out_of_range(name);
  return *found;
}

TEST(Compare, MeasuresEveryMethodOnASphere) {
  CompareOptions options;
  options.truth = [](const Position& p) { return shapeDistance(Shape::Sphere, p); };
  const Comparison all = compareMethods(*test::shapeOf(Shape::Sphere, 0.1), options);
  ASSERT_EQ(all.methods.size(), comparedNames().size());
  EXPECT_EQ(all.trilinearEuler, 2);
  EXPECT_NEAR(all.voxelSize, 0.1, 1e-7);
  EXPECT_TRUE(all.differsAt.has_value());
  for (std::size_t i = 0; i < all.methods.size(); ++i) {
    const MethodResult& one = all.methods[i];
    EXPECT_EQ(one.name, comparedNames()[i]);
    EXPECT_TRUE(one.check.watertight()) << one.name;
    EXPECT_EQ(one.check.eulerCharacteristic, 2) << one.name;
    // Outward: 4.19 less what chords cut off. The adaptive peer is the coarsest by far.
    const bool coarse = one.name == "volume-to-mesh-0.25";
    EXPECT_GT(one.check.volume, coarse ? 3.5 : 4) << one.name;
    const double reach = coarse ? 1.2 : 0.3;
    EXPECT_LT(one.distance.meshToSurface.largest, reach) << one.name;
    EXPECT_LT(one.distance.surfaceToMesh.largest, reach) << one.name;
    ASSERT_TRUE(one.truth.has_value());
    EXPECT_LT(one.truth->meshToTruth.largest, reach) << one.name;
    EXPECT_EQ(one.truth->pointsToMesh.samples, 0u);
    EXPECT_GT(one.seconds, 0);
    EXPECT_GT(one.cpuSeconds, 0);
    EXPECT_FALSE(one.extraBytes.has_value());
    EXPECT_TRUE(one.mesh.positions.empty()) << one.name;
  }
}

TEST(Compare, ShowsWhatNoiseBreaks) {
  CompareOptions options;
  options.methods = {"mc-original", "mc33", "mc", "volume-to-mesh-0"};
  options.extract.contour.isovalue = 0;
  options.keepMeshes = true;
  const Comparison all = compareMethods(*smallNoise(), options);
  ASSERT_EQ(all.methods.size(), 4u);
  EXPECT_EQ(all.methods[0].name, "mc");  // the order of comparedNames()
  EXPECT_EQ(all.methods[0].mesh.triangleCount(), all.methods[0].check.triangles);
  EXPECT_TRUE(resultOf(all, "mc").check.closed);
  EXPECT_FALSE(resultOf(all, "mc-original").check.closed);
  EXPECT_EQ(resultOf(all, "mc33").check.eulerCharacteristic, all.trilinearEuler);
  EXPECT_GT(all.difference, 0.1);
}

TEST(Compare, GivesThePeerWhatIsTakenAsOutside) {
  const auto grid = test::shapeOf(Shape::Sphere, 0.1);
  for (auto value = grid->beginValueOn(); value; ++value) {
    if (*value > 0.15F && value.getCoord().x() == 3) value.setValue(NAN);
  }
  CompareOptions options;
  options.methods = {"volume-to-mesh-0", "dual-uniform"};
  test::expectError(ErrorCode::NonFiniteValues, "NaN",
                    [&] { static_cast<void>(compareMethods(*grid, options)); });
  options.extract.contour.nonFinite = NonFinite::Outside;
  const Comparison all = compareMethods(*grid, options);
  EXPECT_TRUE(resultOf(all, "volume-to-mesh-0").check.watertight());
  EXPECT_TRUE(resultOf(all, "dual-uniform").check.watertight());
}

TEST(Compare, MeasuresThePointsGiven) {
  CompareOptions options;
  options.methods = {"mc", "dual-uniform"};
  options.truth = [](const Position& p) { return shapeDistance(Shape::Box, p); };
  options.truthPoints = shapeCreasePoints(Shape::Box, 0.02);
  const Comparison all = compareMethods(*test::shapeOf(Shape::Box, 0.05), options);
  const TruthReport& dual = *resultOf(all, "dual-uniform").truth;
  const TruthReport& cubes = *resultOf(all, "mc").truth;
  EXPECT_EQ(dual.pointsToMesh.samples, options.truthPoints.size());
  EXPECT_LT(dual.pointsShare99, 0.1);
  EXPECT_GT(cubes.pointsShare99, 0.3);  // it cuts creases off
  EXPECT_LE(cubes.pointsShare99, cubes.pointsToMesh.largest);
}

TEST(Compare, FacesOfThePeerPointOutwardWhereInsideIsAbove) {
  const auto fog = test::sampled<openvdb::FloatGrid>(
      {openvdb::Coord(-8), openvdb::Coord(8)}, 0,
      [](const openvdb::Coord& at) { return 8 - at.asVec3d().length(); });
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  CompareOptions options;
  options.methods = {"volume-to-mesh-0", "mc"};
  options.extract.contour.isovalue = 3;
  const Comparison all = compareMethods(*fog, options);
  EXPECT_FALSE(all.insideIsBelow);
  for (const MethodResult& one : all.methods) EXPECT_TRUE(one.check.outward) << one.name;
  // Along the way out.
  const Normal& n = all.outward;
  const Position& p = *all.differsAt;
  EXPECT_GT(n.x * p.x + n.y * p.y + n.z * p.z, 0);
}

TEST(Compare, FiguresAreTheSameForAnyNumberOfThreads) {
  std::array<Comparison, 2> runs;
  for (int i = 0; i < 2; ++i) {
    CompareOptions options;
    options.methods = {"mc", "volume-to-mesh-0.25"};
    options.extract.contour.threads = i + 1;
    options.extract.contour.isovalue = 0;
    runs[i] = compareMethods(*smallNoise(), options);
  }
  EXPECT_EQ(runs[0].differsAt, runs[1].differsAt);
  EXPECT_EQ(runs[0].difference, runs[1].difference);
  for (std::size_t i = 0; i < 2; ++i) {
    const MethodResult &one = runs[0].methods[i], &two = runs[1].methods[i];
    EXPECT_EQ(one.check.triangles, two.check.triangles);
    EXPECT_EQ(one.check.selfIntersectingPairs, two.check.selfIntersectingPairs);
    EXPECT_EQ(one.distance.meshToSurface.rms, two.distance.meshToSurface.rms);
    EXPECT_EQ(one.distance.surfaceToMesh.rms, two.distance.surfaceToMesh.rms);
  }
}

TEST(Compare, TellsTheMemoryIfAsked) {
#ifdef __linux__
  CompareOptions options;
  options.methods = {"mt24"};
  options.memory = true;
  const Comparison all = compareMethods(*test::shapeOf(Shape::Sphere, 0.04), options);
  ASSERT_TRUE(all.methods[0].extraBytes.has_value());
  // The mesh at least: a position is 24 bytes, a normal and a triangle are 12 each.
  const CheckReport& check = all.methods[0].check;
  EXPECT_GT(*all.methods[0].extraBytes, 36 * check.vertices + 12 * check.triangles);
#else
  GTEST_SKIP() << "only Linux tells";
#endif
}

TEST(Compare, ProgressRisesAndCancels) {
  CompareOptions options;
  options.methods = {"mc", "volume-to-mesh-0"};
  options.repeats = 2;
  double last = 0;
  std::size_t calls = 0;
  options.extract.contour.progress = [&](std::string_view /*stage*/, double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    ++calls;
    return true;
  };
  const auto grid = test::shapeOf(Shape::Sphere, 0.1);
  (void)compareMethods(*grid, options);
  EXPECT_EQ(last, 1);
  EXPECT_GT(calls, 10u);
  options.extract.contour.progress = [](std::string_view /*stage*/, double fraction) {
    return fraction < 0.5;
  };
  test::expectError(ErrorCode::Cancelled, "cancel", [&] { (void)compareMethods(*grid, options); });
}

TEST(Compare, RefusesWhatMeansNothing) {
  const auto grid = test::shapeOf(Shape::Sphere, 0.5);
  const auto refused = [&](const std::string& part, const auto& change) {
    CompareOptions options;
    change(options);
    test::expectError(ErrorCode::InvalidArgument, part,
                      [&] { (void)compareMethods(*grid, options); });
  };
  refused("\"cubes\"", [](CompareOptions& o) { o.methods = {"mc", "cubes"}; });
  refused("runs", [](CompareOptions& o) { o.repeats = 0; });
  refused("samplesPerEdge", [](CompareOptions& o) { o.samplesPerEdge = 1; });
  refused("holes", [](CompareOptions& o) { o.extract.contour.ambiguity = Ambiguity::Original; });
}

}  // namespace
}  // namespace tufa
