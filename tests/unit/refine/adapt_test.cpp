#include "refine/adapt.h"

#include <gtest/gtest.h>

#include <tufa/octree.h>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "refine/split_cells.h"
#include "support/mesh_oracle.h"
#include "support/model.h"

namespace tufa::refine {
namespace {

constexpr double kVoxel = 0.5;

// A ring that needs cells of several sizes.
openvdb::FloatGrid::Ptr ring() {
  return test::levelSetOf(26, kVoxel, [](const Vec3& p) {
    return std::hypot(std::hypot(p[0], p[1]) - 14.3, p[2]) - 6.2;
  });
}

struct Adapted {
  test::ModelOf model{ring()};
  std::optional<Repair> repair = model.model().repair(model.job());
  Measured kept;

  AdaptiveMesh cut(double tolerance, bool simplify, Goal goal = {}) {
    octree::CutRule rule = model.rule();
    rule.tolerance = tolerance;
    return adapt(model.model(), rule, {&*repair, simplify, std::move(goal)}, model.job(), &kept);
  }
};

void expectRing(const Mesh& mesh) {
  const test::MeshTopology topology = test::inspect(test::triangulated(mesh));
  EXPECT_TRUE(topology.closed() && topology.manifold()) << topology;
  EXPECT_EQ(topology.euler(), 0);
  EXPECT_EQ(topology.components, 1U);
}

TEST(Adapt, KeepsTheRuleAndTheTopology) {
  Adapted ring;
  for (const double tolerance : {0.05, 0.3}) {
    for (const bool simplify : {false, true}) {
      const AdaptiveMesh adaptive = ring.cut(tolerance, simplify);
      EXPECT_LE(adaptive.largestError, tolerance);
      EXPECT_GT(adaptive.largestError, 0);
      EXPECT_LT(adaptive.meanError, adaptive.largestError);
      expectRing(adaptive.extracted.mesh);
    }
  }
}

TEST(Adapt, CutsARestrictedOctree) {
  Adapted ring;
  const AdaptiveMesh adaptive = ring.cut(0.3, false);
  EXPECT_TRUE(isRestricted(adaptive.leaves));
  // A vertex for each leaf of one patch.
  EXPECT_GE(adaptive.extracted.mesh.positions.size(), adaptive.leaves.size());
  EXPECT_LT(adaptive.leaves.size(), ring.model.mesh().positions.size() / 4);
}

TEST(Adapt, HasFewerTrianglesWhereEdgesAreCollapsed) {
  Adapted ring;
  const std::size_t cut = ring.cut(0.3, false).extracted.mesh.triangleCount();
  EXPECT_LT(ring.cut(0.3, true).extracted.mesh.triangleCount(), cut);
}

TEST(Adapt, SaysWhereVerticesAndPolygonsComeFrom) {
  Adapted ring;
  const Mesh& base = ring.model.mesh();
  for (const bool simplify : {false, true}) {
    const ExtractedMesh extracted = ring.cut(0.05, simplify).extracted;
    ASSERT_EQ(extracted.baseVertices.size(), extracted.mesh.positions.size());
    ASSERT_EQ(extracted.baseQuads.size(),
              extracted.mesh.quads.size() + extracted.mesh.triangles.size());
    for (std::size_t i = 0; i < extracted.baseVertices.size(); ++i) {
      if (extracted.baseVertices[i] == octree::kNone) continue;
      EXPECT_EQ(extracted.mesh.positions[i], base.positions[extracted.baseVertices[i]]);
    }
    for (const std::uint32_t quad : extracted.baseQuads) EXPECT_LT(quad, base.quads.size());
  }
}

TEST(Adapt, StopsAtANumberOfTriangles) {
  Adapted ring;
  Goal goal;
  goal.triangles = 500;
  const AdaptiveMesh adaptive = ring.cut(0.1, true, goal);
  EXPECT_LE(adaptive.extracted.mesh.triangleCount(), 500U);
  EXPECT_GT(adaptive.extracted.mesh.triangleCount(), 400U);
  EXPECT_LE(adaptive.largestError, 1) << "voxels, of a tube six thick";
  expectRing(adaptive.extracted.mesh);
}

TEST(Coarsen, GoesOnFromAFinerMesh) {
  Adapted ring;
  const std::size_t fine = ring.cut(0.05, true).extracted.mesh.triangleCount();
  octree::CutRule rule = ring.model.rule();
  for (const double tolerance : {0.2, 0.6}) {
    rule.tolerance = tolerance;
    const AdaptiveMesh coarse =
        coarsen(ring.model.model(), rule, {&*ring.repair, true}, ring.model.job(), ring.kept);
    EXPECT_LE(coarse.largestError, tolerance);
    EXPECT_LT(coarse.extracted.mesh.triangleCount(), fine / 2);
    EXPECT_TRUE(coarse.leaves.empty());
    expectRing(coarse.extracted.mesh);
  }
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
