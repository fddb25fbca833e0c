// The surface is found wherever it passes, and comes out right under any transform.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <tufa/contour.h>
#include <cmath>
#include <vector>

#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;
using openvdb::Mat4d;
using openvdb::Vec3d;

/// Lattice edges in a window whose ends lie on different sides: the quads that there must be.
std::size_t crossedEdges(const FloatGrid& grid, const CoordBBox& window, double isovalue) {
  std::size_t count = 0;
  const auto accessor = grid.getConstAccessor();
  for (auto at = window.begin(); at; ++at) {
    const bool here = accessor.getValue(*at) < isovalue;
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord next = *at;
      ++next[axis];
      count += here != (accessor.getValue(next) < isovalue) ? 1 : 0;
    }
  }
  return count;
}

void expectWholeSurface(const FloatGrid& grid, const CoordBBox& window, const char* what) {
  ContourOptions options;
  options.isovalue = 0;
  options.inside = Inside::Below;
  const Mesh mesh = tufa::test::uniformMesh(grid, options);
  EXPECT_EQ(test::edgesOf(mesh), crossedEdges(grid, window, 0)) << what;
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.manifold() && topology.closed()) << what << " " << topology;
  EXPECT_GT(test::volume(mesh), 0) << what;
}

// Densities in whatever unit: squares of their differences are no floats.
TEST(ContourPlaces, OfValuesOfAnySizeIsTheSame) {
  constexpr double kRadius = 9.3;
  const auto meshOf = [](double unit) {
    const auto fog = test::sampled<FloatGrid>(
        CoordBBox(openvdb::Coord(-14), openvdb::Coord(14)), 0, [&](const openvdb::Coord& at) {
          const double r = at.asVec3d().length();
          return unit * std::max(0.0, 2 + std::sin(kRadius - r) + 0.1 * (kRadius - r));
        });
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    ContourOptions options;
    options.isovalue = static_cast<float>(2 * unit);
    options.uniform = true;
    return contour(*fog, options);
  };
  const Mesh plain = meshOf(1);
  for (const int exponent : {-110, -80, -50, 50, 80, 110}) {
    const Mesh mesh = meshOf(std::ldexp(1.0, exponent));
    ASSERT_EQ(mesh.positions.size(), plain.positions.size()) << exponent;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const Position &p = mesh.positions[i], &q = plain.positions[i];
      ASSERT_LT(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z), 1e-5) << exponent;
    }
  }
}

// Two balls, however far from each other: single precision does not tell their voxels apart from
// one middle.
TEST(ContourPlaces, OfPiecesFarApartKeepTheTolerance) {
  constexpr double kRadius = 12.3;
  for (const int far : {1 << 14, 1 << 19, 1 << 30}) {
    auto grid = FloatGrid::create(3);
    const openvdb::Coord centres[] = {{far, -far, 5}, {-far, far / 2, -far}};
    for (const openvdb::Coord& centre : centres) {
      for (auto at = CoordBBox(centre.offsetBy(-16), centre.offsetBy(16)).begin(); at; ++at) {
        const double distance = (*at - centre).asVec3d().length() - kRadius;
        if (std::abs(distance) < 3) grid->tree().setValueOn(*at, static_cast<float>(distance));
        if (distance <= -3) grid->tree().setValueOff(*at, -3);
      }
    }
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    for (const bool simplify : {true, false}) {
      ContourOptions options;
      options.simplify = simplify;
      ContourReport report;
      const Mesh mesh = contour(*grid, options, &report);
      EXPECT_LT(mesh.triangleCount(), simplify ? 1500u : 4000u) << far;
      EXPECT_LE(report.certificate->maxErrorVoxels, 0.1) << far;
      const test::MeshTopology topology = test::inspect(mesh);
      EXPECT_TRUE(topology.manifold() && topology.closed() && topology.components == 2) << far;
      for (const Position& p : mesh.positions) {
        const openvdb::Coord& centre = centres[p.x > 0 ? 0 : 1];
        const double off =
            std::hypot(p.x - centre.x(), p.y - centre.y(), p.z - centre.z()) - kRadius;
        // The uniform mesh is 0.02 voxels off the ball.
        ASSERT_LE(std::abs(off), report.certificate->maxErrorVoxels + 0.02) << far;
      }
    }
  }
}

TEST(ContourPlaces, BetweenALeafAndATile) {
  auto grid = FloatGrid::create(1);
  grid->tree().addTile(1, openvdb::Coord(0), -1, true);
  grid->tree().setValueOn(openvdb::Coord(8, 2, 2), -1);
  grid->tree().setValueOn(openvdb::Coord(-3, 2, 2), -1);
  expectWholeSurface(*grid, CoordBBox(openvdb::Coord(-12), openvdb::Coord(20)), "leaf and tile");
}

TEST(ContourPlaces, BetweenTilesOfEverySize) {
  for (const openvdb::Index level : {1U, 2U}) {
    auto grid = FloatGrid::create(1);
    grid->tree().addTile(level, openvdb::Coord(0), -1, false);
    const int size = level == 1 ? 8 : 128;
    expectWholeSurface(*grid, CoordBBox(openvdb::Coord(-2), openvdb::Coord(size + 2)), "tile");
    grid->tree().addTile(1, openvdb::Coord(size, 0, 0), -1, true);
    expectWholeSurface(*grid, CoordBBox(openvdb::Coord(-2), openvdb::Coord(size + 10)),
                       "small beside large");
  }
}

TEST(ContourPlaces, OneStepBelowTheOriginOfALeaf) {
  for (int mask = 1; mask < 8; ++mask) {
    // The only sample inside is the first of its leaf on some axes.
    const openvdb::Coord at((mask & 1) != 0 ? 8 : 11, (mask & 2) != 0 ? 8 : 11,
                            (mask & 4) != 0 ? 8 : 11);
    auto grid = FloatGrid::create(1);
    grid->tree().setValueOn(at, -1);
    expectWholeSurface(*grid, CoordBBox(openvdb::Coord(0), openvdb::Coord(20)), "first sample");
  }
}

TEST(ContourPlaces, InRandomTrees) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto grid = test::randomTree<FloatGrid>({.seed = seed});
    expectWholeSurface(*grid, CoordBBox(openvdb::Coord(-30), openvdb::Coord(40)), "random tree");
  }
}

TEST(ContourPlaces, InNarrowBandsFromHalfWidthOne) {
  const double radius = 12.3;
  for (const double halfWidth : {1.0, 1.5, 2.0, 5.0}) {
    const auto grid = test::levelSet<FloatGrid>(
        CoordBBox(openvdb::Coord(-20), openvdb::Coord(20)), halfWidth,
        [&](const openvdb::Coord& at) { return at.asVec3d().length() - radius; });
    ContourReport report;
    const Mesh mesh = tufa::test::uniformMesh(*grid, {}, &report);
    EXPECT_EQ(report.openEdges, 0U) << halfWidth;
    const test::MeshTopology topology = test::inspect(mesh);
    EXPECT_TRUE(topology.manifold() && topology.closed()) << halfWidth << " " << topology;
    EXPECT_EQ(topology.euler(), 2);
    for (const Position& p : mesh.positions) {
      // The narrowest band has no sample beside those of a crossing to take a slope from.
      EXPECT_NEAR(std::hypot(p.x, p.y, p.z), radius,
                  halfWidth == 1  ? 0.2
                  : halfWidth < 2 ? 0.1
                                  : 0.05)
          << halfWidth;
    }
  }
}

TEST(ContourPlaces, PrunedAndDenseGridsGiveTheSameSurface) {
  auto grid = test::levelSet<FloatGrid>(
      CoordBBox(openvdb::Coord(-30), openvdb::Coord(30)), 3,
      [](const openvdb::Coord& at) { return at.asVec3d().length() - 25.2; });
  const Mesh before = tufa::test::uniformMesh(*grid);
  openvdb::tools::pruneLevelSet(grid->tree());
  const Mesh after = tufa::test::uniformMesh(*grid);
  EXPECT_EQ(before.quads.size(), after.quads.size());
  EXPECT_NEAR(test::volume(before), test::volume(after), 1e-6 * test::volume(before));
}

struct NamedTransform {
  const char* name;
  Mat4d matrix;
};

std::vector<NamedTransform> transforms() {
  const Mat4d identity = Mat4d::identity();
  Mat4d uniform = identity, scaled = identity, turned = identity, sheared = identity;
  uniform.preScale(Vec3d(0.01));
  scaled.preScale(Vec3d(0.5, 1, 3));
  turned.preRotate(openvdb::math::X_AXIS, 0.7);
  turned.preRotate(openvdb::math::Z_AXIS, 1.9);
  turned.preTranslate(Vec3d(1000, -500, 2));
  sheared.preShear(openvdb::math::X_AXIS, openvdb::math::Y_AXIS, 0.6);
  sheared.preScale(Vec3d(2, 1, 0.7));
  std::vector<NamedTransform> all = {
      {"uniform", uniform}, {"scaled", scaled}, {"turned", turned}, {"sheared", sheared}};
  for (const NamedTransform& plain : std::vector<NamedTransform>(all)) {
    Mat4d mirrored = plain.matrix;
    mirrored.preScale(Vec3d(-1, 1, 1));
    all.push_back({"mirrored", mirrored});
  }
  return all;
}

TEST(ContourPlaces, AnyAffineTransformKeepsTheSurfaceOutward) {
  const double radius = 9.7;
  for (const auto& [name, matrix] : transforms()) {
    auto grid = test::sampled<FloatGrid>(
        CoordBBox(openvdb::Coord(-13), openvdb::Coord(13)), 5,
        [&](const openvdb::Coord& at) { return std::min(at.asVec3d().length() - radius, 5.0); });
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    ContourOptions options;
    options.isovalue = 0;
    const Mesh mesh = tufa::test::uniformMesh(*grid, options);
    const test::MeshTopology topology = test::inspect(mesh);
    EXPECT_TRUE(topology.manifold() && topology.closed()) << name << " " << topology;
    const double truth = 4.18879020478639 * std::pow(radius, 3) * std::abs(matrix.det());
    EXPECT_NEAR(test::volume(mesh) / truth, 1, 0.01) << name;
    // Back in index space every vertex is on the ball, and normals are orthogonal to its tangents.
    const Mat4d inverse = matrix.inverse();
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Position& p = mesh.positions[v];
      const Vec3d index = inverse.transform(Vec3d(p.x, p.y, p.z));
      ASSERT_NEAR(index.length(), radius, 0.05) << name;
      const Vec3d tangentA =
          index.cross(std::abs(index[0]) < radius / 2 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0));
      const Vec3d tangentB = index.cross(tangentA);
      const Vec3d normal(mesh.normals[v].x, mesh.normals[v].y, mesh.normals[v].z);
      ASSERT_NEAR(normal.length(), 1, 1e-5);
      ASSERT_LT(std::abs(normal.dot(matrix.transform3x3(tangentA).unit())), 0.03) << name;
      ASSERT_LT(std::abs(normal.dot(matrix.transform3x3(tangentB).unit())), 0.03) << name;
      ASSERT_GT(normal.dot(matrix.transform3x3(index)), 0) << name;
    }
  }
}

}  // namespace
}  // namespace tufa
