// Chunks put together at any levels, by hand-made ones.

#include <gtest/gtest.h>

#include <tufa/chunks.h>
#include <array>
#include <set>
#include <utility>

#include "support/expect_error.h"
#include "support/mesh_oracle.h"
#include "unit/chunks/hand_made.h"

namespace tufa {
namespace {

using test::inspect;
using test::makeDrum;
using test::makeSheet;

TEST(AssembleChunks, ClosesAcrossAFaceAtAnyTwoLevels) {
  const std::vector<Chunk> drum = makeDrum();
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      const Mesh mesh = assembleChunks(drum, {a, b});
      const test::MeshTopology topology = inspect(mesh);
      EXPECT_TRUE(topology.manifold() && topology.closed()) << a << " beside " << b << topology;
      EXPECT_EQ(topology.euler(), 2) << a << " beside " << b;
      EXPECT_GT(test::volume(mesh), 0) << a << " beside " << b;
      EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    }
  }
}

TEST(AssembleChunks, ClosesAroundAChunkEdgeAtAnyFourLevels) {
  const std::vector<Chunk> sheet = makeSheet();
  for (std::size_t code = 0; code < 81; ++code) {
    const Mesh mesh = assembleChunks(sheet, {code / 27, code / 9 % 3, code / 3 % 3, code % 3});
    const test::MeshTopology topology = inspect(mesh);
    EXPECT_TRUE(topology.manifold()) << code << topology;
    EXPECT_EQ(topology.components, 1u) << code;
    EXPECT_EQ(topology.euler(), 1) << code << topology;  // one rim and no hole
  }
}

// Beside a chunk that is coarser by two, each edge of its curve has a triangle more, to the vertex
// of the curve between.
TEST(AssembleChunks, FillsTheFaceBetweenDistantLevels) {
  std::vector<Chunk> drum = makeDrum();
  const std::size_t whole = assembleChunks(drum, {0, 1}).triangles.size();
  const std::size_t far = assembleChunks(drum, {0, 2}).triangles.size();
  EXPECT_EQ(whole, drum[0].levels[0].interior.size() + drum[0].levels[0].transition[1].size() +
                       drum[1].levels[1].interior.size() + drum[1].levels[1].regular[0].size());
  EXPECT_EQ(far, drum[0].levels[0].interior.size() + drum[0].levels[0].transition[1].size() + 3 +
                     drum[1].levels[2].interior.size() + drum[1].levels[2].regular[0].size());
}

// The coarsest level's curve is at none of the places, or at one of the places, of that before it.
TEST(AssembleChunks, FillsTheFaceWhereCurvesHaveMoved) {
  for (const std::size_t kept : {0U, 1U}) {
    std::vector<Chunk> drum = makeDrum();
    std::set<std::array<double, 3>> stay;
    for (Chunk& chunk : drum) {
      const std::size_t face = chunk.index[0] == 0 ? 1 : 0;
      const auto move = [&](Position& p) {
        if (p.x != 8 || stay.contains({p.x, p.y, p.z})) return;
        if (stay.size() < kept) {
          stay.insert({p.x, p.y, p.z});
        } else {
          p.y += 0.1 * (4 - p.y), p.z += 0.1 * (4 - p.z);
        }
      };
      for (const VertexIndex v : chunk.levels[2].seams[face][0].vertices) {
        move(chunk.levels[2].positions[v]);
      }
      for (Position& p : chunk.levels[2].seams[face][0].next) move(p);
      for (Position& p : chunk.levels[1].seams[face][0].next) move(p);
    }
    for (const auto& lods : {std::vector<std::size_t>{0, 2}, std::vector<std::size_t>{2, 0}}) {
      const test::MeshTopology topology = inspect(assembleChunks(drum, lods));
      EXPECT_TRUE(topology.manifold() && topology.closed()) << kept << topology;
      EXPECT_EQ(topology.euler(), 2) << kept;
    }
  }
}

TEST(AssembleChunks, RefusesSeamsThatLeadNowhere) {
  std::vector<Chunk> drum = makeDrum();
  drum[0].levels[1].seams[1][0].next[0].y += 1;
  test::expectError(ErrorCode::InvalidArgument, "do not lead to", [&] {
    static_cast<void>(assembleChunks(drum, {0, 2}));
  });
}

TEST(AssembleChunks, RefusesIndicesThatPointNowhere) {
  const auto refused = [](const auto& damage) {
    std::vector<Chunk> drum = makeDrum();
    damage(drum[0].levels[1]);
    test::expectError(ErrorCode::InvalidArgument, "is not sound at level 1", [&] {
      static_cast<void>(assembleChunks(drum, {1, 1}));
    });
    test::expectError(ErrorCode::InvalidArgument, "is not sound at level 1",
                      [&] { static_cast<void>(meshForMask(drum[0], 1, 0)); });
  };
  refused([](ChunkLevel& level) { level.interior[0].vertices[1] = 1000000; });
  refused([](ChunkLevel& level) { level.regular[1].emplace_back(0, 1, 1000000); });
  refused([](ChunkLevel& level) { level.seams[1][0].vertices[0] = 1000000; });
  refused([](ChunkLevel& level) { level.seams[1][0].vertices.resize(1); });
  refused([](ChunkLevel& level) { level.normals.pop_back(); });
}

TEST(AssembleChunks, LeavesChunksOpenWhoseNeighboursAreMissing) {
  std::vector<Chunk> drum = makeDrum();
  drum.pop_back();
  const test::MeshTopology topology = inspect(assembleChunks(drum, {1}));
  EXPECT_TRUE(topology.manifold());
  EXPECT_FALSE(topology.closed());
  EXPECT_TRUE(assembleChunks({}, {}).positions.empty());
}

TEST(AssembleChunks, NeedsSeamsForDistantLevelsOnly) {
  std::vector<Chunk> drum = makeDrum();
  for (Chunk& chunk : drum) {
    for (ChunkLevel& level : chunk.levels) level.seams = {};
  }
  EXPECT_TRUE(inspect(assembleChunks(drum, {1, 2})).closed());
  test::expectError(ErrorCode::InvalidArgument, "chunk (0, 0, 0) has no seams", [&] {
    static_cast<void>(assembleChunks(drum, {0, 2}));
  });
}

// A drum of four levels, the second and third of which have the same curve: the second has no
// strips.
std::vector<Chunk> makeDrumOfOneCurveTwice() {
  std::vector<Chunk> drum = makeDrum();
  for (Chunk& chunk : drum) {
    chunk.levels.insert(chunk.levels.begin() + 1, chunk.levels[1]);
    ChunkLevel& level = chunk.levels[1];
    for (std::size_t face = 0; face < kChunkFaces; ++face) {
      const std::vector<Triangle> strip = std::exchange(level.regular[face], {});
      level.interior.insert(level.interior.end(), strip.begin(), strip.end());
      level.transition[face].clear();
      for (ChunkSeam& seam : level.seams[face]) {
        for (std::size_t n = 0; n < seam.next.size(); ++n) {
          seam.next[n] = level.positions[seam.vertices[n]];
        }
      }
    }
  }
  return drum;
}

TEST(AssembleChunks, NeedsSeamsWhereCurvesDifferBeyondALevelWithoutStrips) {
  std::vector<Chunk> drum = makeDrumOfOneCurveTwice();
  EXPECT_TRUE(inspect(assembleChunks(drum, {0, 3})).closed());
  for (Chunk& chunk : drum) {
    for (ChunkLevel& level : chunk.levels) level.seams = {};
  }
  test::expectError(ErrorCode::InvalidArgument, "chunk (0, 0, 0) has no seams", [&] {
    static_cast<void>(assembleChunks(drum, {0, 3}));
  });
  test::expectError(ErrorCode::InvalidArgument, "chunk (1, 0, 0) has no seams", [&] {
    static_cast<void>(assembleChunks(drum, {3, 1}));
  });
}

TEST(AssembleChunks, NeedsNoSeamsWhereCurvesAreTheSame) {
  std::vector<Chunk> drum = makeDrumOfOneCurveTwice();
  drum[0].levels[2].seams = {};
  EXPECT_TRUE(inspect(assembleChunks(drum, {0, 2})).closed());
}

TEST(AssembleChunks, RefusesLevelsThatDoNotFit) {
  const std::vector<Chunk> drum = makeDrum();
  test::expectError(ErrorCode::InvalidArgument, "1 levels for 2 chunks",
                    [&] { static_cast<void>(assembleChunks(drum, {0})); });
  test::expectError(ErrorCode::InvalidArgument, "no level 3", [&] {
    static_cast<void>(assembleChunks(drum, {0, 3}));
  });
  test::expectError(ErrorCode::InvalidArgument, "there twice", [&] {
    static_cast<void>(assembleChunks({drum[0], drum[0]}, {0, 0}));
  });
}

TEST(MeshForMask, DrawsOneStripForEachFace) {
  const std::vector<Chunk> sheet = makeSheet();
  const Chunk& chunk = sheet[0];
  const ChunkLevel& level = chunk.levels[0];
  for (const unsigned mask : {0u, 2u, 8u, 10u}) {
    const Mesh mesh = meshForMask(chunk, 0, mask);
    std::size_t triangles = level.interior.size();
    for (std::size_t face = 0; face < kChunkFaces; ++face) {
      triangles += ((mask >> face & 1u) != 0 ? level.transition : level.regular)[face].size();
    }
    EXPECT_EQ(mesh.triangles.size(), triangles) << mask;
    EXPECT_EQ(inspect(mesh).unusedVertices, 0u) << mask;
    EXPECT_TRUE(inspect(mesh).manifold()) << mask;
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  }
}

TEST(MeshForMask, RefusesStripsThatThereAreNot) {
  const Chunk chunk = makeDrum()[0];
  test::expectError(ErrorCode::InvalidArgument, "no level 3",
                    [&] { static_cast<void>(meshForMask(chunk, 3, 0)); });
  test::expectError(ErrorCode::InvalidArgument, "no strips for mask 2 at level 2",
                    [&] { static_cast<void>(meshForMask(chunk, 2, 2)); });
  test::expectError(ErrorCode::InvalidArgument, "mask 64",
                    [&] { static_cast<void>(meshForMask(chunk, 0, 64)); });
}

}  // namespace
}  // namespace tufa
