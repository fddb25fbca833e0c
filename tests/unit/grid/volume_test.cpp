#include "grid/volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/index_box.h"
#include "base/leaf_source.h"
#include "grid/samples.h"
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

// A function over the length of its gradient at each sample: near to a distance, and nowhere one.
TEST(Volume, OfAFunctionOverItsGradientIsNoDistance) {
  base::Job job(1, {});
  const openvdb::CoordBBox box(openvdb::Coord(-24), openvdb::Coord(24));
  for (const double period : {20.0, 30.0, 45.0}) {
    const double k = 2 * std::acos(-1) / period;
    // The shell of 0.3 periods about Schoen's gyroid, which is smooth.
    const auto shell = [&](const openvdb::Coord& at) {
      const openvdb::Vec3d p = at.asVec3d() * k;
      const openvdb::Vec3d s(std::sin(p.x()), std::sin(p.y()), std::sin(p.z()));
      const openvdb::Vec3d c(std::cos(p.x()), std::cos(p.y()), std::cos(p.z()));
      const double g = s.x() * c.y() + s.y() * c.z() + s.z() * c.x();
      const openvdb::Vec3d slope(c.x() * c.y() - s.z() * s.x(), c.y() * c.z() - s.x() * s.y(),
                                 c.z() * c.x() - s.y() * s.z());
      return std::abs(g) / (k * slope.length()) - 0.075 * period;
    };
    const auto grid = test::levelSet<FloatGrid>(box, 3, shell, 1);
    EXPECT_FALSE(openVolume(*grid, {}, job).scale.distance) << period;
  }
}

TEST(Volume, OfASlabHasTheBlocksInItAndCountsFromTheSamePoint) {
  base::Job job(1, {});
  const auto grid = ball(20.3, openvdb::Coord(0));
  const Volume whole = openVolume(*grid, {}, job);
  const Slab slab{1, -16, 7};
  const Volume part = partOf(whole, slab, slab, job);
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

// Samples and sides, of white noise beside tiles.
TEST(Volume, OfASlabGoesOnBeyondItAsInItsLastLayer) {
  base::Job job(1, {});
  const auto grid = test::randomTree<FloatGrid>({.seed = 5});
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  ContourOptions options;
  options.isovalue = 0;
  options.inside = Inside::Below;
  const Volume whole = openVolume(*grid, options, job);
  const auto wholeAccessor = whole.blocks.accessor();
  base::IndexBox box;
  for (std::size_t i = 0; i < whole.blocks.count(); ++i) {
    box.add(whole.blocks.origin(static_cast<BlockRef>(i)));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Slab slab{axis, box.min[axis] + 8,
                    box.max[axis] - 1};  // without the first and last blocks
    const Volume part = partOf(whole, slab, slab, job);
    ASSERT_GT(part.blocks.count(), 0U);
    const auto accessor = part.blocks.accessor();
    std::size_t continued = 0;
    for (std::size_t i = 0; i < part.blocks.count(); ++i) {
      const auto block = static_cast<BlockRef>(i);
      const Coord& origin = part.blocks.origin(block);
      const Neighbours neighbours = part.blocks.neighbours(block, *accessor);
      BlockSamples samples;
      samples.gather(part.blocks, part.scale, block, neighbours, *accessor);
      const SampleReader reader(part.blocks, part.scale, block, neighbours, *accessor);
      const CornerWords corners = part.blocks.cornerWords(neighbours);
      for (int n = 0; n < 11 * 11 * 11; ++n) {
        const Coord step(n / 121 - 1, n / 11 % 11 - 1, n % 11 - 1);
        Coord at = origin + step;
        if (!slab.contains(at) && whole.blocks.find(at & ~7, *wholeAccessor) >= 0) {
          at[axis] = std::clamp(at[axis], slab.first, slab.last);
          ++continued;
        }
        const double expected = double(grid->tree().getValue(toVdb(at))) * part.scale.factor;
        ASSERT_NEAR(double(samples[BlockSamples::index(step[0], step[1], step[2])]), expected, 1e-6)
            << origin << step;
        ASSERT_NEAR(reader.at(step[0], step[1], step[2]), expected, 1e-6) << origin << step;
        if (minCoord(step, Coord(0)) != Coord(0) || step[0] > 8 || step[1] > 8 || step[2] > 8)
          continue;
        // Word 0 to 3: the corner itself, and one further in z, in y, in both.
        const int y = std::min(step[1], 7), z = std::min(step[2], 7);
        const std::uint64_t word = corners.words[step[0]][(step[1] - y) * 2 + (step[2] - z)];
        ASSERT_EQ((word >> (y * 8 + z) & 1) != 0, expected < 0) << origin << step;
      }
    }
    EXPECT_GT(continued, 0U) << axis;
  }
}

/// The leaves of a grid, as if they were elsewhere.
class LeavesOf : public base::LeafSource {
 public:
  explicit LeavesOf(const FloatGrid& grid) { grid.tree().getNodes(leaves_); }

  void read(std::size_t leaf, void* values) override {
    ++reads;
    std::copy_n(leaves_.at(leaf)->buffer().data(), kBlockCells, static_cast<float*>(values));
  }

  std::size_t reads = 0;

 private:
  std::vector<const FloatGrid::TreeType::LeafNodeType*> leaves_;
};

// The tree itself has other values, which nobody may look at.
TEST(Volume, OfStoredLeavesIsAsOneInMemory) {
  base::Job job(2, {});
  const auto grid = ball(20.3, openvdb::Coord(0));
  const auto outline = grid->deepCopy();
  for (auto leaf = outline->tree().beginLeaf(); leaf; ++leaf) leaf->buffer().fill(1e6F);
  LeavesOf leaves(*grid);
  const Volume whole = openVolume(*grid, {}, job);
  Volume stored = openVolume({*outline, &leaves}, {}, job);
  EXPECT_EQ(stored.scale.distance, whole.scale.distance);
  EXPECT_EQ(stored.blocks.activeVoxels(), whole.blocks.activeVoxels());
  ASSERT_EQ(stored.blocks.count(), whole.blocks.count());
  for (std::size_t i = 0; i < whole.blocks.count(); ++i) {
    const auto block = static_cast<BlockRef>(i);
    EXPECT_EQ(stored.blocks.inside(block).slabs, whole.blocks.inside(block).slabs);
  }
  const auto expectSamples = [&](const Volume& volume) {
    const auto accessor = volume.blocks.accessor();
    for (std::size_t i = 0; i < volume.blocks.count(); ++i) {
      const auto block = static_cast<BlockRef>(i);
      const Coord at = volume.blocks.origin(block).offsetBy(3, 2, 5);
      const float expected = grid->tree().getValue(toVdb(at));
      EXPECT_EQ(accessor->value(at), double(expected)) << at;
      if (volume.blocks.leaf(block) == kNoLeaf) continue;
      EXPECT_EQ(volume.blocks.tree().leafValue(volume.blocks.leaf(block), cellIndex(3, 2, 5)),
                double(expected));
    }
  };
  const std::size_t before = leaves.reads;
  const Slab slab{1, -16, 7};
  const Volume part = partOf(stored, slab, slab, job);
  EXPECT_LT(leaves.reads - before, grid->tree().leafCount());
  EXPECT_GT(part.blocks.count(), 0U);
  expectSamples(part);
  load(stored, job);
  expectSamples(stored);
  const std::size_t all = leaves.reads;
  load(stored, job);
  EXPECT_EQ(leaves.reads, all) << "read once more";
}

TEST(Volume, WithAFogOfStoredLeavesHasItsIsovalue) {
  base::Job job(1, {});
  const auto grid = test::noise<FloatGrid>({.size = 20});
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  const auto outline = grid->deepCopy();
  for (auto leaf = outline->tree().beginLeaf(); leaf; ++leaf) leaf->buffer().fill(1e6F);
  LeavesOf leaves(*grid);
  EXPECT_EQ(chooseIsovalue({*outline, &leaves}, {}, Inside::Auto).isovalue,
            chooseIsovalue(*grid, {}, Inside::Auto).isovalue);
}

}  // namespace
}  // namespace tufa::grid
