// What every method of extract() promises: closed, oriented 2-manifolds on any field, the same
// bytes for any number of threads, and the grids, places and errors of contour().

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/extract.h>
#include <tufa/shapes.h>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"

namespace tufa {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;

class Methods : public ::testing::TestWithParam<Method> {
 protected:
  static Mesh meshOf(const openvdb::GridBase& grid, const ContourOptions& contour = {},
                     ContourReport* report = nullptr) {
    return extract(grid, GetParam(), {contour}, report);
  }
  /// Of fields whose surface is where they are 0, and inside where they are below.
  static ContourOptions atZero(Ambiguity rule = Ambiguity::Separate) {
    ContourOptions options;
    options.isovalue = 0;
    options.inside = Inside::Below;
    options.ambiguity = rule;
    return options;
  }
  /// The rules for ambiguous faces that make a difference.
  static std::vector<Ambiguity> rules() {
    const bool asks =
        GetParam() < Method::MarchingTetrahedra5 && GetParam() != Method::MarchingCubes33;
    if (!asks) return {Ambiguity::Separate};
    if (GetParam() == Method::ExtendedMarchingCubes) {
      return {Ambiguity::Separate, Ambiguity::Asymptotic};
    }
    return {Ambiguity::Separate, Ambiguity::Join, Ambiguity::Asymptotic, Ambiguity::Chord};
  }
};

std::vector<Method> allButDual() {
  std::vector<Method> methods;
  for (const std::string_view name : methodNames()) {
    if (name != "dual") methods.push_back(*methodByName(name));
  }
  return methods;
}

INSTANTIATE_TEST_SUITE_P(All, Methods, ::testing::ValuesIn(allButDual()), [](const auto& test) {
  std::string name(methodNames().at(static_cast<std::size_t>(test.param)));
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
});

void expectManifold(const Mesh& mesh, const std::string& what) {
  const test::MeshTopology topology = test::inspect(test::triangulated(mesh));
  EXPECT_TRUE(topology.manifold() && topology.closed()) << what << ": " << topology;
}

TEST_P(Methods, GiveClosedManifoldsOfNoiseAndTheSameBytesForAnyThreads) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    // As marching cubes, which stand for it.
    if (GetParam() == Method::OctreeCubes && seed > 1) break;
    const auto grid = test::noise<FloatGrid>({.size = 28, .seed = seed});
    for (const Ambiguity rule : rules()) {
      ContourOptions options = atZero(rule);
      options.threads = 1;
      const Mesh mesh = meshOf(*grid, options);
      EXPECT_GT(mesh.triangleCount(), 20000U);
      expectManifold(mesh, "noise " + std::to_string(seed));
      EXPECT_GT(test::volume(mesh), 0);
      if (seed != 1) continue;
      options.threads = 2;
      EXPECT_TRUE(test::sameBytes(mesh, meshOf(*grid, options))) << seed;
    }
  }
}

TEST_P(Methods, GiveClosedManifoldsWhereManySamplesAreOnTheIsovalue) {
  const auto grid = test::noise<FloatGrid>({.size = 32, .seed = 4, .wholeNumbers = true});
  for (const Ambiguity rule : {Ambiguity::Separate, Ambiguity::Asymptotic}) {
    expectManifold(meshOf(*grid, atZero(rule)), "whole numbers");
  }
}

TEST_P(Methods, GiveClosedManifoldsOfLeavesAndTiles) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const auto grid = test::randomTree<openvdb::DoubleGrid>({.seed = seed, .blocks = 6});
    for (const Ambiguity rule : {Ambiguity::Separate, Ambiguity::Join}) {
      expectManifold(meshOf(*grid, atZero(rule)), "tree " + std::to_string(seed));
    }
  }
}

TEST_P(Methods, GiveClosedManifoldsOfShapes) {
  for (const Shape shape : {Shape::Gyroid, Shape::Bracket, Shape::Fog, Shape::Terrain}) {
    ShapeOptions options;
    options.voxelSize = 0.04;
    const auto grid = makeShape(shape, options);
    expectManifold(meshOf(*grid), std::to_string(static_cast<int>(shape)));
  }
}

TEST_P(Methods, AreNearASphere) {
  const auto ball = makeShape(Shape::Sphere);
  ContourReport report;
  const Mesh mesh = meshOf(*ball, {}, &report);
  EXPECT_TRUE(report.distanceField);
  EXPECT_GT(report.surfaceCells, 10000U);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Position& p = mesh.positions[i];
    const Normal& n = mesh.normals[i];
    const double radius = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    EXPECT_NEAR(radius, 1, 0.02 * (GetParam() == Method::OctreeCubes ? 0.1 : 0.05));
    const double along = p.x * double{n.x} + p.y * double{n.y} + p.z * double{n.z};
    EXPECT_GT(along / radius, 0.999);
  }
  EXPECT_EQ(test::inspect(mesh).euler(), 2);
}

TEST_P(Methods, FollowAnyAffineTransformAndAreNotTurnedOverByMirrors) {
  auto grid = makeShape(Shape::Torus);
  const Mesh before = meshOf(*grid);
  const auto map = openvdb::Mat4d(-0.02, 0.0, 0.0, 0.0, 0.004, 0.03, 0.0, 0.0, 0.0, 0.01, 0.02, 0.0,
                                  5.0, -7.0, 9.0, 1.0);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
  const Mesh mesh = meshOf(*grid);
  expectManifold(mesh, "mirrored");
  EXPECT_NEAR(test::volume(mesh) / test::volume(before), 0.02 * 0.03 * 0.02 / 8e-6, 0.01);
}

TEST_P(Methods, TakeTheOptionsOfTheField) {
  const auto grid = makeShape(Shape::Sphere);
  ContourOptions options;
  options.isovalue = 0.02;
  options.normals = Normals::None;
  const Mesh larger = meshOf(*grid, options);
  EXPECT_TRUE(larger.normals.empty());
  EXPECT_GT(test::volume(larger), 1.05 * test::volume(meshOf(*grid)));
  options.normals = Normals::Faces;
  EXPECT_EQ(meshOf(*grid, options).normals.size(), larger.positions.size());
  auto holed = grid->deepCopy();
  holed->tree().setValueOn(openvdb::Coord(0, 0, 50), std::numeric_limits<float>::quiet_NaN());
  test::expectError(ErrorCode::NonFiniteValues, "NaN", [&] { (void)meshOf(*holed); });
  options.nonFinite = NonFinite::Outside;
  expectManifold(meshOf(*holed, options), "NaN");
}

TEST_P(Methods, EndWhereALevelSetEndsUnlessItIsCapped) {
  auto half = makeShape(Shape::Sphere);
  half->clip(CoordBBox(openvdb::Coord(-1000, -1000, -1000), openvdb::Coord(1000, 1000, 3)));
  ContourReport report;
  const Mesh open = meshOf(*half, {}, &report);
  EXPECT_GT(report.openEdges, 0U);
  const test::MeshTopology topology = test::inspect(open);
  EXPECT_TRUE(topology.manifold()) << topology;
  EXPECT_GT(topology.boundaryEdges, 0U);
  ContourOptions options;
  options.cap = true;
  expectManifold(meshOf(*half, options, &report), "capped");
  EXPECT_EQ(report.openEdges, 0U);
}

TEST_P(Methods, OfAGridWithoutSurfaceAreEmpty) {
  EXPECT_EQ(meshOf(*FloatGrid::create(1), atZero()).positions.size(), 0U);
}

TEST_P(Methods, TellProgressAndStopAnywhere) {
  const auto grid = makeShape(Shape::Sphere);
  ContourOptions options;
  double last = 0;
  int calls = 0;
  options.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
    ++calls;
    return true;
  };
  (void)meshOf(*grid, options);
  EXPECT_EQ(last, 1);
  ASSERT_GE(calls, 6);
  for (int stop = 1; stop <= 6; ++stop) {
    int seen = 0;
    options.progress = [&](std::string_view, double) { return ++seen < stop; };
    test::expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)meshOf(*grid, options); });
  }
}

TEST_P(Methods, RefuseTheRuleThatLeavesHolesUnlessTheyAreMarchingCubes) {
  const auto grid = test::noise<FloatGrid>({.size = 24});
  const ContourOptions options = atZero(Ambiguity::Original);
  if (GetParam() != Method::MarchingCubes) {
    test::expectError(ErrorCode::InvalidArgument, "original",
                      [&] { (void)meshOf(*grid, options); });
    return;
  }
  const test::MeshTopology topology = test::inspect(meshOf(*grid, options));
  EXPECT_GT(topology.boundaryEdges, 0U);
  EXPECT_EQ(topology.misorientedEdges, 0U);
}

TEST(MethodNames, AreThoseOfTheEnum) {
  for (std::size_t i = 0; i < methodNames().size(); ++i) {
    EXPECT_EQ(methodByName(methodNames().at(i)), static_cast<Method>(i));
  }
  EXPECT_FALSE(methodByName("marching"));
  EXPECT_EQ(methodByName("mc"), Method::MarchingCubes);
  const auto ball = makeShape(Shape::Sphere);
  test::expectError(ErrorCode::InvalidArgument, "has no meaning",
                    [&] { (void)extract(*ball, static_cast<Method>(99)); });
  test::expectError(ErrorCode::InvalidArgument, "original", [&] {
    ContourOptions options;
    options.ambiguity = Ambiguity::Original;
    (void)contour(*ball, options);
  });
}

TEST(MethodsOfCubes, PutTheSameVerticesOnLatticeEdges) {
  const auto grid = test::noise<FloatGrid>({.size = 32});
  ExtractOptions options;
  options.contour.isovalue = 0;
  options.contour.inside = Inside::Below;
  const Mesh plain = extract(*grid, Method::MarchingCubes, options);
  for (const Method method :
       {Method::MarchingCubes33, Method::ExtendedMarchingCubes, Method::CubicalMarchingSquares}) {
    const Mesh mesh = extract(*grid, method, options);
    ASSERT_GE(mesh.positions.size(), plain.positions.size());
    for (std::size_t i = 0; i < plain.positions.size(); ++i) {
      ASSERT_EQ(mesh.positions[i], plain.positions[i]);
      ASSERT_EQ(mesh.normals[i], plain.normals[i]);
    }
  }
}

// Formats that join vertices by their places would else hold no manifold: on this bracket two
// sheets have their points at one place in a few cells.
TEST(MethodsWithPointsInCells, GiveEachVertexAPlaceOfItsOwn) {
  ShapeOptions shape;
  shape.voxelSize = 0.03;
  const auto bracket = makeShape(Shape::Bracket, shape);
  for (const Method method : {Method::ExtendedMarchingCubes, Method::CubicalMarchingSquares}) {
    const Mesh mesh = extract(*bracket, method);
    std::set<std::array<float, 3>> places;
    for (const Position& p : mesh.positions) {
      places.insert({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    EXPECT_EQ(places.size(), mesh.positions.size());
  }
}

TEST(MethodDual, IsContour) {
  const auto ball = makeShape(Shape::Sphere);
  EXPECT_TRUE(test::sameBytes(extract(*ball, Method::Dual), contour(*ball)));
}

}  // namespace
}  // namespace tufa
