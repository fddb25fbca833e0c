// LODs of a cut mesh, and what stands for their curves beside the next one.

#include "chunks/chain/chunk_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "chunks/chain/mixed_forms.h"
#include "chunks/chain/split_level.h"
#include "support/mesh_oracle.h"
#include "unit/refine/ring.h"

namespace tufa::chunks {
namespace {

constexpr int kSize = 16;

struct Chain {
  test::ModelOf model{refine::test_ring::ring()};
  CutMesh cut = cutAtChunks(model.mesh(), model.model().affine(), kSize, true, 0, model.job());
  ChunkChain chain{cut, model.model().affine(), model.rule(), kSize, true, model.job()};
  std::vector<ChainLevel> levels;

  void make(double tolerance) {
    ChainLevel level = chain.next(tolerance, levels.empty() ? nullptr : &levels.back());
    levels.push_back(std::move(level));
  }
};

Mesh meshOf(const ChainLevel& level, bool isChanged) {
  Mesh mesh;
  mesh.positions = level.positions;
  for (const Triangle& t : level.triangles) {
    const Triangle form = isChanged ? changed(level, t) : t;
    if (!isGone(form)) mesh.triangles.push_back(form);
  }
  return mesh;
}

TEST(ChunkChain, KeepsEachLevelWholeInBothForms) {
  Chain chain;
  for (const double tolerance : {0.05, 0.2, 0.8}) chain.make(tolerance);
  std::size_t before = chain.cut.mesh.triangles.size();
  for (std::size_t k = 0; k < 3; ++k) {
    const ChainLevel& level = chain.levels[k];
    const double tolerances[] = {0.05, 0.2, 0.8, 0.8};
    EXPECT_LT(level.triangles.size(), before / 2) << k;
    before = level.triangles.size();
    for (const double error : level.errors) EXPECT_LE(error, tolerances[k]);
    for (const double error : level.transitionErrors) EXPECT_LE(error, tolerances[k + 1]);
    for (const bool isChanged : {false, true}) {
      const test::MeshTopology topology = test::inspect(meshOf(level, isChanged));
      EXPECT_EQ(topology.boundaryEdges + topology.nonManifoldEdges + topology.duplicateFaces, 0U)
          << k;
      EXPECT_EQ(topology.components, 1U);
    }
  }
}

// The curve of a level beside the next one is the next one's own, vertex by vertex.
TEST(ChunkChain, PassesOnTheCurvesOfTheNextLevel) {
  Chain chain;
  for (const double tolerance : {0.05, 0.4}) chain.make(tolerance);
  const ChainLevel &fine = chain.levels[0], &coarse = chain.levels[1];
  std::set<VertexIndex> changedInto, own;
  std::size_t changes = 0, beside = 0, moved = 0;
  for (VertexIndex v = 0; v < fine.own; ++v) {
    EXPECT_EQ(fine.into[fine.into[v]], fine.into[v]);
    EXPECT_EQ(fine.into[v] != v, fine.intoPlane[v] != ChunkPlane::kNone);
    if (fine.cutVertex[v] == ChainLevel::kNone) {
      beside += fine.into[v] != v ? 1 : 0;
      continue;
    }
    changes += fine.into[v] != v ? 1 : 0;
    changedInto.insert(fine.curveVertex[fine.into[v]]);
  }
  for (VertexIndex v = 0; v < coarse.positions.size(); ++v) {
    if (coarse.cutVertex[v] == ChainLevel::kNone) continue;
    own.insert(coarse.curveVertex[v]);
    const auto same =
        std::find(fine.curveVertex.begin(), fine.curveVertex.end(), coarse.curveVertex[v]) -
        fine.curveVertex.begin();
    ASSERT_LT(same, std::ssize(fine.positions));
    EXPECT_EQ(fine.positions[static_cast<std::size_t>(same)], coarse.positions[v]);
    moved += static_cast<std::size_t>(same) < fine.own ? 0 : 1;
  }
  EXPECT_EQ(changedInto, own);
  EXPECT_GT(moved, 5U);
  EXPECT_EQ(moved, fine.positions.size() - fine.own);
  EXPECT_GT(changes, 10U);
  EXPECT_GT(beside, 10U);
}

TEST(ChunkChain, ChangesATriangleInOnePlaneAtATime) {
  Chain chain;
  for (const double tolerance : {0.05, 0.8, 3.0}) chain.make(tolerance);
  for (const ChainLevel& level : chain.levels) {
    for (const Triangle& t : level.triangles) {
      bool isMixed = false;
      (void)changingPlane(level, t, isMixed);
      EXPECT_FALSE(isMixed);
    }
    EXPECT_TRUE(findMixedForms(level, chain.model.job()).empty());
  }
}

// Triangles in one plane beside one of another that they would cross once they change.
TEST(MixedForms, AreFoundWhereTrianglesOfTwoPlanesWouldMeet) {
  ChainLevel level;
  level.positions = {{0, 1, 0}, {0, 9, 0}, {2, 0, -1}, {9, 0, 0},
                     {4, 1, 0}, {4, 9, 0}, {2, 3, 1},  {2, 8, 2}};
  level.cutVertex = {
      0, 1, 2, 3, ChainLevel::kNone, ChainLevel::kNone, ChainLevel::kNone, ChainLevel::kNone};
  level.triangles = {{1, 4, 5}, {2, 6, 7}};  // once 1 goes to 0, its triangle crosses the other's
  level.chunkOf = {0, 0};
  level.into = {0, 0, 3, 3, 4, 5, 6, 7};
  constexpr auto kNone = ChunkPlane::kNone;
  level.intoPlane = {kNone, 0, 1, kNone, kNone, kNone, kNone, kNone};
  base::Job job(1, {});
  using Pair = std::array<std::uint32_t, 2>;
  EXPECT_EQ(findMixedForms(level, job), (std::vector<Pair>{{0, 1}}));
  level.into[1] = 1;
  EXPECT_TRUE(findMixedForms(level, job).empty());
}

TEST(SplitLevel, GivesEachTriangleToOnePartOfItsChunk) {
  Chain chain;
  for (const double tolerance : {0.05, 0.4}) chain.make(tolerance);
  const ChainLevel& level = chain.levels[0];
  base::Job& job = chain.model.job();
  const CurveNormals curves(chain.levels, 180, job);
  const std::vector<ChunkLevel> chunks =
      splitLevel(chain.chain.cut(), level, shade(level, curves, 180, {}, job), job);
  ASSERT_EQ(chunks.size(), chain.chain.cut().chunks.size());
  std::size_t own = 0, strips = 0, other = 0;
  for (const ChunkLevel& chunk : chunks) {
    own += chunk.interior.size();
    for (std::size_t face = 0; face < kChunkFaces; ++face) {
      strips += chunk.regular[face].size();
      other += chunk.transition[face].size();
      EXPECT_LE(chunk.transition[face].size(), chunk.regular[face].size());
      EXPECT_TRUE(chunk.regular[face].empty() || !chunk.seams[face].empty());
    }
    EXPECT_EQ(chunk.normals.size(), chunk.positions.size());
  }
  EXPECT_EQ(own + strips, level.triangles.size());
  EXPECT_GT(strips, other);
  EXPECT_GT(other, 0U);
}

}  // namespace
}  // namespace tufa::chunks
