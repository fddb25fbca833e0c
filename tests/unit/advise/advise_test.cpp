// What adviseSampling() says of shapes whose features are known.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/advise.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "support/expect_error.h"
#include "support/fields.h"

namespace tufa {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;
using openvdb::Vec3d;

// The distance to a box of these half sizes.
double boxDistance(const Vec3d& p, const Vec3d& half) {
  Vec3d out;
  double in = -1e9;
  for (int i = 0; i < 3; ++i) {
    const double d = std::abs(p[i]) - half[i];
    out[i] = std::max(d, 0.0);
    in = std::max(in, d);
  }
  return out.length() + std::min(in, 0.0);
}

// A box turned about two axes.
FloatGrid::Ptr turnedBox(const Vec3d& half, double voxelSize = 1) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  const int reach = static_cast<int>(half.length()) + 5;
  return test::levelSet<FloatGrid>(
      CoordBBox(openvdb::Coord(-reach), openvdb::Coord(reach)), 3,
      [&](const openvdb::Coord& at) {
        const Vec3d p = at.asVec3d() + Vec3d(0.3, 0.1, -0.2);
        const Vec3d q(c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]);
        return boxDistance({q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]}, half);
      },
      voxelSize);
}

SamplingReport advised(const FloatGrid& grid, double spared = 0.01) {
  AdviseOptions options;
  options.spared = spared;
  return adviseSampling(grid, options);
}

TEST(Advise, FindsTheThicknessOfASlab) {
  for (const double thickness : {1.6, 3.0, 5.0, 7.4}) {
    const SamplingReport report = advised(*turnedBox({20, 20, thickness / 2}));
    EXPECT_NEAR(report.middleVoxels, thickness, 0.1) << thickness;
    EXPECT_EQ(report.thinSheets > report.surfaceCells / 2, thickness < 2) << thickness;
    EXPECT_EQ(report.thinSmooth > report.surfaceCells / 2, thickness < 4) << thickness;
    EXPECT_GT(report.sharpCells, 100u);  // its rim
    EXPECT_GT(report.thinSharp, report.sharpCells * 9 / 10) << thickness;
    EXPECT_FALSE(report.enough());
    // Eight voxels are due at its rim.
    EXPECT_NEAR(report.voxelSizeNeeded, thickness / 8, 0.05 * thickness) << thickness;
    EXPECT_NEAR(report.highestFrequency, std::numbers::pi / thickness, 0.2 / thickness);
  }
}

TEST(Advise, FindsAGapAsWellAsASheet) {
  // The same slab, inside out.
  const FloatGrid::Ptr grid = turnedBox({20, 20, 2.5});
  AdviseOptions options;
  options.contour.inside = Inside::Above;
  const SamplingReport report = adviseSampling(*grid, options);
  EXPECT_FALSE(report.insideIsBelow);
  EXPECT_NEAR(report.middleVoxels, 5, 0.1);
}

TEST(Advise, IsContentWithALargeBox) {
  const SamplingReport report = advised(*turnedBox({12, 10, 9}, 0.5));
  EXPECT_TRUE(report.distanceField);
  EXPECT_NEAR(report.voxelSize, 0.5, 1e-6);
  EXPECT_GT(report.sharpCells, 100u);
  // A sample that an edge leaves just inside of a face may be taken for a thin part.
  EXPECT_LE(report.thinSmooth + report.thinSharp, 2u);
  EXPECT_LE(report.thinSheets, 2u);
  EXPECT_EQ(report.hiddenSheets, 0u);
  EXPECT_EQ(report.unresolvedKinks, 0u);
  EXPECT_EQ(report.voxelSizeNeeded, report.voxelSize);
  EXPECT_NEAR(report.nyquist, std::numbers::pi / 0.5, 1e-4);
  EXPECT_TRUE(report.enough());
}

TEST(Advise, AsksMoreOfSharpEdgesThanOfSmoothSurfaces) {
  // Six voxels: enough for its faces, not for its edges.
  const SamplingReport report = advised(*turnedBox({12, 12, 3}));
  EXPECT_LT(report.thinSmooth, report.surfaceCells / 200);
  EXPECT_GT(report.thinSharp, 100u);
  EXPECT_NEAR(report.voxelSizeNeeded, 6.0 / 8, 0.1);
}

TEST(Advise, FindsTheThicknessOfAGyroid) {
  for (const double thickness : {3.0, 5.0}) {
    // A shell around g = 0 of period 48, of that thickness to first order. It is cut by a ball,
    // which leaves thin wedges at its rim.
    const double wave = 2 * std::numbers::pi / 48;
    const auto grid = test::levelSet<FloatGrid>(
        CoordBBox(openvdb::Coord(-34), openvdb::Coord(34)), 3, [&](const openvdb::Coord& at) {
          const Vec3d p = at.asVec3d() * wave;
          const Vec3d s(std::sin(p[0]), std::sin(p[1]), std::sin(p[2]));
          const Vec3d c(std::cos(p[0]), std::cos(p[1]), std::cos(p[2]));
          const double g = s[0] * c[1] + s[1] * c[2] + s[2] * c[0];
          const Vec3d gradient(c[0] * c[1] - s[2] * s[0], c[1] * c[2] - s[0] * s[1],
                               c[2] * c[0] - s[1] * s[2]);
          const double shell =
              std::abs(g) / (wave * std::max(gradient.length(), 0.3)) - thickness / 2;
          return std::max(shell, at.asVec3d().length() - 30);
        });
    const SamplingReport report = advised(*grid);
    EXPECT_NEAR(report.middleVoxels, thickness, 0.06 * thickness);
    EXPECT_EQ(report.thinSmooth > report.surfaceCells / 2, thickness < 4) << thickness;
    EXPECT_LT(report.thinSheets, report.surfaceCells / 10) << thickness;
  }
}

TEST(Advise, FindsSheetsThatSignsDoNotShow) {
  // Half a voxel thick, between two layers of samples.
  const auto grid = test::levelSet<FloatGrid>(
      CoordBBox(openvdb::Coord(-12), openvdb::Coord(12)), 3,
      [](const openvdb::Coord& at) { return std::abs(at.z() - 0.5) - 0.25; });
  // A ball beside it, so that there is a surface at all.
  auto accessor = grid->getAccessor();
  for (auto at = CoordBBox(openvdb::Coord(-12, -12, 14), openvdb::Coord(12, 12, 30)).begin(); at;
       ++at) {
    const double d = (*at - openvdb::Coord(0, 0, 22)).asVec3d().length() - 5;
    if (std::abs(d) < 3) accessor.setValue(*at, static_cast<float>(d));
    if (d <= -3) accessor.setValueOff(*at, -3);
  }
  const SamplingReport report = advised(*grid);
  EXPECT_GE(report.hiddenSheets, 500u);  // of 625 edges; those at the rim see no opposite
  EXPECT_FALSE(report.enough());
}

TEST(Advise, FindsKinksThatShareACell) {
  // A bar of one voxel and a half: both its edges are in one cell.
  const SamplingReport report = advised(*turnedBox({20, 0.75, 0.75}));
  EXPECT_GT(report.unresolvedKinks, 0u);
}

TEST(Advise, IsTheSameForAnyNumberOfThreads) {
  const FloatGrid::Ptr grid = turnedBox({14, 9, 2});
  const auto withThreads = [&](int threads) {
    AdviseOptions options;
    options.contour.threads = threads;
    return adviseSampling(*grid, options);
  };
  const SamplingReport one = withThreads(1);
  EXPECT_GT(one.thinSharp, 0u);
  for (const int threads : {2, 7}) EXPECT_EQ(withThreads(threads), one) << threads;
}

TEST(Advise, TakesAGridWithoutSurface) {
  const SamplingReport report = advised(*FloatGrid::create(1));
  EXPECT_EQ(report.surfaceCells, 0u);
  EXPECT_TRUE(report.enough());
}

TEST(Advise, RefusesWhatMeansNothingAndCancels) {
  const FloatGrid::Ptr grid = turnedBox({5, 5, 5});
  const auto fails = [&](ErrorCode code, const std::string& part, const auto& change) {
    AdviseOptions options;
    change(options);
    test::expectError(code, part, [&] { (void)adviseSampling(*grid, options); });
  };
  const ErrorCode invalid = ErrorCode::InvalidArgument;
  fails(invalid, "voxels", [](AdviseOptions& o) { o.sharpVoxels = 0; });
  fails(invalid, "voxels", [](AdviseOptions& o) { o.smoothVoxels = 1e9; });
  fails(invalid, "angle", [](AdviseOptions& o) { o.sharpAngle = 181; });
  fails(invalid, "share", [](AdviseOptions& o) { o.spared = 2; });
  fails(ErrorCode::Cancelled, "cancel", [](AdviseOptions& o) {
    o.contour.progress = [](std::string_view /*stage*/, double) { return false; };
  });
}

}  // namespace
}  // namespace tufa
