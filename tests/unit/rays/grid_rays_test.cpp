// Rays to volumes and meshes, and pictures of them.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <tufa/contour.h>
#include <tufa/picture.h>
#include <tufa/rays.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/vec3.h"
#include "implicit/fields.h"
#include "support/expect_error.h"
#include "support/fields.h"

namespace tufa {
namespace {

openvdb::FloatGrid::Ptr sphereGrid(double voxel = 0.1) {
  return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1.0F, {0.2F, 0.1F, 0},
                                                                  static_cast<float>(voxel));
}

/// The same values as a fog volume, in voxels that are no cubes.
openvdb::FloatGrid::Ptr slantedFog() {
  const auto grid = sphereGrid();
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  matrix.setToScale(openvdb::Vec3d(0.1, 0.2, 0.1));
  matrix.preRotate(openvdb::math::Z_AXIS, 0.4);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  for (auto value = grid->beginValueAll(); value; ++value) value.setValue(-value.getValue());
  grid->tree().root().setBackground(-grid->background(), false);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  return grid;
}

std::vector<Ray> raysTowards(const implicit::Box& box, int count) {
  std::mt19937 random(7);
  const auto share = [&] { return static_cast<double>(random()) / 4294967295.0; };
  const Vec3 least = box.least;
  const Vec3 size = Vec3(box.greatest) - least;
  std::vector<Ray> rays;
  for (int n = 0; n < count; ++n) {
    const Vec3 aim = least + Vec3(share() * size[0], share() * size[1], share() * size[2]);
    Vec3 direction(share() - 0.5, share() - 0.5, share() - 0.5);
    // Along an axis, too, where a component is 0.
    if (n % 10 == 0) direction = Vec3(0, 0, 1);
    direction = direction.unitOrX();
    rays.push_back({aim - direction * (2 * size.length()), direction});
  }
  return rays;
}

TEST(GridRays, BothSearchesFindTheSphereOfALevelSet) {
  const auto grid = sphereGrid();
  const auto byOpenVdb = makeRaySurface(grid);
  // As a grid of no class it goes the other way.
  const auto plain = sphereGrid();
  plain->setGridClass(openvdb::GRID_UNKNOWN);
  RaySurfaceOptions options;
  options.isovalue = 0;
  options.inside = Inside::Below;
  const auto byCells = makeRaySurface(plain, options);
  int hits = 0;
  for (const Ray& ray : raysTowards(boundsOf(*byCells), 2000)) {
    const Vec3 offset = Vec3(0.2, 0.1, 0) - Vec3(ray.origin);
    const double along = offset.dot(ray.direction);
    const double across = (offset - Vec3(ray.direction) * along).length();
    const auto a = castRay(*byOpenVdb, ray);
    const auto b = castRay(*byCells, ray);
    // A sphere of trilinear cells is a little smaller.
    if (std::abs(across - 1) < 0.005) continue;
    ASSERT_EQ(a.has_value(), across < 1) << across;
    ASSERT_EQ(b.has_value(), across < 1) << across;
    if (across > 0.95) continue;
    if (!a) continue;
    ++hits;
    const double truth = along - std::sqrt(1 - across * across);
    ASSERT_NEAR(a->distance, truth, 0.01);
    ASSERT_NEAR(b->distance, truth, 0.01);
    ASSERT_NEAR(a->distance, b->distance, 1e-4);
    const Vec3 outward = Vec3(b->point) - Vec3(0.2, 0.1, 0);
    ASSERT_GT(outward.dot(Vec3(a->normal)), 0.99);
    ASSERT_GT(outward.dot(Vec3(b->normal)), 0.99);
  }
  EXPECT_GT(hits, 500);
}

/// The mesh of all its cells is an independent witness of where the surface is.
TEST(GridRays, FogInSlantedVoxelsIsWhereItsMeshIs) {
  const auto grid = slantedFog();
  RaySurfaceOptions options;
  options.isovalue = 0;
  const auto fog = makeRaySurface(grid, options);
  ContourOptions contourOptions;
  contourOptions.isovalue = 0;
  contourOptions.uniform = true;
  const auto mesh = makeRaySurface(contour(*grid, contourOptions));
  PictureOptions picture;
  picture.width = 120;
  picture.height = 100;
  const SurfaceComparison same = compareSurfaces(*fog, *mesh, 0.03, picture);
  EXPECT_GT(same.pixels, 5000u);
  EXPECT_LT(same.share(), 0.0005);
  picture.view.fieldOfView = 50;
  EXPECT_LT(compareSurfaces(*fog, *mesh, 0.03, picture).share(), 0.0005);
  const auto none = makeRaySurface(Mesh{});
  EXPECT_EQ(compareSurfaces(*fog, *none, 0.03, picture).share(), 1);
  EXPECT_EQ(compareSurfaces(*none, *fog, 0.03, picture).share(), 1);
}

/// Where a ray enters a cube about the origin; infinite if it does not.
double entryTo(double half, const Ray& ray) {
  double first = 0, last = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = Vec3(ray.origin)[axis], by = Vec3(ray.direction)[axis];
    const double a = (-half - at) / by, b = (half - at) / by;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first < last ? first : std::numeric_limits<double>::infinity();
}

// Rays passed through: the sign changes within no cell.
TEST(GridRays, MeetAPlaneOfSamplesAtTheIsovalue) {
  for (const double sign : {1.0, -1.0}) {
    for (const double voxel : {1.0, 0.1}) {
      const auto grid = test::sampled<openvdb::FloatGrid>(
          {openvdb::Coord(-6), openvdb::Coord(6)}, static_cast<float>(-sign),
          [&](const openvdb::Coord& at) {
            const int size = std::max({std::abs(at.x()), std::abs(at.y()), std::abs(at.z())});
            return sign * std::clamp(4 - size, -1, 1);
          });
      grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
      RaySurfaceOptions options;
      options.isovalue = 0;
      const auto surface = makeRaySurface(grid, options);
      for (const Ray& ray : raysTowards({Position(-3 * voxel, -3 * voxel, -3 * voxel),
                                         Position(3 * voxel, 3 * voxel, 3 * voxel)},
                                        2000)) {
        const auto hit = castRay(*surface, ray);
        ASSERT_TRUE(hit);
        ASSERT_NEAR(hit->distance, entryTo(4 * voxel, ray), 0.01 * voxel);
      }
    }
  }
}

// Cells with a sample that is not active were passed through.
TEST(GridRays, MeetLevelSetsAtIsovaluesNearTheEndOfTheBand) {
  const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(10, {0, 0, 0}, 1, 3);
  for (const double isovalue : {-2.0, 2.0}) {
    RaySurfaceOptions options;
    options.isovalue = isovalue;
    const auto surface = makeRaySurface(grid, options);
    for (const Ray& ray : raysTowards({Position(-1, -1, -1), Position(1, 1, 1)}, 2000)) {
      const auto hit = castRay(*surface, {{0, 0, 0}, ray.direction});
      ASSERT_TRUE(hit);
      ASSERT_NEAR(hit->distance, 10 + isovalue, 0.1);
    }
  }
}

// Rays passed through: OpenVDB's intersector looks in active voxels alone.
TEST(GridRays, MeetLevelSetsWithNarrowBands) {
  for (const float halfWidth : {1.1F, 1.5F, 1.9F, 2.0F}) {
    const auto grid =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1, {0, 0, 0}, 0.05F, halfWidth);
    const auto surface = makeRaySurface(grid);
    for (const Ray& ray : raysTowards({Position(-1, -1, -1), Position(1, 1, 1)}, 2000)) {
      const auto hit = castRay(*surface, {{0, 0, 0}, ray.direction});
      ASSERT_TRUE(hit) << halfWidth;
      ASSERT_NEAR(hit->distance, 1, 0.005) << halfWidth;
    }
  }
}

// They were holes, without a word.
TEST(GridRays, RefuseValuesThatAreNotFinite) {
  for (const openvdb::GridClass kind : {openvdb::GRID_LEVEL_SET, openvdb::GRID_UNKNOWN}) {
    const auto grid = sphereGrid();
    grid->setGridClass(kind);
    RaySurfaceOptions options;
    options.isovalue = 0;
    options.inside = Inside::Below;
    EXPECT_NO_THROW((void)makeRaySurface(grid, options));
    for (const float value : {std::nanf(""), -std::numeric_limits<float>::infinity()}) {
      grid->tree().setValue({1, 2, 3}, value);
      test::expectError(ErrorCode::NonFiniteValues,
                        "1 NaN or infinite value, the first at index (1, 2, 3)",
                        [&] { (void)makeRaySurface(grid, options); });
    }
  }
}

// OpenVDB's intersector was off by most of a voxel, and missed.
// A voxel is no step of a ray that begins so far away.
TEST(GridRays, FromFarAwayComeToAnEnd) {
  const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1, {0, 0, 0}, 0.1F);
  const auto surface = makeRaySurface(grid);
  for (const double far : {1e4, 1e6, 1e9, 1e15, 1e30}) {
    const auto hit = castRay(*surface, {{0.01, 0.02, -far}, {0, 0, 1}});
    if (far > 1e12) continue;  // a hit or none
    ASSERT_TRUE(hit) << far;
    EXPECT_NEAR(hit->distance, far - 1, 0.01 + far * 1e-14);
    EXPECT_NEAR(hit->point.z, -1, 0.01 + far * 1e-14);
  }
}

TEST(GridRays, HitLevelSetsFarFromTheirIndexOrigin) {
  for (const int far : {0, 10000, 10000000, 100000000}) {
    const openvdb::Coord centre(far, -far, far);
    const auto grid = test::levelSet<openvdb::FloatGrid>(
        {centre.offsetBy(-15), centre.offsetBy(15)}, 3,
        [&](const openvdb::Coord& at) { return (at - centre).asVec3d().length() - 10; });
    const auto surface = makeRaySurface(grid);
    const Vec3 middle(far, -far, far);
    for (const Vec3& offset : {Vec3(0), Vec3(0.3, 0.2, 0), Vec3(4, -5, 1)}) {
      const Vec3 direction = Vec3(0.2, 0.3, 1).unitOrX();
      const auto hit = castRay(*surface, {middle + offset - direction * 40, direction});
      ASSERT_TRUE(hit) << far;
      EXPECT_NEAR((Vec3(hit->point) - middle).length(), 10, 0.06) << far;
    }
  }
}

// OpenVDB's intersector walked a box without bounds. Where no voxel is active the values are
// distances still, and contour() finds their surface.
TEST(GridRays, EndWhereNoVoxelIsActive) {
  const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1, {0, 0, 0}, 0.2F);
  for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) leaf->setValuesOff();
  PictureOptions options;
  options.width = options.height = 9;
  EXPECT_GT(takePicture(*makeRaySurface(grid), options).covered, 0.5);
}

TEST(MeshRays, PassNoEdgeOrVertexOfAClosedMesh) {
  const Mesh mesh = contour(*sphereGrid(0.2));
  const auto surface = makeRaySurface(mesh);
  const Vec3 centre(0.2, 0.1, 0);
  for (const Triangle& triangle : triangulate(mesh)) {
    const Vec3 a = mesh.positions[triangle.vertices[0]];
    const Vec3 b = mesh.positions[triangle.vertices[1]];
    ASSERT_TRUE(castRay(*surface, {centre, a - centre}));
    ASSERT_TRUE(castRay(*surface, {centre, (a + b) * 0.5 - centre}));
    ASSERT_TRUE(castRay(*surface, {a * 3 - centre * 2, centre - a}));
  }
  Mesh broken = mesh;
  broken.triangles.emplace_back(0, 1, 1u << 30);
  test::expectError(ErrorCode::InvalidArgument, "names vertex",
                    [&] { (void)makeRaySurface(broken); });
}

TEST(Pictures, AreTheSameBytesForAnyNumberOfThreads) {
  const auto surface = makeRaySurface(sphereGrid());
  PictureOptions options;
  options.width = 50;
  options.height = 40;
  options.samples = 4;
  options.threads = 1;
  const Picture one = takePicture(*surface, options);
  options.threads = 3;
  const Picture three = takePicture(*surface, options);
  EXPECT_EQ(one.pixels, three.pixels);
  EXPECT_EQ(one.covered, three.covered);
  // A disc that fills the height nearly.
  EXPECT_NEAR(one.covered, 3.14159 / 4 * 0.92 * 0.92 * 40 / 50, 0.06);
  options.progress = [](std::string_view, double) { return false; };
  test::expectError(ErrorCode::Cancelled, "", [&] { (void)takePicture(*surface, options); });
  options.progress = {};
  options.samples = 0;
  test::expectError(ErrorCode::InvalidArgument, "samples",
                    [&] { (void)takePicture(*surface, options); });
}

TEST(Pictures, ComparisonSeesHalfAVoxel) {
  const auto truth = makeRaySurface(implicit::makeSphere({0, 0, 0}, 1));
  PictureOptions options;
  options.width = 100;
  options.height = 80;
  const auto shareOf = [&](double radius) {
    const auto other = makeRaySurface(implicit::makeSphere({0, 0, 0}, radius));
    return compareSurfaces(*truth, *other, 0.05, options).share();
  };
  EXPECT_EQ(shareOf(1), 0);
  EXPECT_LT(shareOf(1.03), 0.002);
  EXPECT_LT(shareOf(0.97), 0.002);
  EXPECT_GT(shareOf(1.08), 0.9);
  EXPECT_GT(shareOf(0.92), 0.9);
}

}  // namespace
}  // namespace tufa
