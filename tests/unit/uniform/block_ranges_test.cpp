#include "uniform/block_ranges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/fields.h"
#include "support/model.h"

namespace tufa::uniform {
namespace {

// Rising numbers below `count`, about one in `step`.
std::vector<std::uint32_t> someOf(std::size_t count, unsigned step, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (random() % step == 0) some.push_back(i);
  }
  return some;
}

TEST(BlockRanges, CoverAListInOrder) {
  test::ModelOf model(test::ballOf(20, 1));
  const CellTopology& topology = model.model().surface().topology;
  ASSERT_GT(topology.blocks.size(), 20U);
  for (const unsigned step : {1U, 3U, 500U}) {
    const auto vertices = someOf(topology.vertexCount, step, 1);
    std::size_t next = 0;
    for (const BlockRange& range : blocksOfVertices(topology, vertices)) {
      const SurfaceBlock& block = topology.blocks[range.block];
      EXPECT_EQ(range.begin, next);
      EXPECT_LT(range.begin, range.end);
      EXPECT_GE(vertices[range.begin], block.firstVertex);
      EXPECT_LT(vertices[range.end - 1], block.firstVertex + block.cellCount);
      next = range.end;
    }
    EXPECT_EQ(next, vertices.size());
    const auto quads = someOf(topology.quadCount, step, 2);
    next = 0;
    for (const BlockRange& range : blocksOfQuads(topology, quads)) {
      const SurfaceBlock& block = topology.blocks[range.block];
      EXPECT_EQ(range.begin, next);
      EXPECT_GE(quads[range.begin], block.firstQuad);
      EXPECT_LT(quads[range.end - 1], block.firstQuad + block.quadCount);
      next = range.end;
    }
    EXPECT_EQ(next, quads.size());
  }
  EXPECT_TRUE(blocksOfVertices(topology, {}).empty());
}

TEST(QuadsAt, AreThoseWithAVertex) {
  test::ModelOf model(test::ballOf(20, 1));
  const CellTopology& topology = model.model().surface().topology;
  const Mesh& mesh = model.mesh();
  for (const unsigned step : {1U, 10U, 1000U}) {
    const auto vertices = someOf(mesh.positions.size(), step, step);
    ASSERT_FALSE(vertices.empty());
    std::vector<std::uint8_t> marks(mesh.positions.size(), 0);
    for (const VertexIndex vertex : vertices) marks[vertex] = 1;
    std::vector<std::uint32_t> expected;
    for (std::uint32_t quad = 0; quad < mesh.quads.size(); ++quad) {
      const auto& v = mesh.quads[quad].vertices;
      if (std::any_of(v.begin(), v.end(), [&](VertexIndex at) { return marks[at] != 0; }))
        expected.push_back(quad);
    }
    EXPECT_EQ(quadsAt(topology, mesh, vertices, marks, model.job()), expected);
  }
}

}  // namespace
}  // namespace tufa::uniform
