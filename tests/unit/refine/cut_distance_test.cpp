#include "refine/cut_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree/leaves.h"
#include "refine/split_cells.h"
#include "support/mesh_oracle.h"
#include "support/model.h"
#include "support/nearest_triangle.h"
#include "unit/refine/ring.h"

namespace tufa::refine {
namespace {

using test_ring::kVoxel;

octree::CutRule ruleOf(double tolerance) {
  octree::CutRule rule;
  rule.tolerance = tolerance;
  return rule;
}

LocalFrame frameOf(test::ModelOf& model) {
  return {model.model().mesh().positions, model.model().affine().voxelSize(), model.job()};
}

// A ball, its uniform mesh as a cut, and vertices of it that are elsewhere.
struct Ball {
  test::ModelOf model{test::ballOf(10.3, kVoxel)};
  test::MeshOfCut mesh = model.uniformCut();
  std::vector<std::uint8_t> changed = std::vector<std::uint8_t>(mesh.cut.clusters.size());

  /// Moves a vertex outward by so many voxels.
  void move(VertexIndex vertex, double voxels) {
    const Vec3 normal(mesh.made.mesh.normals[vertex]);
    mesh.made.mesh.positions[vertex] =
        Vec3(mesh.made.mesh.positions[vertex]) + normal * (voxels * kVoxel);
    mesh.cut.clusters[vertex].level = 1;
    changed[vertex] = 1;
  }
};

TEST(CutDistance, FindsNoErrorOnTheUniformMesh) {
  Ball ball;
  const octree::CutRule rule = ruleOf(0.1);
  const LocalFrame frame = frameOf(ball.model);
  CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
  EXPECT_TRUE(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed).empty());
  const Deviation total = distance.total(ball.mesh.cut, ball.mesh.made.mesh);
  EXPECT_EQ(total.largest, 0);
  EXPECT_EQ(total.mean, 0);
}

TEST(CutDistance, TellsHowFarAVertexWasMoved) {
  for (const double voxels : {0.1, 0.3, -0.4}) {
    Ball ball;
    ball.move(100, voxels);
    // What is within the tolerance need not be found tightly.
    const octree::CutRule rule = ruleOf(1.1 * std::abs(voxels));
    const LocalFrame frame = frameOf(ball.model);
    CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
    EXPECT_TRUE(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed).empty());
    const Deviation total = distance.total(ball.mesh.cut, ball.mesh.made.mesh);
    // The surface bends by a tenth of a voxel from vertex to vertex.
    EXPECT_NEAR(total.largest, std::abs(voxels), 0.1 * std::abs(voxels)) << voxels;
    EXPECT_GT(total.mean, 0);
    EXPECT_LT(total.mean, 0.01 * total.largest) << "of a thousand vertices one is off";
  }
}

TEST(CutDistance, NamesTheCellsThatAreTooFarAndMeasuresThemToo) {
  Ball ball;
  ball.move(100, 0.3);
  const octree::CutRule rule = ruleOf(0.1);
  const LocalFrame frame = frameOf(ball.model);
  CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
  EXPECT_EQ(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed),
            std::vector<VertexIndex>{100});
  EXPECT_NEAR(distance.total(ball.mesh.cut, ball.mesh.made.mesh).largest, 0.3, 0.03);
}

TEST(CutDistance, NamesTheCellsThatFoldTheMesh) {
  Ball ball;
  Position& moved = ball.mesh.made.mesh.positions[100];
  const Vec3 normal(ball.mesh.made.mesh.normals[100]);
  const Vec3 along = normal.cross(std::abs(normal[0]) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  ball.mesh.cut.clusters[100].level = 1;
  ball.changed[100] = 1;
  const octree::CutRule rule = ruleOf(5);
  const LocalFrame frame = frameOf(ball.model);
  CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
  EXPECT_TRUE(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed).empty());
  moved = Vec3(moved) + along * (2.5 * kVoxel);
  EXPECT_EQ(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed),
            std::vector<VertexIndex>{100});
}

TEST(CutDistance, MeasuresAgainWhatChangedOnly) {
  Ball ball;
  ball.move(100, 0.3);
  ball.move(500, 0.05);
  const octree::CutRule rule = ruleOf(0.1);
  const LocalFrame frame = frameOf(ball.model);
  CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
  EXPECT_EQ(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed),
            std::vector<VertexIndex>{100});
  // Back to where it was; the other one stays off.
  ball.mesh.made.mesh.positions[100] = ball.model.mesh().positions[100];
  ball.mesh.cut.clusters[100].level = 0;
  ball.changed.assign(ball.changed.size(), 0);
  ball.changed[100] = 1;
  EXPECT_TRUE(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed).empty());
  const Deviation total = distance.total(ball.mesh.cut, ball.mesh.made.mesh);
  EXPECT_NEAR(total.largest, 0.05, 0.005);
}

TEST(CutDistance, AsksTheToleranceWhereThingsLie) {
  Ball ball;
  ball.move(100, 0.3);
  const auto tooFar = [&](double there, double elsewhere) {
    octree::CutRule rule = ruleOf(1);
    const grid::Affine& affine = ball.model.model().view().affine;
    const Vec3 moved = affine.latticePoint(ball.model.mesh().positions[100], affine.origin()) +
                       Vec3(affine.origin());
    rule.scale = [=](const Vec3& point) {
      return (point - moved).length() < 4 ? there : elsewhere;
    };
    const LocalFrame frame = frameOf(ball.model);
    CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
    return distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed);
  };
  EXPECT_EQ(tooFar(0.1, 1), std::vector<VertexIndex>{100});
  EXPECT_TRUE(tooFar(1, 0.1).empty());
}

// A speck of one sample is thinner than the tolerance. Where its top is in the mesh, both of its
// sides are near the bottom.
TEST(CutDistance, NamesComponentsThatTheUniformMeshLeavesOutInPart) {
  const auto grid = test::levelSetOf(4, 1, [](const Vec3& p) { return p.length() - 0.02; });
  for (const bool isMoved : {false, true}) {
    test::ModelOf speck(grid);
    test::MeshOfCut mesh = speck.uniformCut();
    ASSERT_EQ(mesh.cut.clusters.size(), 8U);
    std::vector<VertexIndex> all;
    for (VertexIndex v = 0; v < 8; ++v) {
      Position& p = mesh.made.mesh.positions[v];
      if (isMoved && p.x < 8) p.z += 0.3f;  // the sample is at 8, 8, 8
      mesh.cut.clusters[v].level = 1;
      all.push_back(v);
    }
    const octree::CutRule rule = ruleOf(0.1);
    const LocalFrame frame = frameOf(speck);
    CutDistance distance(speck.model().view(), frame, rule, speck.job());
    const std::vector<std::uint8_t> changed(8, 1);
    EXPECT_TRUE(distance.measure(mesh.cut, mesh.made, changed).empty());
    EXPECT_EQ(distance.findUncovered(mesh.cut, mesh.made),
              isMoved ? all : std::vector<VertexIndex>{});
  }
}

// Where it may not be split, the way back is measured.
TEST(CutDistance, MeasuresWhatStaysUncoveredBothWays) {
  const auto grid = test::levelSetOf(4, 1, [](const Vec3& p) { return p.length() - 0.02; });
  test::ModelOf speck(grid);
  test::MeshOfCut mesh = speck.uniformCut();
  for (VertexIndex v = 0; v < 8; ++v) {
    Position& p = mesh.made.mesh.positions[v];
    if (p.x < 8) p.z += 0.3f;
    mesh.cut.clusters[v].level = 1;
  }
  const octree::CutRule rule = ruleOf(0.1);
  const LocalFrame frame = frameOf(speck);
  CutDistance distance(speck.model().view(), frame, rule, speck.job());
  EXPECT_TRUE(distance.measure(mesh.cut, mesh.made, std::vector<std::uint8_t>(8, 1)).empty());
  EXPECT_LE(distance.total(mesh.cut, mesh.made.mesh).largest, 0.1);
  EXPECT_FALSE(distance.findUncovered(mesh.cut, mesh.made).empty());
  EXPECT_GE(distance.total(mesh.cut, mesh.made.mesh).largest, 0.3);
}

TEST(CutDistance, FindsNothingUncoveredOnABall) {
  Ball ball;
  for (const VertexIndex moved : {100, 500, 700}) ball.move(moved, 0.2);
  const octree::CutRule rule = ruleOf(0.25);
  const LocalFrame frame = frameOf(ball.model);
  CutDistance distance(ball.model.model().view(), frame, rule, ball.model.job());
  EXPECT_TRUE(distance.measure(ball.mesh.cut, ball.mesh.made, ball.changed).empty());
  EXPECT_TRUE(distance.findUncovered(ball.mesh.cut, ball.mesh.made).empty());
}

// A surface in a crowd of cells of all sizes: what is within the tolerance by the bound is within
// it by samples, whether it was measured at once or from mesh to mesh.
TEST(CutDistance, IsABoundFromMeshToMesh) {
  test::ModelOf ring(test_ring::ring());
  const octree::ClusterForest& forest = ring.model().forest();
  octree::CutRule rule = ring.rule();
  rule.tolerance = 0.06;
  octree::CellFlags forbidden(forest);
  const LocalFrame frame = frameOf(ring);
  CutDistance distance(ring.model().view(), frame, rule, ring.job());
  octree::Cut before;
  int meshes = 0;
  for (bool isDone = false; !isDone; ++meshes) {
    ASSERT_LT(meshes, 20);
    const octree::CellFlags merged = octree::mergeCells(forest, rule, forbidden, ring.job());
    const octree::Cut cut =
        octree::makeCut(forest, ring.model().surface().topology, merged, ring.job());
    const octree::CutMesh made =
        octree::meshCut(forest, cut, ring.mesh(), ring.model().affine(), ring.job());
    std::vector<std::uint8_t> changed(cut.clusters.size());
    for (std::size_t i = 0; i < cut.vertexOf.size(); ++i) {
      const octree::ClusterRef& is = cut.clusters[cut.vertexOf[i]];
      const octree::ClusterRef was = before.clusters.empty()
                                         ? octree::ClusterRef{0, static_cast<std::uint32_t>(i)}
                                         : before.clusters[before.vertexOf[i]];
      if (was.level != is.level || was.cluster != is.cluster) changed[cut.vertexOf[i]] = 1;
    }
    isDone = !splitCells(forest, distance.measure(cut, made, changed), cut, 0, forbidden);
    before = cut;
    if (!isDone) continue;
    const double bound = distance.total(cut, made.mesh).largest;
    EXPECT_LE(bound, rule.tolerance);
    EXPECT_LE(test::largestDistance(ring.mesh(), made.mesh, kVoxel) / kVoxel, bound + 1e-4);
    EXPECT_LE(test::largestDistance(made.mesh, ring.mesh(), kVoxel) / kVoxel, bound + 1e-4);
  }
  EXPECT_GT(meshes, 1) << "nothing was measured again";
}

}  // namespace
}  // namespace tufa::refine
