#include "grid/volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "grid/vdb_coord.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/print.h"

namespace tufa::grid {
namespace {

using openvdb::FloatGrid;

FloatGrid::Ptr ball(double radius, const openvdb::Coord& centre) {
  const int reach = static_cast<int>(radius) + 5;
  return test::levelSet<FloatGrid>(
      {centre.offsetBy(-reach), centre.offsetBy(reach)}, 3,
      [&](const openvdb::Coord& at) { return (at - centre).asVec3d().length() - radius; }, 0.5);
}

TEST(Volume, RefusesGridsWithoutAnIsosurface) {
  const auto integers = openvdb::Int32Grid::create(1);
  integers->setName("counts");
  test::expectError(ErrorCode::UnsupportedGrid, "\"counts\"", [&] { requireMeshable(*integers); });
  EXPECT_NO_THROW(requireMeshable(*FloatGrid::create(1)));
  EXPECT_NO_THROW(requireMeshable(*openvdb::DoubleGrid::create(1)));
}

TEST(Volume, RefusesFrustums) {
  const auto grid = FloatGrid::create(1);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 1.0));
  test::expectError(ErrorCode::UnsupportedGrid, "only linear", [&] { requireMeshable(*grid); });
}

TEST(Volume, RefusesCoordinatesNearTheEndsOfIntegers) {
  for (const std::int32_t at :
       {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}) {
    const auto grid = FloatGrid::create(1);
    grid->tree().setValue(openvdb::Coord(0, at, 0), -1);
    test::expectError(ErrorCode::LimitExceeded, "coordinates", [&] { requireMeshable(*grid); });
    // A tile may be inside whether it is active or not.
    for (const openvdb::Index level : {1, 2, 3}) {
      const auto tiles = openvdb::DoubleGrid::create(1);
      tiles->tree().addTile(level, openvdb::Coord(at, 0, 0), -1, false);
      test::expectError(ErrorCode::LimitExceeded, "coordinates", [&] { requireMeshable(*tiles); });
    }
  }
}

TEST(Volume, CountsPositionsFromItsLowestBlock) {
  base::Job job(1, {});
  const Volume volume = openVolume(*ball(9.3, openvdb::Coord(100, -50, 3)), {}, job);
  Coord lowest(std::numeric_limits<std::int32_t>::max());
  for (std::size_t i = 0; i < volume.blocks.count(); ++i) {
    lowest = minCoord(lowest, volume.blocks.origin(static_cast<BlockRef>(i)));
  }
  EXPECT_EQ(volume.affine.origin(), lowest);
  EXPECT_EQ(volume.affine.position(lowest, 0, 0, 0), Position(0, 0, 0));
  EXPECT_DOUBLE_EQ(volume.affine.voxelSize(), 0.5);
}

TEST(Volume, ScalesALevelSetToVoxels) {
  base::Job job(1, {});
  const auto grid = ball(9.3, openvdb::Coord(0));
  const Volume volume = openVolume(*grid, {}, job);
  EXPECT_TRUE(volume.scale.distance);
  EXPECT_TRUE(volume.scale.narrowBand);
  EXPECT_DOUBLE_EQ(volume.scale.factor, 2);
  EXPECT_EQ(volume.scale.isovalue, 0);
  EXPECT_EQ(nameOf(*grid), "");
  grid->setName("ball");
  EXPECT_EQ(nameOf(*grid), "ball");
}

// Plates in a direction of the lattice and in none. On the other side of the middle of a thin wall
// distances fall again: half of the gradients at the first plate's surface are too short if they
// are means of both sides.
TEST(Volume, TellsDistancesInThinWalls) {
  base::Job job(1, {});
  for (const openvdb::Vec3d normal : {openvdb::Vec3d(0, 0, 1), openvdb::Vec3d(0.36, 0.48, 0.8)}) {
    for (const double thickness : {2.0, 1.2, 1.7, 2.3, 3.0}) {
      const auto plate = [&](const openvdb::Coord& at) {
        const double wall = std::abs(at.asVec3d().dot(normal) - 0.5) - thickness / 2;
        return std::max(wall, at.asVec3d().length() - 20);
      };
      const openvdb::CoordBBox box(openvdb::Coord(-24), openvdb::Coord(24));
      const auto grid = test::levelSet<FloatGrid>(box, 3, plate, 0.5);
      EXPECT_TRUE(openVolume(*grid, {}, job).scale.distance) << normal << ' ' << thickness;
      const auto halved = [&](const openvdb::Coord& at) { return 0.5 * plate(at); };
      const auto other = test::levelSet<FloatGrid>(box, 3, halved, 0.5);
      EXPECT_FALSE(openVolume(*other, {}, job).scale.distance) << normal << ' ' << thickness;
    }
  }
}

TEST(Volume, OfASlabHasTheBlocksInItAndCountsFromTheSamePoint) {
  base::Job job(1, {});
  const auto grid = ball(20.3, openvdb::Coord(0));
  const Volume whole = openVolume(*grid, {}, job);
  const Slab slab{1, -16, 7};
  const Volume part = partOf(whole, slab, job);
  EXPECT_TRUE(part.blocks.isPart());
  EXPECT_FALSE(whole.blocks.isPart());
  EXPECT_EQ(part.affine.origin(), whole.affine.origin());
  std::size_t inside = 0;
  for (std::size_t i = 0; i < whole.blocks.count(); ++i) {
    inside += slab.contains(whole.blocks.origin(static_cast<BlockRef>(i))) ? 1 : 0;
  }
  ASSERT_GT(inside, 0U);
  ASSERT_LT(inside, whole.blocks.count());
  ASSERT_EQ(part.blocks.count(), inside);
  EXPECT_FALSE(part.blocks.isInsideOutermost());
  const auto accessor = whole.blocks.accessor(), own = part.blocks.accessor();
  for (std::size_t i = 0; i < part.blocks.count(); ++i) {
    const auto block = static_cast<BlockRef>(i);
    const Coord& origin = part.blocks.origin(block);
    EXPECT_TRUE(slab.contains(origin)) << origin;
    EXPECT_EQ(part.blocks.find(origin, *own), block);
    const BlockRef there = whole.blocks.find(origin, *accessor);
    ASSERT_GE(there, 0) << origin;
    EXPECT_EQ(part.blocks.inside(block).slabs, whole.blocks.inside(there).slabs) << origin;
  }
}

}  // namespace
}  // namespace tufa::grid
