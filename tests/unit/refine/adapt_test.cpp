#include "refine/adapt.h"

#include <gtest/gtest.h>

#include <tufa/octree.h>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "refine/split_cells.h"
#include "support/mesh_oracle.h"
#include "support/model.h"
#include "unit/refine/ring.h"

namespace tufa::refine {
namespace {

using test_ring::expectRing;
using test_ring::kVoxel;
using test_ring::ring;

struct Adapted {
  test::ModelOf model{ring()};
  std::optional<Repair> repair = model.model().repair(model.job());

  AdaptiveMesh cut(double tolerance) {
    octree::CutRule rule = model.rule();
    rule.tolerance = tolerance;
    return adapt(model.model(), rule, {&*repair}, model.job());
  }
};

TEST(Adapt, KeepsTheRuleAndTheTopology) {
  Adapted ring;
  for (const double tolerance : {0.05, 0.3}) {
    const AdaptiveMesh adaptive = ring.cut(tolerance);
    EXPECT_LE(adaptive.largestError, tolerance);
    EXPECT_GT(adaptive.largestError, 0);
    EXPECT_LT(adaptive.meanError, adaptive.largestError);
    expectRing(adaptive.extracted.mesh);
  }
}

TEST(Adapt, CutsARestrictedOctree) {
  Adapted ring;
  const AdaptiveMesh adaptive = ring.cut(0.3);
  EXPECT_TRUE(isRestricted(adaptive.leaves));
  // A vertex for each leaf of one patch.
  EXPECT_GE(adaptive.extracted.mesh.positions.size(), adaptive.leaves.size());
  EXPECT_LT(adaptive.leaves.size(), ring.model.mesh().positions.size() / 4);
}

TEST(Adapt, SaysWhereVerticesAndPolygonsComeFrom) {
  Adapted ring;
  const Mesh& base = ring.model.mesh();
  const ExtractedMesh extracted = ring.cut(0.05).extracted;
  ASSERT_EQ(extracted.baseVertices.size(), extracted.mesh.positions.size());
  ASSERT_EQ(extracted.baseQuads.size(),
            extracted.mesh.quads.size() + extracted.mesh.triangles.size());
  for (std::size_t i = 0; i < extracted.baseVertices.size(); ++i) {
    if (extracted.baseVertices[i] == octree::kNone) continue;
    EXPECT_EQ(extracted.mesh.positions[i], base.positions[extracted.baseVertices[i]]);
  }
  for (const std::uint32_t quad : extracted.baseQuads) EXPECT_LT(quad, base.quads.size());
}

TEST(CertificateOf, CountsLeavesByLevelAndMeasuresInTheWorld) {
  AdaptiveMesh adaptive;
  adaptive.largestError = 0.25;
  adaptive.meanError = 0.125;
  adaptive.rounds = 3;
  adaptive.leaves = {{Coord(0), 0}, {Coord(8, 0, 0), 2}, {Coord(1, 0, 0), 0}};
  // A tetrahedron.
  adaptive.extracted.mesh.positions.resize(4, Position(0, 0, 0));
  adaptive.extracted.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const Certificate without = certificateOf(adaptive, kVoxel, false);
  EXPECT_EQ(without.maxErrorVoxels, 0.25);
  EXPECT_EQ(without.meanErrorVoxels, 0.125);
  EXPECT_EQ(without.maxErrorWorld, 0.125);
  EXPECT_EQ(without.rounds, 3);
  EXPECT_EQ(without.eulerCharacteristic, 2);
  EXPECT_EQ(without.leafLevels, (std::vector<std::size_t>{2, 0, 1}));
  EXPECT_TRUE(without.leaves.empty());
  EXPECT_EQ(certificateOf(adaptive, kVoxel, true).leaves.size(), 3U);
}

TEST(TooCoarse, AreTheVerticesThatStandForWhatIsFar) {
  Mesh base;
  base.positions.resize(6, Position(0, 0, 0));
  base.quads = {Quad(0, 1, 2, 3), Quad(2, 3, 4, 5)};
  octree::Cut cut;
  cut.vertexOf = {10, 11, 12, 13, 14, 15};
  distance::Deviation deviation;
  deviation.coarse = {20};
  deviation.farPoints = {1, 6 + 1};  // a vertex, and the middle of the second quad
  EXPECT_EQ(tooCoarse(base, cut, deviation), (std::vector<VertexIndex>{20, 11, 12, 13, 14, 15}));
}

}  // namespace
}  // namespace tufa::refine
