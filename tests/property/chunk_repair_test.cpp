// What chunks promise where the uniform mesh touches and passes through itself.

#include <gtest/gtest.h>

#include <tufa/chunks.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>
#include <tufa/voxelize.h>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "support/chunk_mixtures.h"
#include "support/mesh_oracle.h"
#include "support/openvdb_templates.h"
#include "support/random_solid.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

/// A few samples on both sides of a plane between chunks. Values far apart in size place crossings
/// on corners of cells, where vertices of several cells come to lie at the same place.
openvdb::FloatGrid::Ptr roughGrid(std::uint32_t seed) {
  constexpr std::array kValues{0.0F, 1.0F, -1.0F, 0.5F, -0.5F, 1e30F, -1e30F, 1e-38F, -1e-38F};
  std::mt19937 random(seed);
  const auto grid = openvdb::FloatGrid::create(3);
  auto accessor = grid->getAccessor();
  const openvdb::Coord first(6, 6, 1);
  for (int n = 0; n < 64; ++n) {
    accessor.setValue(first.offsetBy(n / 16, n / 4 % 4, n % 4), kValues[random() % kValues.size()]);
  }
  return grid;
}

struct Kept {
  std::size_t whole = 0;   ///< closed, manifold meshes of all chunks
  std::size_t within = 0;  ///< levels of chunks within their tolerance
  std::size_t levels = 0;  ///< levels of chunks
};

Kept keptBy(const openvdb::FloatGrid& grid, bool repair) {
  ChunkOptions options;
  options.chunkSize = 8;
  options.levels = 2;
  options.contour.tolerance = 0.5;
  options.contour.cap = true;
  options.contour.repair = repair;
  std::vector<Chunk> chunks;
  const ChunkIndex index = buildChunks(
      grid, options, [&](const ChunkIndex&, Chunk&& chunk) { chunks.push_back(std::move(chunk)); });
  Kept kept;
  for (const Chunk& chunk : chunks) {
    for (std::size_t i = 0; i < chunk.levels.size(); ++i, ++kept.levels) {
      constexpr double kMoved = 0.02;  // vertices near planes between chunks are moved to them
      if (chunk.levels[i].maxErrorVoxels <= index.tolerances[i] + kMoved) ++kept.within;
    }
  }
  for (std::size_t level = 0; level < 2; ++level) {
    const Mesh mesh = assembleChunks(chunks, std::vector<std::size_t>(chunks.size(), level));
    const test::MeshTopology found = test::inspect(mesh);
    if (found.manifold() && (found.closed() || chunks.empty())) ++kept.whole;
  }
  return kept;
}

// Without it two vertices of a curve came to lie at one place, which joined them in the mesh of all
// chunks, and errors were over the tolerance.
TEST(ChunkRepair, IsMadeWhateverIsAskedFor) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    const openvdb::FloatGrid::Ptr grid = roughGrid(seed);
    for (const bool repair : {true, false}) {
      const Kept kept = keptBy(*grid, repair);
      EXPECT_EQ(kept.whole, 2u) << "seed " << seed << ", repair " << repair;
      EXPECT_EQ(kept.within, kept.levels) << "seed " << seed << ", repair " << repair;
    }
  }
}

// Rounding takes vertices of one plate through another one, and along the edges of plates both
// sides are joined by strips without width.
TEST(ChunksOfPlates, KeepTheirTolerancesAndMakeNoFolds) {
  for (const unsigned seed : {0U, 1U, 2U, 3U, 4U, 5U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string text = test::randomPlates(seed);
    VoxelizeOptions voxels;
    voxels.voxelSize = 0.045;
    const auto grid = voxelize(*implicit::readScene(FileBytes{text, "plates"}).field, voxels);
    ChunkOptions options;
    options.chunkSize = 16;
    options.levels = 2;
    const test::Made made = test::makeChunks(*grid, options);
    test::expectTolerancesKept(made);
    const std::size_t folds = test::foldedEdges(test::uniformMesh(*grid), voxels.voxelSize);
    for (std::size_t level = 0; level < 2; ++level) {
      const std::vector<std::size_t> lods(made.chunks.size(), level);
      EXPECT_LE(test::foldedEdges(assembleChunks(made.chunks, lods), voxels.voxelSize), folds);
    }
  }
}

}  // namespace
}  // namespace tufa
