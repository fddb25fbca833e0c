// White noise meets every configuration of cells there is: whatever holds on it holds anywhere.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

using openvdb::FloatGrid;

const char* nameOf(Ambiguity rule) {
  switch (rule) {
    case Ambiguity::Separate:
      return "Separate";
    case Ambiguity::Join:
      return "Join";
    case Ambiguity::Asymptotic:
      return "Asymptotic";
    case Ambiguity::Original:  // refused
    case Ambiguity::Chord:
      break;
  }
  return "Chord";
}

Mesh meshOf(const openvdb::GridBase& grid, Ambiguity rule, int threads,
            ContourReport* report = nullptr, bool repair = true) {
  ContourOptions options;
  options.isovalue = 0;
  options.inside = Inside::Below;
  options.ambiguity = rule;
  options.threads = threads;
  options.repair = repair;
  return tufa::test::uniformMesh(grid, options, report);
}

/// A closed, oriented 2-manifold in both senses, as quads and as the triangles that programs see.
void expectManifold(const Mesh& mesh) {
  for (const Mesh& faces : {mesh, test::triangulated(mesh)}) {
    const test::MeshTopology topology = test::inspect(faces);
    EXPECT_EQ(topology.boundaryEdges, 0U);
    EXPECT_EQ(topology.nonManifoldEdges, 0U);
    EXPECT_EQ(topology.nonManifoldVertices, 0U);
    EXPECT_EQ(topology.misorientedEdges, 0U);
    EXPECT_EQ(topology.duplicateFaces, 0U);
    EXPECT_EQ(topology.collapsedFaces, 0U);
    EXPECT_EQ(topology.unusedVertices, 0U);
    EXPECT_GT(topology.faces, 10000U);
  }
}

class Noise : public ::testing::TestWithParam<std::tuple<Ambiguity, std::uint32_t>> {};
INSTANTIATE_TEST_SUITE_P(Rules, Noise,
                         ::testing::Combine(::testing::Values(Ambiguity::Separate, Ambiguity::Join,
                                                              Ambiguity::Asymptotic,
                                                              Ambiguity::Chord),
                                            ::testing::Values(1U, 2U, 3U)),
                         [](const auto& test) {
                           return std::string(nameOf(std::get<0>(test.param))) +
                                  std::to_string(std::get<1>(test.param));
                         });

TEST_P(Noise, GivesAClosedManifoldAndTheSameBytesForAnyThreads) {
  const auto [rule, seed] = GetParam();
  const auto grid = test::noise<FloatGrid>({.size = 40, .seed = seed});
  const bool repair = seed == 1;  // takes most of the time
  ContourReport one, two;
  const Mesh mesh = meshOf(*grid, rule, 1, &one, repair);
  expectManifold(mesh);
  EXPECT_TRUE(test::sameBytes(mesh, meshOf(*grid, rule, 2, &two, repair)));
  EXPECT_GT(one.faceFlips, 0U);
  EXPECT_EQ(one.faceFlips, two.faceFlips);
  EXPECT_EQ(one.surfaceCells, two.surfaceCells);
}

TEST(NoiseOrder, OfInsertionDoesNotChangeTheMesh) {
  const auto grid = test::noise<FloatGrid>({.size = 40, .seed = 9});
  std::vector<openvdb::Coord> origins;
  for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) origins.push_back(leaf->origin());
  const Mesh mesh = meshOf(*grid, Ambiguity::Separate, 0);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    std::shuffle(origins.begin(), origins.end(), random);
    auto shuffled = FloatGrid::create(grid->background());
    for (const openvdb::Coord& origin : origins) {
      shuffled->tree().addLeaf(
          new FloatGrid::TreeType::LeafNodeType(*grid->tree().probeConstLeaf(origin)));
    }
    EXPECT_TRUE(test::sameBytes(mesh, meshOf(*shuffled, Ambiguity::Separate, 0)));
  }
}

TEST(NoiseTrees, OfLeavesAndTilesGiveClosedManifolds) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const auto grid = test::randomTree<openvdb::DoubleGrid>({.seed = seed, .blocks = 6});
    for (const Ambiguity rule : {Ambiguity::Separate, Ambiguity::Join}) {
      const test::MeshTopology topology = test::inspect(meshOf(*grid, rule, 0));
      EXPECT_TRUE(topology.manifold() && topology.closed()) << seed << " " << topology;
    }
  }
}

}  // namespace
}  // namespace tufa
