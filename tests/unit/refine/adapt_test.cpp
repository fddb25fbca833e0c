#include "refine/adapt.h"

#include <gtest/gtest.h>

#include <tufa/octree.h>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/mesh_oracle.h"
#include "support/model.h"
#include "support/nearest_triangle.h"
#include "unit/refine/ring.h"

namespace tufa::refine {
namespace {

using test_ring::expectRing;
using test_ring::kVoxel;
using test_ring::ring;

struct Adapted {
  test::ModelOf model{ring()};

  AdaptiveMesh cut(double tolerance) {
    octree::CutRule rule = model.rule();
    rule.tolerance = tolerance;
    return adapt(model.model(), rule, false, model.job());
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

// Cells that may not be split are measured all the same.
TEST(Adapt, SaysHowFarCellsAreThatItMayNotSplit) {
  Adapted ring;
  octree::CutRule rule = ring.model.rule();
  rule.tolerance = 0.02;
  rule.minLevel = 2;
  const AdaptiveMesh adaptive = adapt(ring.model.model(), rule, false, ring.model.job());
  const Mesh& mesh = adaptive.extracted.mesh;
  const double far = std::max(test::largestDistance(ring.model.mesh(), mesh, kVoxel),
                              test::largestDistance(mesh, ring.model.mesh(), kVoxel));
  EXPECT_GT(far / kVoxel, rule.tolerance);
  EXPECT_GE(1.005 * adaptive.largestError + 0.0005, far / kVoxel);
  EXPECT_LT(adaptive.largestError, 1.5 * far / kVoxel);
  expectRing(mesh);
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
  base::Job job(1, {});
  const Certificate without = certificateOf(adaptive, kVoxel, false, job);
  EXPECT_EQ(without.maxErrorVoxels, 0.25);
  EXPECT_EQ(without.meanErrorVoxels, 0.125);
  EXPECT_EQ(without.maxErrorWorld, 0.125);
  EXPECT_EQ(without.rounds, 3);
  EXPECT_EQ(without.eulerCharacteristic, 2);
  EXPECT_EQ(without.leafLevels, (std::vector<std::size_t>{2, 0, 1}));
  EXPECT_TRUE(without.leaves.empty());
  EXPECT_EQ(certificateOf(adaptive, kVoxel, true, job).leaves.size(), 3U);
}

}  // namespace
}  // namespace tufa::refine
