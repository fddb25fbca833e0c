// Levels chosen for chunks: restriction, masks, and what a camera asks for.

#include <gtest/gtest.h>

#include <tufa/chunks.h>
#include <cmath>
#include <cstdlib>
#include <random>

#include "support/expect_error.h"

namespace tufa {
namespace {

/// A block of chunks of 16 voxels of 0.5 units, with some missing.
ChunkIndex makeIndex(int size, int levels) {
  ChunkIndex index;
  index.voxelSize = 0.5;
  for (int k = 0; k < levels; ++k) index.tolerances.push_back(0.1 * std::pow(4.0, k));
  for (int x = -size; x < size; ++x) {
    for (int y = -size; y < size; ++y) {
      for (int z = -size; z < size; ++z) {
        if ((x * 7 + y * 5 + z * 3) % 11 == 0) continue;
        ChunkEntry& chunk = index.chunks.emplace_back();
        chunk.index = Coord(x, y, z);
        for (const double tolerance : index.tolerances) {
          ChunkLevelEntry& level = chunk.levels.emplace_back();
          level.least = Position(8.0 * x, 8.0 * y, 8.0 * z);
          level.greatest = Position(8.0 * x + 8, 8.0 * y + 8, 8.0 * z + 8);
          level.vertices = 8;
          level.maxErrorVoxels = tolerance;
        }
      }
    }
  }
  return index;
}

bool isRestricted(const ChunkIndex& index, const std::vector<std::size_t>& lods) {
  for (std::size_t i = 0; i < lods.size(); ++i) {
    for (int face = 0; face < kChunkFaces; ++face) {
      const std::ptrdiff_t other = index.neighbour(i, face);
      if (other >= 0 && lods[static_cast<std::size_t>(other)] > lods[i] + 1) return false;
    }
  }
  return true;
}

TEST(ChunkIndex, FindsChunksAndTheirNeighbours) {
  const ChunkIndex index = makeIndex(3, 2);
  for (std::size_t i = 0; i < index.chunks.size(); ++i) {
    EXPECT_EQ(index.find(index.chunks[i].index), static_cast<std::ptrdiff_t>(i));
    for (int face = 0; face < kChunkFaces; ++face) {
      Coord beyond = index.chunks[i].index;
      beyond[face / 2] += face % 2 == 1 ? 1 : -1;
      const std::ptrdiff_t other = index.neighbour(i, face);
      EXPECT_EQ(other, index.find(beyond));
      if (other >= 0) {
        EXPECT_EQ(index.chunks[static_cast<std::size_t>(other)].index, beyond);
      }
    }
  }
  EXPECT_EQ(index.find(Coord(0, 0, 0)), -1);  // one of those left out
  EXPECT_EQ(index.find(Coord(9, 0, 0)), -1);
  EXPECT_EQ(ChunkIndex().find(Coord(0)), -1);
}

TEST(RestrictLods, LowersToTheLargestRestrictedLevels) {
  const ChunkIndex index = makeIndex(3, 6);
  std::mt19937 random(5);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::size_t> asked(index.chunks.size());
    for (std::size_t& lod : asked) lod = random() % 8 == 0 ? random() % 6 : 5;
    std::vector<std::size_t> lods = asked;
    restrictLods(index, lods);
    EXPECT_TRUE(isRestricted(index, lods));
    for (std::size_t i = 0; i < lods.size(); ++i) {
      EXPECT_LE(lods[i], asked[i]);
      if (lods[i] == asked[i]) continue;
      // One more would be too much beside some neighbour.
      bool held = false;
      for (int face = 0; face < kChunkFaces; ++face) {
        const std::ptrdiff_t other = index.neighbour(i, face);
        held = held || (other >= 0 && lods[static_cast<std::size_t>(other)] + 1 == lods[i]);
      }
      EXPECT_TRUE(held) << i;
    }
  }
}

TEST(TransitionMask, HasABitForEachCoarserNeighbour) {
  const ChunkIndex index = makeIndex(2, 3);
  std::vector<std::size_t> lods(index.chunks.size(), 1);
  const auto place = [&](int x, int y, int z) {
    return static_cast<std::size_t>(index.find(Coord(x, y, z)));
  };
  lods[place(1, 0, 1)] = 2;
  lods[place(0, -1, 1)] = 2;
  lods[place(0, 0, 0 + 1)] = 1;
  EXPECT_EQ(transitionMask(index, place(0, 0, 1), lods), 2u + 4u);  // +x and -y
  EXPECT_EQ(transitionMask(index, place(1, 0, 1), lods), 0u);
  lods[place(0, 0, 1)] = 0;
  const unsigned mask = transitionMask(index, place(0, 0, 1), lods);
  for (int face = 0; face < kChunkFaces; ++face) {
    EXPECT_EQ((mask >> face & 1u) != 0, index.neighbour(place(0, 0, 1), face) >= 0);
  }
}

TEST(SelectLods, TakesTheCoarsestLevelWhoseErrorIsSmallOnScreen) {
  const ChunkIndex index = makeIndex(4, 4);
  Camera camera;
  camera.eye = {-200, 3, 5};
  camera.verticalAngle = 1.0;
  camera.screenHeight = 800;
  const double pixelError = 1.5;
  const std::vector<std::size_t> lods = selectLods(index, camera, pixelError);
  EXPECT_TRUE(isRestricted(index, lods));
  std::size_t different = 0;
  for (std::size_t i = 0; i < lods.size(); ++i) {
    const ChunkLevelEntry& box = index.chunks[i].levels[0];
    const auto off = [](double x, double a, double b) { return x < a ? a - x : x > b ? x - b : 0; };
    const double distance = std::sqrt(std::pow(off(-200, box.least.x, box.greatest.x), 2) +
                                      std::pow(off(3, box.least.y, box.greatest.y), 2) +
                                      std::pow(off(5, box.least.z, box.greatest.z), 2));
    const auto pixels = [&](std::size_t k) {
      const double error = index.chunks[i].levels[k].maxErrorVoxels * index.voxelSize;
      return error / distance * camera.screenHeight / (2 * std::tan(camera.verticalAngle / 2));
    };
    EXPECT_TRUE(lods[i] == 0 || pixels(lods[i]) <= pixelError);
    if (lods[i] + 1 < 4 && pixels(lods[i] + 1) <= pixelError) ++different;
  }
  EXPECT_EQ(different, 0u);  // from so far away nothing needs to be restricted
  camera.eye = {1, 1, 1};
  const std::vector<std::size_t> near = selectLods(index, camera, 1e-3);
  EXPECT_EQ(near, std::vector<std::size_t>(index.chunks.size(), 0));
}

TEST(SelectLods, IsFinestWhereTheEyeIs) {
  ChunkIndex index = makeIndex(4, 4);
  for (ChunkEntry& chunk : index.chunks) chunk.levels[0].maxErrorVoxels = 0;
  Camera camera;
  camera.eye = {12, 4, 4};
  const std::vector<std::size_t> lods = selectLods(index, camera, 30);
  EXPECT_EQ(lods[static_cast<std::size_t>(index.find(Coord(1, 0, 0)))], 0u);
  EXPECT_TRUE(isRestricted(index, lods));
  EXPECT_GT(*std::max_element(lods.begin(), lods.end()), 1u);
}

TEST(SelectLods, DoesNotLookAtTheBoundsOfEmptyLevels) {
  ChunkIndex index = makeIndex(2, 2);
  const Camera camera{{100, 0, 0}};
  const std::vector<std::size_t> lods = selectLods(index, camera, 1);
  for (ChunkEntry& chunk : index.chunks) {
    ChunkLevelEntry& empty = chunk.levels.emplace_back();
    empty.least = empty.greatest = camera.eye;
    empty.maxErrorVoxels = 1e6;
  }
  EXPECT_EQ(selectLods(index, camera, 1), lods);
}

TEST(RestrictLods, RefusesLevelsThatThereAreNot) {
  ChunkIndex index;
  index.chunks.resize(2);
  for (ChunkEntry& chunk : index.chunks) chunk.levels.resize(3);
  std::vector<std::size_t> lods{2, 3};
  test::expectError(ErrorCode::InvalidArgument, "no level 3 of chunk 1, which has 3",
                    [&] { restrictLods(index, lods); });
}

TEST(SelectLods, RefusesLevelsOfAnotherIndex) {
  const ChunkIndex index = makeIndex(2, 2);
  std::vector<std::size_t> lods(3);
  test::expectError(ErrorCode::InvalidArgument, "3 levels for", [&] { restrictLods(index, lods); });
  test::expectError(ErrorCode::InvalidArgument, "3 levels for",
                    [&] { static_cast<void>(transitionMask(index, 0, lods)); });
  const std::size_t count = index.chunks.size();
  lods.assign(count, 0);
  const auto refused = [](const std::string& part, const auto& call) {
    test::expectError(ErrorCode::InvalidArgument, part, call);
  };
  refused("of chunk " + std::to_string(count),
          [&] { static_cast<void>(transitionMask(index, count, lods)); });
  refused("face 6", [&] { static_cast<void>(index.neighbour(0, 6)); });
  refused("face -1", [&] { static_cast<void>(index.neighbour(0, -1)); });
  ChunkIndex empty = index;
  empty.chunks.front().levels.clear();
  refused("no levels", [&] { static_cast<void>(selectLods(empty, Camera())); });
}

}  // namespace
}  // namespace tufa
