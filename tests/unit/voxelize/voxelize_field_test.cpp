// Fields as level sets: what is sampled, where the surface comes to lie, and what is told of parts
// that no sample shows.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetMeasure.h>

#include <tufa/contour.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>
#include <tufa/voxelize.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>

#include "base/vec3.h"
#include "implicit/fields.h"
#include "support/expect_error.h"

namespace tufa {
namespace {

using implicit::combine;
using implicit::Field;
using implicit::FieldPtr;
using implicit::Operation;
using test::expectError;

VoxelizeOptions voxelsOf(double size) {
  VoxelizeOptions options;
  options.voxelSize = size;
  return options;
}

/// The greatest distance of a mesh's vertices to the field's surface.
double worstVertex(const Mesh& mesh, const Field& field) {
  double worst = 0;
  for (const Position& p : mesh.positions) worst = std::max(worst, std::abs(field.distance(p, 1)));
  return worst;
}

double distanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t =
      std::clamp((p - a).dot(along) / std::max(along.squaredLength(), 1e-300), 0.0, 1.0);
  return (p - a - along * t).length();
}

/// From a point to the nearest edge of a mesh: creases lie along edges.
double distanceToEdges(const Vec3& p, const Mesh& mesh) {
  double best = 1e300;
  for (const Triangle& t : triangulate(mesh)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = mesh.positions[t.vertices[k]];
      const Vec3 b = mesh.positions[t.vertices[(k + 1) % 3]];
      if ((a - p).squaredLength() < 4) best = std::min(best, distanceToSegment(p, a, b));
    }
  }
  return best;
}

TEST(VoxelizeField, SamplesADistanceAsItIs) {
  const auto field = implicit::makeSphere({0.3, 0.2, 0.1}, 1);
  VoxelizeReport report;
  const auto grid = voxelize(*field, voxelsOf(0.05), &report);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(report.activeVoxels, grid->activeVoxelCount());
  EXPECT_EQ(report.hiddenVoxels + report.undecidedVoxels, 0u);
  std::size_t band = 0;
  for (int x = -20; x <= 30; ++x) {
    for (int y = -22; y <= 28; ++y) {
      for (int z = -24; z <= 26; ++z) {
        const double truth = field->value({x * 0.05, y * 0.05, z * 0.05});
        const openvdb::Coord at(x, y, z);
        const bool active = static_cast<float>(std::abs(truth)) < grid->background();
        band += active ? 1 : 0;
        ASSERT_EQ(grid->tree().isValueOn(at), active) << at;
        ASSERT_NEAR(grid->tree().getValue(at), std::clamp(truth, -0.15, 0.15), 1e-6) << at;
      }
    }
  }
  EXPECT_EQ(band, report.activeVoxels);
  EXPECT_GE(report.samples, report.activeVoxels);
}

TEST(VoxelizeField, IsTheSameForAnyNumberOfThreads) {
  const auto field = combine(Operation::Intersection,
                             {implicit::makeSheet(implicit::Lattice::Gyroid, 1, {0.1, 0.1}),
                              implicit::makeSphere({0, 0, 0}, 1)},
                             0);
  const auto with = [&](int threads, VoxelizeReport& report) {
    VoxelizeOptions options = voxelsOf(0.05);
    options.threads = threads;
    return voxelize(*field, options, &report);
  };
  VoxelizeReport one;
  VoxelizeReport many;
  const auto a = with(1, one);
  const auto b = with(7, many);
  EXPECT_TRUE(a->tree().hasSameTopology(b->tree()));
  for (auto value = a->cbeginValueOn(); value; ++value) {
    ASSERT_EQ(*value, b->tree().getValue(value.getCoord()));
  }
  EXPECT_EQ(one.samples, many.samples);
  EXPECT_EQ(one.hiddenVoxels, many.hiddenVoxels);
  EXPECT_EQ(one.firstHidden, many.firstHidden);
}

/// One period along the side of a cube.
TEST(VoxelizeField, AGyroidTouchesAFewOfItsVoxels) {
  const auto gyroid = implicit::makeLattice(implicit::Lattice::Gyroid, 1, 0);
  const auto cube = implicit::makeBox({0, 0, 0}, Vec3(0.5), 0);
  const auto field = combine(Operation::Intersection, {gyroid, cube}, 0);
  constexpr int kSide = 128;
  VoxelizeReport report;
  const auto grid = voxelize(*field, voxelsOf(1.0 / kSide), &report);
  // Layers of samples beside a surface, of the gyroid and of the cube's sides: the share of the
  // lattice that is sampled is this by the side, under 4% of 2048^3.
  const double layers = static_cast<double>(report.samples) / (kSide * kSide);
  EXPECT_LT(layers, 80);
  EXPECT_GT(static_cast<double>(report.samples), static_cast<double>(report.activeVoxels) * 0.9);
  RecordProperty("samples", std::to_string(report.samples));
}

TEST(VoxelizeField, MakesDistancesOfWhatIsNone) {
  const auto torus = combine(Operation::Intersection,
                             {implicit::makeExpression("(x^2+y^2+z^2+0.84)^2 - 4*(x^2+y^2)"),
                              implicit::makeBox({0, 0, 0}, Vec3(2), 0)},
                             0);
  const auto truth = implicit::makeCircle({0, 0, 0}, {0, 0, 1}, 1, 0.4);
  const auto grid = voxelize(*torus, voxelsOf(0.04));
  double worst = 0;
  double sum = 0;
  std::size_t count = 0;
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d p = grid->indexToWorld(value.getCoord());
    const double off = std::abs(*value - truth->value({p.x(), p.y(), p.z()})) / 0.04;
    worst = std::max(worst, off);
    sum += off;
    ++count;
  }
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(sum / static_cast<double>(count), 0.01);
  const Mesh mesh = contour(*grid);
  EXPECT_LT(worstVertex(mesh, *truth) / 0.04, 0.12);
  const openvdb::Real volume = openvdb::tools::levelSetVolume(*grid);
  EXPECT_NEAR(volume / (2 * std::numbers::pi * std::numbers::pi * 0.16), 1, 0.01);
}

/// A field so steep that first-order distances are many voxels beside the surface.
TEST(VoxelizeField, SteepFieldsHaveNoHoles) {
  const auto field = combine(Operation::Intersection,
                             {implicit::makeExpression("exp(60*(x^2+y^2+z^2-1)) - 1"),
                              implicit::makeBox({0, 0, 0}, Vec3(2), 0)},
                             0);
  const auto grid = voxelize(*field, voxelsOf(0.1));
  ContourReport report;
  const Mesh mesh = contour(*grid, {}, &report);
  EXPECT_EQ(report.openEdges, 0u);
  EXPECT_GT(mesh.triangleCount(), 100u);
  EXPECT_LT(worstVertex(mesh, *implicit::makeSphere({0, 0, 0}, 1)), 0.02);
}

/// Inside or outside, and no slope that tells how far.
class Step : public Field {
 public:
  [[nodiscard]] double value(const Position& p) const override {
    return Vec3(p).length() < 1 ? -1 : 1;
  }
  [[nodiscard]] Position gradient(const Position&) const override { return {0, 0, 0}; }
  [[nodiscard]] implicit::Interval bound(const implicit::Box& box) const override {
    const auto distance = ball_->bound(box);
    return {distance.least < 0 ? -1.0 : 1.0, distance.greatest < 0 ? -1.0 : 1.0};
  }
  [[nodiscard]] double lipschitz(const implicit::Box&) const override {
    return std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] implicit::Box extent() const override { return ball_->extent(); }

 private:
  FieldPtr ball_ = implicit::makeSphere({0, 0, 0}, 1);
};

void expectUnitBall(const openvdb::FloatGrid& grid) {
  ContourReport report;
  const Mesh mesh = contour(grid, {}, &report);
  EXPECT_EQ(report.openEdges, 0u);
  EXPECT_GT(mesh.triangleCount(), 100u);
  EXPECT_LT(worstVertex(mesh, *implicit::makeSphere({0, 0, 0}, 1)), 0.1);
}

TEST(VoxelizeField, FieldsWithoutSlopesHaveNoHoles) {
  expectUnitBall(*voxelize(Step(), voxelsOf(0.1)));
}

class StepWithoutGradient final : public Step {
 public:
  [[nodiscard]] Position gradient(const Position&) const override {
    const double nan = std::nan("");
    return {nan, nan, nan};
  }
};

// The inside leaked out of the extent.
TEST(VoxelizeField, ValuesTellTheSideWhereGradientsAreNoNumbers) {
  expectUnitBall(*voxelize(StepWithoutGradient(), voxelsOf(0.1)));
}

/// That a solid cut by the half space where an expression is below 0 has no open edge, and that of
/// the points where there are samples those are inside that are below 0.
void expectClosed(const std::string& text) {
  const auto field =
      combine(Operation::Intersection,
              {implicit::makeExpression(text), implicit::makeBox({0.5, 0.25, 0}, Vec3(2.5), 0)}, 0);
  constexpr double kVoxel = 0.15625;
  const auto grid = voxelize(*field, voxelsOf(kVoxel));
  for (int x = -24; x <= 24; ++x) {
    for (int y = -24; y <= 24; ++y) {
      for (int z = -24; z <= 24; ++z) {
        const double truth = field->value({x * kVoxel, y * kVoxel, z * kVoxel});
        ASSERT_EQ(grid->tree().getValue(openvdb::Coord(x, y, z)) < 0, truth < 0)
            << text << " at " << x << " " << y << " " << z;
      }
    }
  }
  for (const bool uniform : {true, false}) {
    ContourOptions options;
    options.uniform = uniform;
    ContourReport report;
    const Mesh mesh = contour(*grid, options, &report);
    EXPECT_EQ(report.openEdges, 0u) << text;
    EXPECT_GT(mesh.triangleCount(), uniform ? 1000u : 11u) << text;
  }
}

// Bounds took tiles for inside in which points have no value, and crossings between values beyond
// the band were dropped with their blocks: the inside leaked out of the solid.
TEST(VoxelizeField, LevelSetsAreClosedWhereFieldsHaveNoValue) {
  expectClosed("sqrt(x) - 2");              // a root of what is below 0 is that of 0
  expectClosed("x^0.3 - 1");                // the same
  expectClosed("-(x*x)/x - 1");             // 0/0 in a plane
  expectClosed("atan((x*x)/x) - 2");        // the same, of numbers that are all below 0
  expectClosed("0*ln(x) - 1");              // 0 times infinity in half of space
  expectClosed("sin(1/(x*y*z)) - 2");       // the sine of infinity in three planes
  expectClosed("min(ln(x) - ln(x), 0)-1");  // infinity without itself
  expectClosed("exp(900*x) - exp(901*x)");  // the same, by overflow
  expectClosed("z - (x*x + y*y)/(x + y)");  // along a plane through voxels
}

/// Creases of max and min stay where they are: the box's edges, and the rims of a bore.
TEST(VoxelizeField, CreasesStayWithinATenthOfAVoxel) {
  const auto box = implicit::makeBox({0.013, 0.021, 0.007}, {1, 0.8, 0.6}, 0);
  const auto bore = implicit::makeCylinder({0.013, 0.021, -3}, {0.013, 0.021, 3}, 0.45);
  const auto field = combine(Operation::Intersection, {box, implicit::makeComplement(bore)}, 0);
  constexpr double kVoxel = 0.04;
  const auto grid = voxelize(*field, voxelsOf(kVoxel));
  // How far the mesh's edges are from points on the creases, in voxels.
  const auto worstOf = [&](const Mesh& mesh) {
    std::array<double, 2> worst{};
    for (int n = 0; n < 60; ++n) {
      const double angle = 2 * std::numbers::pi * n / 60;
      const Vec3 rim(0.013 + 0.45 * std::cos(angle), 0.021 + 0.45 * std::sin(angle), 0.607);
      worst[0] = std::max(worst[0], distanceToEdges(rim, mesh) / kVoxel);
      const Vec3 side(0.013 - 0.95 + 1.9 * n / 59, 0.821, 0.607);
      worst[1] = std::max(worst[1], distanceToEdges(side, mesh) / kVoxel);
    }
    return worst;
  };
  ContourOptions uniform;
  uniform.uniform = true;
  const Mesh finest = contour(*grid, uniform);
  const Mesh adaptive = contour(*grid);
  EXPECT_LT(worstVertex(finest, *field) / kVoxel, 0.05);
  const auto [rim, side] = worstOf(finest);
  EXPECT_LT(rim, 0.1);
  EXPECT_LT(side, 0.02);
  ContourOptions half;
  half.tolerance = 0.05;
  const auto [rimHalf, sideHalf] = worstOf(contour(*grid, half));
  EXPECT_LT(rimHalf, 0.1);
  EXPECT_LT(sideHalf, 0.1);
  // An adaptive mesh may be its tolerance away from the uniform one: by default, 0.1.
  const auto [rimAdaptive, sideAdaptive] = worstOf(adaptive);
  EXPECT_LT(rimAdaptive, 0.15);
  EXPECT_LT(sideAdaptive, 0.12);
}

/// Balls of a fifth of a voxel in the middle of cells, sheets of a tenth between samples.
TEST(VoxelizeField, PartsBetweenSamplesAreNamed) {
  constexpr double kVoxel = 0.1;
  const auto ball = implicit::makeSphere({0, 0, 0}, 0.55);
  const auto speck = implicit::makeSphere({1.55, 0.05, 0.05}, 0.02);
  VoxelizeReport report;
  auto grid = voxelize(*combine(Operation::Union, {ball, speck}, 0), voxelsOf(kVoxel), &report);
  EXPECT_GE(report.hiddenVoxels, 1u);
  EXPECT_LE(report.hiddenVoxels, 8u);
  EXPECT_LT((Vec3(report.firstHidden) - Vec3(1.55, 0.05, 0.05)).length(), kVoxel);

  const auto sheet = implicit::makeBox({0, 0, 0.05}, {0.73, 0.73, 0.005}, 0);
  grid = voxelize(*sheet, voxelsOf(kVoxel), &report);
  EXPECT_GT(report.hiddenVoxels, 2 * 14u * 14u - 1);
  EXPECT_LT(report.hiddenVoxels, 2 * 18u * 18u);

  // The same inside a solid: a bubble.
  const auto bubble =
      combine(Operation::Intersection,
              {ball, implicit::makeComplement(implicit::makeSphere({0.05, 0.05, 0.05}, 0.03))}, 0);
  grid = voxelize(*bubble, voxelsOf(kVoxel), &report);
  EXPECT_GE(report.hiddenVoxels, 1u);

  // A field that changes nowhere but in the speck: no sample is near the band.
  const auto steep =
      combine(Operation::Intersection,
              {implicit::makeExpression("1 - 3*exp(-9000*((x-0.05)^2 + (y-0.05)^2 + (z-0.05)^2))"),
               implicit::makeBox({0, 0, 0}, Vec3(1), 0)},
              0);
  grid = voxelize(*steep, voxelsOf(kVoxel), &report);
  EXPECT_GE(report.hiddenVoxels, 1u);

  // Nothing is said of what the samples show.
  static_cast<void>(voxelize(*ball, voxelsOf(kVoxel), &report));
  EXPECT_EQ(report.hiddenVoxels + report.undecidedVoxels, 0u);
}

/// Counts how often it is asked, and tells nothing.
class Boundless final : public Field {
 public:
  [[nodiscard]] double value(const Position& /*p*/) const override { return 1; }
  [[nodiscard]] Position gradient(const Position& /*p*/) const override { return {0, 0, 0}; }
  [[nodiscard]] implicit::Interval bound(const implicit::Box& /*box*/) const override {
    ++asked;
    return implicit::everything();
  }
  [[nodiscard]] double lipschitz(const implicit::Box& /*box*/) const override {
    return implicit::kInfinity;
  }
  [[nodiscard]] implicit::Box extent() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  mutable std::atomic<std::size_t> asked{0};
};

TEST(VoxelizeField, FieldsWithoutBoundsEndSoon) {
  const Boundless field;
  VoxelizeReport report;
  const auto grid = voxelize(field, voxelsOf(0.05), &report);
  EXPECT_EQ(grid->activeVoxelCount(), 0u);
  EXPECT_EQ(report.hiddenVoxels, 0u);
  EXPECT_GT(report.undecidedVoxels, 40u * 40 * 40);
  EXPECT_LT(field.asked, 110000 * report.blocks);
}

TEST(VoxelizeField, RefusesWhatItCannotDo) {
  const auto plane = implicit::makePlane({0, 0, 0}, {0, 0, 1});
  const auto sphere = implicit::makeSphere({0, 0, 0}, 1);
  const auto refused = [](const Field& field, const VoxelizeOptions& options, ErrorCode code,
                          const std::string& part) {
    expectError(code, part, [&] { static_cast<void>(voxelize(field, options)); });
  };
  refused(*plane, voxelsOf(0.1), ErrorCode::InvalidArgument, "bounds");
  refused(*sphere, voxelsOf(0), ErrorCode::InvalidArgument, "voxel size");
  refused(*sphere, voxelsOf(1e-9), ErrorCode::InvalidArgument, "voxel size");
  VoxelizeOptions small = voxelsOf(0.01);
  small.bandVoxels = 100000;
  refused(*sphere, small, ErrorCode::LimitExceeded, "VoxelizeOptions::bandVoxels");
  refused(*sphere, voxelsOf(2e-5), ErrorCode::LimitExceeded, "VoxelizeOptions::bandVoxels");
  VoxelizeOptions stopped = voxelsOf(0.01);
  stopped.progress = [](std::string_view, double) { return false; };
  refused(*sphere, stopped, ErrorCode::Cancelled, "cancelled");
}

TEST(VoxelizeField, MakesFogVolumes) {
  const auto field = implicit::makeSphere({0, 0, 0}, 1);
  VoxelizeOptions options = voxelsOf(0.1);
  options.fog = true;
  VoxelizeReport report;
  const auto grid = voxelize(*field, options, &report);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(report.activeVoxels, grid->activeVoxelCount());
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(0)), 1);
  EXPECT_TRUE(grid->tree().isValueOn(openvdb::Coord(0)));
  EXPECT_NEAR(grid->tree().getValue(openvdb::Coord(0, 0, 9)), 1.0 / 3, 1e-5);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(0, 0, 11)), 0);
}

/// A scene of a million objects must stop where it is asked to, within a cube of 64^3 voxels too.
TEST(VoxelizeField, StopsWithinACube) {
  const auto field = implicit::makeSphere({0, 0, 0}, 1);
  VoxelizeOptions options = voxelsOf(0.04);
  options.threads = 1;
  int calls = 0;
  options.progress = [&](std::string_view, double) { return ++calls < 20; };
  expectError(ErrorCode::Cancelled, "cancelled",
              [&] { static_cast<void>(voxelize(*field, options)); });
  EXPECT_EQ(calls, 20);
}

TEST(VoxelizeField, ManyPartsCostWhatIsNearThem) {
  std::vector<FieldPtr> balls;
  for (int n = 0; n < 4000; ++n) {
    balls.push_back(
        implicit::makeSphere({0.2 * (n % 16), 0.2 * (n / 16 % 16), 0.2 * (n / 256)}, 0.07));
  }
  VoxelizeReport report;
  const auto grid =
      voxelize(*combine(Operation::Union, std::move(balls), 0), voxelsOf(0.05), &report);
  EXPECT_GT(report.activeVoxels, 100000u);
}

}  // namespace
}  // namespace tufa
