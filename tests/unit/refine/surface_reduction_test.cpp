#include "refine/surface_reduction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "refine/uniform_repair.h"
#include "support/mesh_oracle.h"
#include "support/model.h"
#include "unit/refine/ring.h"

namespace tufa::refine {
namespace {

using test_ring::expectRing;
using test_ring::kVoxel;
using test_ring::ring;

// A large ball around the origin and a small one beside it.
openvdb::FloatGrid::Ptr twoBalls() {
  return test::levelSetOf(24, kVoxel, [](const Vec3& p) {
    return std::min(p.length() - 8.3, (p - Vec3(17, 0, 0)).length() - 1.7);
  });
}

struct Reduced {
  test::ModelOf model;
  octree::CutRule rule;
  Mesh uniform = model.mesh();
  std::size_t uniformTriangles = model.mesh().triangleCount();
  SurfaceReduction reduction{model.model(), rule, model.job()};

  explicit Reduced(openvdb::FloatGrid::ConstPtr grid)
      : model(std::move(grid)), rule(model.rule()) {}
  Reduced(openvdb::FloatGrid::ConstPtr grid, double tolerance)
      : model(std::move(grid)), rule(withTolerance(model.rule(), tolerance)) {}

 private:
  static octree::CutRule withTolerance(octree::CutRule rule, double tolerance) {
    rule.tolerance = tolerance;
    return rule;
  }
};

TEST(SurfaceReduction, KeepsTheToleranceAndTheTopologyFromLevelToLevel) {
  Reduced made(ring());
  std::size_t before = made.uniformTriangles;
  for (const double tolerance : {0.05, 0.2, 0.6}) {
    const AdaptiveMesh adaptive = made.reduction.toTolerance(tolerance, false);
    EXPECT_LE(adaptive.largestError, tolerance);
    EXPECT_GT(adaptive.largestError, 0.5 * tolerance);
    EXPECT_LT(adaptive.meanError, adaptive.largestError);
    EXPECT_LT(adaptive.extracted.mesh.triangleCount(), before / 2);
    EXPECT_TRUE(adaptive.leaves.empty());
    before = adaptive.extracted.mesh.triangleCount();
    expectRing(adaptive.extracted.mesh);
  }
}

TEST(SurfaceReduction, IsTheUniformMeshAtAToleranceOfZero) {
  Reduced made(ring(), 0);
  const AdaptiveMesh adaptive = made.reduction.toTolerance(0, false);
  EXPECT_EQ(adaptive.largestError, 0);
  EXPECT_EQ(adaptive.meanError, 0);
  EXPECT_EQ(adaptive.extracted.mesh.positions, made.uniform.positions);
  EXPECT_EQ(adaptive.extracted.mesh.triangles.size(), made.uniformTriangles);
}

// Repair of what is left asks for the points that vertices may fall back to.
TEST(SurfaceReduction, LeavesAModelThatMakesItsCellsAgain) {
  test::ModelOf model(ring());
  const std::vector<VertexIndex> some{3, 50, 700};
  const std::vector<Position> points =
      sourceOf(model.model().withCells(model.job()), model.job()).massPoints(some);
  const octree::CutRule rule = model.rule();
  const std::size_t vertices = model.mesh().positions.size();
  const SurfaceReduction reduction(model.model(), rule, model.job());
  EXPECT_EQ(model.model().surface().topology.vertexCount, 0U);
  EXPECT_EQ(sourceOf(model.model().withCells(model.job()), model.job()).massPoints(some), points);
  EXPECT_EQ(model.model().surface().topology.vertexCount, vertices);
}

TEST(SurfaceReduction, StopsAtANumberOfTriangles) {
  Reduced made(ring());
  const AdaptiveMesh adaptive = made.reduction.toCount(500, false);
  EXPECT_LE(adaptive.extracted.mesh.triangleCount(), 500U);
  EXPECT_GT(adaptive.extracted.mesh.triangleCount(), 475U);
  EXPECT_LE(adaptive.largestError, 1) << "voxels, of a tube six thick";
  expectRing(adaptive.extracted.mesh);
}

TEST(SurfaceReduction, SaysWhereVerticesComeFrom) {
  Reduced made(ring());
  const ExtractedMesh extracted = made.reduction.toTolerance(0.05, false).extracted;
  ASSERT_EQ(extracted.baseVertices.size(), extracted.mesh.positions.size());
  ASSERT_EQ(extracted.baseQuads.size(), extracted.mesh.triangles.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < extracted.baseVertices.size(); ++i) {
    if (extracted.baseVertices[i] == octree::kNone) continue;
    const Vec3 position(extracted.mesh.positions[i]);
    EXPECT_LT((position - Vec3(made.uniform.positions[extracted.baseVertices[i]])).length(),
              1e-5 * kVoxel);
    ++kept;
  }
  EXPECT_GT(kept, 0U);
  EXPECT_TRUE(made.model.mesh().positions.empty()) << "single precision does";
}

// Whether they intersect once they are rounded may be a matter of the last bit.
TEST(SurfaceReduction, LeavesVerticesOfClosePolygonsWhereTheyWere) {
  Reduced made(test::levelSetOf(18, kVoxel, [](const Vec3& p) {  // thin walls that nearly touch
    return std::abs(std::sin(p[0]) * std::cos(p[1]) + std::sin(p[1]) * std::cos(p[2]) +
                    std::sin(p[2]) * std::cos(p[0])) -
           0.12;
  }));
  const std::vector<VertexIndex> close = intersect::verticesOf(
      made.uniform, intersect::distinctPolygonsOf(made.model.model().closePairs()));
  ASSERT_FALSE(close.empty());
  const ExtractedMesh extracted = made.reduction.toTolerance(0.01, false).extracted;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < extracted.baseVertices.size(); ++i) {
    const VertexIndex base = extracted.baseVertices[i];
    if (!std::binary_search(close.begin(), close.end(), base)) continue;
    ++kept;
    EXPECT_EQ(extracted.mesh.positions[i], made.uniform.positions[base]);
  }
  EXPECT_GT(kept, 0U);
}

// Another mesh may go on there, made by itself.
TEST(SurfaceReduction, LeavesVerticesOnOpenBordersWhereTheyWere) {
  openvdb::FloatGrid::Ptr half = ring()->deepCopy();
  half->tree().clip(
      openvdb::CoordBBox(openvdb::Coord(-200, -200, -200), openvdb::Coord(2, 200, 200)));
  Reduced made(half);
  const ExtractedMesh extracted = made.reduction.toTolerance(0.1, false).extracted;
  std::size_t exact = 0, kept = 0;
  for (std::size_t i = 0; i < extracted.baseVertices.size(); ++i) {
    if (extracted.baseVertices[i] == octree::kNone) continue;
    ++kept;
    exact +=
        extracted.mesh.positions[i] == made.uniform.positions[extracted.baseVertices[i]] ? 1 : 0;
  }
  EXPECT_GT(made.model.model().report().openEdges, 20U);
  EXPECT_GT(kept, 20U);
  EXPECT_EQ(exact, kept);
}

TEST(SurfaceReduction, DropsSmallComponentsAndTellsOfEachOnce) {
  Reduced made(twoBalls());
  AdaptiveMesh adaptive = made.reduction.toTolerance(0.2, true);
  EXPECT_TRUE(adaptive.dropped.empty());
  EXPECT_EQ(test::inspect(adaptive.extracted.mesh).components, 2U);
  adaptive = made.reduction.toTolerance(6.5, true);
  ASSERT_EQ(adaptive.dropped.size(), 1U);
  const Vec3 centre(made.model.model().affine().toWorld(adaptive.dropped[0].centre));
  EXPECT_LT((centre - Vec3(8.5, 0, 0)).length(), 0.25);
  EXPECT_EQ(test::inspect(adaptive.extracted.mesh).components, 1U);
  adaptive = made.reduction.toTolerance(7, true);
  EXPECT_TRUE(adaptive.dropped.empty()) << "it was dropped before";
  EXPECT_EQ(test::inspect(adaptive.extracted.mesh).components, 1U);
}

}  // namespace
}  // namespace tufa::refine
