// Filters of grids before they are meshed.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Prune.h>
#include <tufa/filter.h>

#include <tufa/contour.h>
#include <tufa/extract.h>
#include <tufa/labels.h>
#include <tufa/unite.h>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "grid/progress_interrupter.h"
#include "support/expect_error.h"

namespace tufa {
namespace {

using openvdb::DoubleGrid;
using openvdb::FloatGrid;
using test::expectError;

constexpr double kVoxel = 0.1;

template <class GridT = FloatGrid>
typename GridT::Ptr makeSphere(float radius, const openvdb::Vec3f& centre = {0, 0, 0}) {
  return openvdb::tools::createLevelSetSphere<GridT>(radius, centre, static_cast<float>(kVoxel));
}

/// Two large spheres, and small ones around them.
FloatGrid::Ptr makeDust() {
  auto grid = makeSphere(1);
  openvdb::tools::csgUnion(*grid, *makeSphere(0.8F, {4, 0, 0}));
  for (const float x : {-2.0F, 2.0F, 6.0F}) {
    openvdb::tools::csgUnion(*grid, *makeSphere(0.2F, {x, 2, 0}));
  }
  return grid;
}

double volumeOf(const Mesh& mesh) {
  double sixfold = 0;
  for (const Triangle& t : triangulate(mesh)) {
    const auto& [a, b, c] = std::tie(mesh.positions[t.vertices[0]], mesh.positions[t.vertices[1]],
                                     mesh.positions[t.vertices[2]]);
    sixfold += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
               a.z * (b.x * c.y - b.y * c.x);
  }
  return sixfold / 6;
}

double volumeOf(const openvdb::GridBase& grid, ContourOptions options = {}) {
  options.uniform = true;
  return volumeOf(contour(grid, options));
}

double ball(double radius) { return 4 * std::numbers::pi / 3 * std::pow(radius, 3); }

/// The grid after one filter.
openvdb::GridBase::Ptr after(const openvdb::GridBase& grid, const Filter& filter,
                             const FilterOptions& options = {}) {
  return applyFilters(grid, {filter}, options);
}

template <class GridT>
class FilterTypes : public ::testing::Test {};
using Types = ::testing::Types<FloatGrid, DoubleGrid>;
TYPED_TEST_SUITE(FilterTypes, Types);

TYPED_TEST(FilterTypes, OffsetMovesTheSurfaceOutward) {
  const auto grid = makeSphere<TypeParam>(1);
  const double tolerance = 0.02 * ball(1);
  EXPECT_NEAR(volumeOf(*after(*grid, Offset{0.25})), ball(1.25), tolerance);
  EXPECT_NEAR(volumeOf(*after(*grid, Offset{-0.45})), ball(0.55), tolerance);
  EXPECT_NEAR(volumeOf(*grid), ball(1), tolerance);  // stays as it is
  EXPECT_NEAR(volumeOf(*after(*grid, Open{0.3})), ball(1), tolerance);
  EXPECT_NEAR(volumeOf(*after(*grid, Resample{0.05})), ball(1), tolerance);
  EXPECT_NEAR(volumeOf(*after(*grid, Smooth{Smoothing::Mean, 2})), ball(1), 3 * tolerance);
}

TEST(Filters, OpeningTakesAwayWhatIsThinAndClosingFillsGaps) {
  const auto dust = makeDust();
  const auto opened = after(*dust, Open{0.3});
  EXPECT_NEAR(volumeOf(*opened), ball(1) + ball(0.8), 0.1);
  // Two spheres with a gap of 0.2 between them.
  auto pair = makeSphere(1);
  openvdb::tools::csgUnion(*pair, *makeSphere(1, {2.2F, 0, 0}));
  EXPECT_FALSE(pair->tree().getValue({11, 0, 0}) < 0);
  const auto closed = openvdb::gridPtrCast<FloatGrid>(after(*pair, Close{0.4}));
  EXPECT_LT(closed->tree().getValue({11, 0, 0}), 0);
}

TEST(Filters, SmoothingByCurvatureShrinksASphere) {
  const auto grid = makeSphere(1);
  double before = ball(1);
  for (const int iterations : {5, 20}) {
    const double volume = volumeOf(*after(*grid, Smooth{Smoothing::Curvature, iterations}));
    EXPECT_LT(volume, before);
    before = volume;
  }
  for (const Smoothing smoothing : {Smoothing::Gaussian, Smoothing::Mean, Smoothing::Median}) {
    EXPECT_NEAR(volumeOf(*after(*grid, Smooth{smoothing, 1})), ball(1), 0.1 * ball(1));
  }
}

TEST(Filters, FogIsSmoothedAndSampledAnew) {
  auto fog = makeSphere(1);
  openvdb::tools::sdfToFogVolume(*fog);
  ContourOptions options;
  options.isovalue = 0.5;
  const double volume = volumeOf(*fog, options);
  for (const Smoothing smoothing : {Smoothing::Gaussian, Smoothing::Mean, Smoothing::Median}) {
    const auto smooth = after(*fog, Smooth{smoothing, 1});
    EXPECT_EQ(smooth->getGridClass(), openvdb::GRID_FOG_VOLUME);
    EXPECT_NEAR(volumeOf(*smooth, options), volume, 0.2 * volume);
  }
  const auto finer = after(*fog, Resample{0.05});
  EXPECT_NEAR(finer->voxelSize()[0], 0.05, 1e-12);
  EXPECT_NEAR(volumeOf(*finer, options), volume, 0.02 * volume);
  expectError(ErrorCode::UnsupportedGrid, "level set", [&] {
    static_cast<void>(after(*fog, Smooth{Smoothing::Curvature, 1}));
  });
  expectError(ErrorCode::UnsupportedGrid, "level set",
              [&] { static_cast<void>(after(*fog, Offset{0.1})); });
}

// OpenVDB's own signs come from a flood from outside: cavities were filled.
TEST(Filters, ResamplingKeepsCavities) {
  auto hollow = makeSphere(1);
  openvdb::tools::csgDifference(*hollow, *makeSphere(0.5));
  for (const double voxel : {0.06, 0.15}) {
    EXPECT_NEAR(volumeOf(*after(*hollow, Resample{voxel})), ball(1) - ball(0.5), 0.03 * ball(1));
  }
  auto block = makeSphere(2.6F);  // whose cavity is larger than a leaf
  openvdb::tools::csgDifference(*block, *makeSphere(2));
  const auto finer = openvdb::gridPtrCast<FloatGrid>(after(*block, Resample{0.05}));
  EXPECT_GT(finer->tree().getValue({0, 0, 0}), 0);
  EXPECT_LT(finer->tree().getValue({46, 0, 0}), 0);
  EXPECT_GT(finer->tree().getValue({60, 0, 0}), 0);
}

// The determinant of a mirrored transform is below 0.
TEST(Filters, MirroredGridsAreLikeOthers) {
  const auto grid = makeSphere(1, {0.3F, 0, 0});
  const auto mirrored = grid->deepCopy();
  mirrored->transform().postMult(
      openvdb::Mat4d(openvdb::Vec4d(-1, 0, 0, 0), {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, true));
  for (const Filter& filter : {Filter(Offset{0.25}), Filter(Resample{0.06})}) {
    EXPECT_NEAR(std::abs(volumeOf(*after(*mirrored, filter))), volumeOf(*after(*grid, filter)),
                0.01 * ball(1));
  }
}

// And there was no inside left of what a box had cut off.
TEST(Filters, ResamplingKeepsOpenSurfaces) {
  const auto grid = makeSphere(1);
  const auto half = after(*grid, ClipBox{{-2, -2, -2}, {2, 2, 0.01}});
  ContourOptions options;
  options.cap = true;
  for (const double voxel : {0.06, 0.15}) {
    const auto sampled = after(*half, Resample{voxel});
    EXPECT_GT(contour(*sampled).triangleCount(), 100U);
    EXPECT_NEAR(volumeOf(*sampled, options), ball(1) / 2, 0.06 * ball(1)) << voxel;
  }
}

TEST(Filters, ResamplingKeepsThePlaceFarFromTheOrigin) {
  const openvdb::Vec3d far(3e5, -2e5, 1e5);
  const auto grid = makeSphere(1);
  grid->transform().postTranslate(far);
  const auto finer = after(*grid, Resample{0.05});
  EXPECT_EQ(finer->getGridClass(), openvdb::GRID_LEVEL_SET);
  for (const Position& p : contour(*finer).positions) {
    const double distance = (openvdb::Vec3d(p.x, p.y, p.z) - far).length();
    ASSERT_NEAR(distance, 1, 0.02);
  }
}

// The way to say a half space. Voxels were made of all of it.
TEST(Filters, ABoxMayBeAsLargeAsItLikes) {
  const auto grid = makeSphere(1);
  const auto whole = after(*grid, ClipBox{{-2, -2, -2}, {2, 2, 2}});
  const auto lower = after(*grid, ClipBox{{-2, -2, -2}, {2, 2, 0}});
  for (const double far : {1e3, 1e9, 1e20}) {
    const auto all = after(*grid, ClipBox{{-far, -far, -far}, {far, far, far}});
    EXPECT_EQ(all->activeVoxelCount(), whole->activeVoxelCount()) << far;
    EXPECT_EQ(all->activeVoxelCount(), grid->activeVoxelCount()) << far;
    const auto below = after(*grid, ClipBox{{-far, -far, -far}, {far, far, 0}});
    EXPECT_EQ(below->activeVoxelCount(), lower->activeVoxelCount()) << far;
    EXPECT_EQ(after(*grid, ClipBox{{far / 2, 0, 0}, {far, 1, 1}})->activeVoxelCount(), 0u) << far;
  }
}

TEST(Filters, ABoxCutsALevelSetOpenUnlessItIsCapped) {
  const auto grid = makeSphere(1);
  const auto half = after(*grid, ClipBox{{-2, -2, -2}, {2, 2, 0}});
  EXPECT_EQ(half->getGridClass(), openvdb::GRID_LEVEL_SET);
  ContourReport report;
  const Mesh open = contour(*half, {}, &report);
  EXPECT_GT(report.openEdges, 0u);
  for (const Position& p : open.positions) {
    EXPECT_LT(p.z, 2 * kVoxel);
    // All of it is the sphere, nothing the cut.
    EXPECT_NEAR(std::hypot(p.x, p.y, p.z), 1, 0.2 * kVoxel);
  }
  ContourOptions capped;
  capped.cap = true;
  const double volume = volumeOf(*half, capped);
  EXPECT_NEAR(volume, 0.5 * ball(1), kVoxel * std::numbers::pi);
}

TEST(Filters, GridsClipByTheirVoxelsAndMaskByTheirInside) {
  const auto grid = makeSphere(1);
  // The band of a small sphere passes through the large one at one side.
  const auto other = openvdb::tools::createLevelSetSphere<FloatGrid>(0.5F, {1, 0, 0}, 0.07F);
  const auto inBand = contour(*after(*grid, ClipGrid{other}));
  const auto inside = contour(*after(*grid, Mask{other}));
  ASSERT_FALSE(inside.positions.empty());
  ASSERT_FALSE(inBand.positions.empty());
  double nearest = 1;
  for (const Position& p : inside.positions) {
    const double distance = std::hypot(p.x - 1, p.y, p.z);
    EXPECT_LT(distance, 0.5 + 2 * kVoxel);
    nearest = std::min(nearest, distance);
  }
  EXPECT_LT(nearest, 2 * kVoxel);
  for (const Position& p : inBand.positions) {
    EXPECT_NEAR(std::hypot(p.x - 1, p.y, p.z), 0.5, 3 * 0.07 + 2 * kVoxel);
  }
  expectError(ErrorCode::InvalidArgument, "no grid",
              [&] { static_cast<void>(after(*grid, Mask{})); });
}

/// How many of some voxels of `clipped` are not what a look at the mask's voxel nearest to each
/// says.
std::size_t wronglyClipped(const FloatGrid& whole, const openvdb::GridBase& clipped,
                           const openvdb::MaskGrid& mask) {
  const auto& result = static_cast<const FloatGrid&>(clipped);
  const auto before = whole.getConstAccessor(), after = result.getConstAccessor();
  const bool isLevelSet = whole.getGridClass() == openvdb::GRID_LEVEL_SET;
  std::size_t wrong = 0;
  openvdb::CoordBBox box = whole.evalActiveVoxelBoundingBox();
  box.expand(3);
  for (openvdb::Coord at = box.min(); at.x() <= box.max().x(); at.x() += 5) {
    for (at.y() = box.min().y(); at.y() <= box.max().y(); at.y() += 5) {
      for (at.z() = box.min().z(); at.z() <= box.max().z(); ++at.z()) {
        const float value = before.getValue(at);
        const bool active = before.isValueOn(at);
        const openvdb::Vec3d place = mask.worldToIndex(whole.indexToWorld(at));
        const bool stays = (active || (isLevelSet && value < 0)) &&
                           mask.tree().isValueOn(openvdb::Coord::round(place));
        wrong += after.getValue(at) != (stays ? value : whole.background()) ||
                 after.isValueOn(at) != (stays && active);
      }
    }
  }
  return wrong;
}

/// A ball of 300 voxels across, whose inside is tiles of several sizes: a level set, and fog.
std::array<FloatGrid::Ptr, 2> ballsOfTiles() {
  const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(150, {0, 0, 0}, 1);
  const auto fog = ball->deepCopy();
  openvdb::tools::sdfToFogVolume(*fog);
  openvdb::tools::prune(fog->tree());
  return {ball, fog};
}

// A coarse mask was sampled for each voxel of the fine grid that it could have held: that took
// minutes and could not be cancelled. And nodes with tiles alone were lost, or became whole.
TEST(Filters, MasksOfAnyLatticeKeepTheVoxelsNearestToTheirs) {
  const auto mask = openvdb::MaskGrid::create(false);
  mask->tree().fill({openvdb::Coord(0), openvdb::Coord(1, 0, 1)}, true);
  mask->tree().fill({openvdb::Coord(-9), openvdb::Coord(-3)}, true);
  std::vector<openvdb::math::Transform::Ptr> lattices;
  for (const double voxel : {1.0, 0.11, 16.0, 60.0, 1e5}) {
    lattices.push_back(openvdb::math::Transform::createLinearTransform(voxel));
  }
  lattices.push_back(openvdb::math::Transform::createLinearTransform(20));
  lattices.back()->preRotate(0.3, openvdb::math::Z_AXIS);
  lattices.back()->postTranslate({3.1, -50.2, 7.7});
  for (const FloatGrid::Ptr& grid : ballsOfTiles()) {
    for (const auto& lattice : lattices) {
      mask->setTransform(lattice);
      EXPECT_EQ(wronglyClipped(*grid, *after(*grid, ClipGrid{mask}), *mask), 0U)
          << grid->getGridClass() << " by a mask of " << *lattice;
    }
  }
}

// Of fog the tiles were lost, and of a box between two distant voxels a whole wall was made.
TEST(Filters, BoxesKeepTilesWhole) {
  const auto mask = openvdb::MaskGrid::create(false);
  for (const FloatGrid::Ptr& grid : ballsOfTiles()) {
    for (const openvdb::Coord& greatest :
         {openvdb::Coord(15, 63, 127), openvdb::Coord(20, 9, 40)}) {
      mask->clear();
      mask->tree().sparseFill({openvdb::Coord(-64, -16, -128), greatest}, true);
      const auto clipped = after(
          *grid, ClipBox{{-64, -16, -128},
                         Position(greatest.x() + 0.5, greatest.y() + 0.5, greatest.z() + 0.5)});
      EXPECT_EQ(wronglyClipped(*grid, *clipped, *mask), 0U) << greatest;
    }
  }
  const auto dust = FloatGrid::create(0);
  dust->tree().setValueOn({0, 0, 0}, 1);
  dust->tree().setValueOn(openvdb::Coord(1 << 24), 2);
  const double far = 1 << 23;
  EXPECT_EQ(after(*dust, ClipBox{{-1, -1, -1}, {far, 2 * far, 2 * far}})->activeVoxelCount(), 1U);
}

TEST(Filters, KeepLargestComponents) {
  const auto dust = makeDust();
  std::vector<FilterReport> reports;
  const auto two = applyFilters(*dust, {KeepLargest{2}}, {}, &reports);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].filter, "keep-largest");
  EXPECT_EQ(reports[0].components, 5u);
  EXPECT_EQ(reports[0].componentsKept, 2u);
  EXPECT_LT(reports[0].voxelsAfter, reports[0].voxelsBefore);
  EXPECT_NEAR(volumeOf(*two), ball(1) + ball(0.8), 0.1);
  const auto one = after(*dust, KeepLargest{1});
  EXPECT_NEAR(volumeOf(*one), ball(1), 0.06);
  EXPECT_EQ(volumeOf(*after(*dust, KeepLargest{9})), volumeOf(*dust));
  // A ball of 0.2 has some 33 voxels.
  EXPECT_NEAR(volumeOf(*after(*dust, MinComponent{100})), ball(1) + ball(0.8), 0.1);
  EXPECT_EQ(volumeOf(*after(*dust, MinComponent{10})), volumeOf(*dust));
  EXPECT_TRUE(contour(*after(*dust, MinComponent{100000})).positions.empty());
}

TEST(Filters, ACavityBelongsToTheSolidAroundIt) {
  auto shell = makeSphere(1);
  openvdb::tools::csgDifference(*shell, *makeSphere(0.5F));
  std::vector<FilterReport> reports;
  const auto kept = applyFilters(*shell, {KeepLargest{1}}, {}, &reports);
  EXPECT_EQ(reports[0].components, 1u);
  EXPECT_NEAR(volumeOf(*kept), ball(1) - ball(0.5), 0.1);
}

TEST(Filters, ComponentsOfFogAreThoseOfItsIsovalue) {
  // Two tops, 0.9 and 0.6, on one plateau of 0.2.
  auto fog = FloatGrid::create(0);
  fog->fill({{0, 0, 0}, {40, 10, 10}}, 0.2F);
  fog->fill({{2, 2, 2}, {12, 8, 8}}, 0.9F);
  fog->fill({{20, 2, 2}, {38, 8, 8}}, 0.6F);
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  const auto found = [&](double isovalue) {
    FilterOptions options;
    options.isovalue = isovalue;
    std::vector<FilterReport> reports;
    const auto kept = applyFilters(*fog, {KeepLargest{1}}, options, &reports);
    EXPECT_EQ(kept->activeVoxelCount(), fog->activeVoxelCount());
    return reports[0].components;
  };
  EXPECT_EQ(found(0.1), 1u);
  EXPECT_EQ(found(0.5), 2u);
  EXPECT_EQ(found(0.7), 1u);
}

TEST(Filters, ComponentsMeetAcrossTilesAndLeaves) {
  // A bar of large tiles with voxels at both ends, one of which does not touch it.
  auto fog = FloatGrid::create(0);
  fog->tree().addTile(1, {0, 0, 0}, 1, true);
  fog->tree().addTile(2, {128, 0, 0}, 1, true);
  fog->tree().addTile(1, {8, 0, 0}, 1, true);
  fog->fill({{256, 60, 60}, {259, 60, 60}}, 1);  // touches the second tile
  fog->fill({{16, 3, 3}, {125, 3, 3}}, 1);       // a thread between, with a gap to the large one
  std::vector<FilterReport> reports;
  FilterOptions options;
  options.isovalue = 0.5;
  static_cast<void>(applyFilters(*fog, {KeepLargest{1}}, options, &reports));
  EXPECT_EQ(reports[0].components, 2u);
  fog->fill({{126, 3, 3}, {127, 3, 3}}, 1);
  static_cast<void>(applyFilters(*fog, {KeepLargest{1}}, options, &reports));
  EXPECT_EQ(reports[0].components, 1u);
}

TEST(Filters, WorkInTheirOrder) {
  const auto dust = makeDust();
  std::vector<FilterReport> reports;
  const auto result = applyFilters(
      *dust, {MinComponent{100}, Offset{0.1}, ClipBox{{-2, -2, -2}, {2, 2, 2}}}, {}, &reports);
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(reports[0].filter, "min-component");
  EXPECT_EQ(reports[1].filter, "offset");
  EXPECT_EQ(reports[2].filter, "clip");
  EXPECT_EQ(reports[1].voxelsBefore, reports[0].voxelsAfter);
  EXPECT_NEAR(volumeOf(*result), ball(1.1), 0.06);
}

TEST(Filters, TheNumberOfThreadsDoesNotMatter) {
  const auto dust = makeDust();
  const std::vector<Filter> filters = {Smooth{}, Open{0.1}, Resample{0.07}, KeepLargest{2}};
  FilterOptions one;
  one.threads = 1;
  const Mesh a = contour(*applyFilters(*dust, filters, one));
  const Mesh b = contour(*applyFilters(*dust, filters));
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Filters, RefuseWhatHasNoMeaning) {
  const auto grid = makeSphere(1);
  const auto refused = [&](const Filter& filter, ErrorCode code, const std::string& part) {
    expectError(code, part, [&] { static_cast<void>(after(*grid, filter)); });
  };
  const double nan = std::nan("");
  refused(Smooth{Smoothing::Mean, 0}, ErrorCode::InvalidArgument, "iterations");
  refused(Offset{1e6}, ErrorCode::InvalidArgument, "voxels");
  refused(Offset{nan}, ErrorCode::InvalidArgument, "offset");
  refused(Open{0}, ErrorCode::InvalidArgument, "above 0");
  refused(Close{-1}, ErrorCode::InvalidArgument, "above 0");
  refused(Resample{0}, ErrorCode::InvalidArgument, "voxel size");
  refused(Resample{1e-4}, ErrorCode::LimitExceeded, "more than");
  refused(ClipBox{{0, 0, 0}, {1, 0, 1}}, ErrorCode::InvalidArgument, "corner");
  refused(ClipBox{{0, 0, 0}, {1, nan, 1}}, ErrorCode::InvalidArgument, "corner");
  refused(KeepLargest{0}, ErrorCode::InvalidArgument, "component");
  FilterOptions above;
  above.inside = Inside::Above;
  expectError(ErrorCode::UnsupportedGrid, "background",
              [&] { static_cast<void>(after(*grid, KeepLargest{1}, above)); });
  grid->transform().preScale(openvdb::Vec3d(1, 2, 1));
  refused(Offset{0.1}, ErrorCode::UnsupportedGrid, "cubes");
}

TEST(Filters, TakeNonFiniteValuesAsOutsideBeforeTheFirstStep) {
  const auto whole = makeSphere(1);
  auto grid = whole->deepCopy();
  auto accessor = grid->getAccessor();
  int count = 0;
  for (auto value = whole->cbeginValueOn(); value && count < 40; ++value) {
    if (*value < kVoxel) continue;  // a voxel outside the surface
    accessor.setValue(value.getCoord(), count % 2 == 0 ? NAN : INFINITY);
    ++count;
  }
  const Filter smooth = Smooth{};
  expectError(ErrorCode::NonFiniteValues, "40 NaN or infinite values, the first at",
              [&] { static_cast<void>(after(*grid, smooth)); });
  FilterOptions options;
  options.nonFinite = NonFinite::Outside;
  std::vector<FilterReport> reports;
  const auto smoothed = applyFilters(*grid, {smooth, smooth}, options, &reports);
  EXPECT_EQ(reports.at(0).nonFiniteValues, 40u);
  EXPECT_EQ(reports.at(1).nonFiniteValues, 0u);
  EXPECT_NEAR(volumeOf(*smoothed), volumeOf(*after(*after(*whole, smooth), smooth)), 0.01);
  // Where the background is inside, the value on the other side of the isovalue.
  auto fog = FloatGrid::create(1);
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->tree().setValue({0, 0, 0}, NAN);
  fog->tree().setValue({1, 0, 0}, 0.75F);
  options.isovalue = 0.25;
  const auto clipped = applyFilters(*fog, {ClipBox{{-9, -9, -9}, {9, 9, 9}}}, options);
  EXPECT_EQ(openvdb::gridPtrCast<FloatGrid>(clipped)->tree().getValue({0, 0, 0}), -0.5F);
}

// Positions became NaN without a word.
TEST(Labels, MeshesOfAnotherGridShareNoInterfaces) {
  const auto grid = openvdb::Int32Grid::create(0);
  grid->tree().setValueOn({5, 5, 5}, 3);
  ContourOptions options;
  options.isovalue = 0.5;
  options.keepCells = true;
  const auto meshes = [&] {
    return std::vector<Mesh>{
        extract(*labelVolumes(*grid, {3}).front(), Method::SurfaceNets, {.contour = options})};
  };
  std::vector<Mesh> own = meshes();
  EXPECT_EQ(shareInterfaces(*grid, {3}, own).size(), 1U);
  own.front().quads.front().vertices[0] = 1U << 30;
  expectError(ErrorCode::InvalidArgument, "a face names vertex 1073741824",
              [&] { (void)shareInterfaces(*grid, {3}, own); });
  own = meshes();
  own.front().normals.resize(1);
  expectError(ErrorCode::InvalidArgument, "1 normals",
              [&] { (void)shareInterfaces(*grid, {3}, own); });
  own = meshes();
  grid->tree().setValueOn({5, 5, 5}, 4);
  own.front().cells.front() = Coord(100, 0, 0);
  expectError(ErrorCode::InvalidArgument, "mesh of label 3 is not of this grid",
              [&] { (void)shareInterfaces(*grid, {3}, own); });
}

TEST(Filters, TellThatNothingIsToDo) {
  double done = 0;
  FilterOptions options;
  options.progress = [&](std::string_view, double fraction) { return (done = fraction) <= 1; };
  const auto grid = makeSphere(1);
  EXPECT_EQ(applyFilters(*grid, {}, options)->activeVoxelCount(), grid->activeVoxelCount());
  EXPECT_EQ(done, 1);
  options.progress = [](std::string_view, double) { return false; };
  expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)applyFilters(*grid, {}, options); });
}

// They came back as errors of the grid.
TEST(Filters, LetThroughWhatTheProgressThrows) {
  const auto grid = makeSphere(1);
  FilterOptions options;
  options.progress = [](std::string_view, double) -> bool { throw openvdb::IoError("mine"); };
  EXPECT_THROW((void)applyFilters(*grid, {Smooth{}}, options), openvdb::IoError);
  UniteOptions uniting;
  uniting.progress = options.progress;
  EXPECT_THROW((void)uniteLevelSets({grid, grid}, uniting), openvdb::IoError);
}

// It was called for each voxel, 640,000 times in one resampling.
TEST(Filters, TellProgressNowAndThen) {
  constexpr int kChecks = 200000;
  int calls = 0;
  double last = -1;
  const Progress progress = [&](std::string_view, double fraction) {
    ++calls;
    EXPECT_GE(fraction, last);
    last = fraction;
    return fraction < 1;
  };
  grid::ProgressInterrupter interrupter(progress, "test", 0.5, 1);
  EXPECT_FALSE(interrupter.wasInterrupted());
  EXPECT_EQ(last, 0.5) << "the first time";
  for (int n = 0; n < kChecks; ++n) ASSERT_FALSE(interrupter.wasInterrupted());
  EXPECT_LT(calls, kChecks / 2);
  EXPECT_FALSE(interrupter.wasInterrupted(40));
  EXPECT_EQ(last, 0.7) << "whenever the percentage has risen";
  EXPECT_FALSE(interrupter.wasInterrupted(20));
  EXPECT_TRUE(interrupter.wasInterrupted(100));
  const int all = calls;
  EXPECT_TRUE(interrupter.wasInterrupted());
  EXPECT_EQ(calls, all);
}

// They hold integers, said the message, and must hold integers.
TEST(Labels, NameTheTreeThatIsNotOpenVdbsUsual) {
  const auto grid = openvdb::Grid<openvdb::tree::Tree4<std::int32_t, 3, 4, 3>::Type>::create();
  expectError(ErrorCode::UnsupportedGrid, "Tree_int32_3_4_3",
              [&] { (void)labelVolumes(*grid, {3}); });
}

TEST(Filters, CanBeCancelled) {
  FilterOptions options;
  options.progress = [](std::string_view stage, double /*fraction*/) { return stage != "open"; };
  const auto grid = makeSphere(1);
  expectError(ErrorCode::Cancelled, "cancelled", [&] {
    static_cast<void>(applyFilters(*grid, {Smooth{}, Open{0.3}, Smooth{}}, options));
  });
  // While they are clipped.
  int told = 0;
  options.progress = [&](std::string_view, double) { return ++told < 2; };
  for (const Filter& filter : {Filter(Mask{grid}), Filter(ClipBox{{-1, -1, -1}, {0, 0, 0}})}) {
    told = 0;
    expectError(ErrorCode::Cancelled, "cancelled",
                [&] { static_cast<void>(applyFilters(*grid, {filter}, options)); });
    EXPECT_EQ(told, 2);
  }
  // In the middle of what OpenVDB tracks.
  int calls = 0;
  options.progress = [&](std::string_view, double) { return ++calls < 2; };
  for (const Filter& filter : {Filter(Offset{2}), Filter(Open{2}), Filter(Close{2})}) {
    calls = 0;
    expectError(ErrorCode::Cancelled, "cancelled",
                [&] { static_cast<void>(applyFilters(*grid, {filter}, options)); });
    EXPECT_EQ(calls, 2) << "who has said no is not asked again";
  }
}

}  // namespace
}  // namespace tufa
