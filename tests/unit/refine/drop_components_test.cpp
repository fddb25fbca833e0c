#include "refine/drop_components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/mesh_oracle.h"
#include "support/model.h"

namespace tufa::refine {
namespace {

// A large ball around the origin and a small one beside it, in voxels of 0.5.
struct TwoBalls {
  test::ModelOf model{test::levelSetOf(24, 0.5, [](const Vec3& p) {
    return std::min(p.length() - 8.3, (p - Vec3(17, 0, 0)).length() - 1.7);
  })};
  test::MeshOfCut mesh = model.uniformCut();
  std::vector<Dropped> dropped;

  double drop(double tolerance) {
    octree::CutRule rule;
    rule.tolerance = tolerance;
    return dropComponents(model.model().view(), rule, mesh.cut, mesh.made, dropped);
  }
  [[nodiscard]] std::size_t components() {
    std::vector<VertexIndex> baseVertices(mesh.made.mesh.positions.size());
    Mesh used = mesh.made.mesh;
    (void)removeUnused(used, baseVertices);
    return test::inspect(used).components;
  }
};

// The diagonal of the box around the small ball's vertices.
constexpr double kLeastSize = 4, kMostSize = 6.5;

TEST(DropComponents, KeepsWhatIsLargerThanTheTolerance) {
  TwoBalls balls;
  const double next = balls.drop(kLeastSize);
  EXPECT_GT(next, kLeastSize);
  EXPECT_LT(next, kMostSize);
  EXPECT_TRUE(balls.dropped.empty());
  EXPECT_EQ(balls.components(), 2U);
}

TEST(DropComponents, TakesOutWhatIsSmallerAndSaysWhere) {
  TwoBalls balls;
  EXPECT_EQ(balls.drop(kMostSize), 0) << "nothing is left that might go";
  ASSERT_EQ(balls.dropped.size(), 1U);
  EXPECT_GT(balls.dropped[0].size, kLeastSize);
  const Vec3 centre(balls.model.model().affine().toWorld(balls.dropped[0].centre));
  EXPECT_LT((centre - Vec3(8.5, 0, 0)).length(), 0.25);
  EXPECT_EQ(balls.components(), 1U);
  EXPECT_EQ(balls.mesh.made.quadSources.size(), balls.mesh.made.mesh.quads.size());
  for (std::size_t i = 0; i < balls.mesh.made.mesh.quads.size(); ++i) {
    EXPECT_EQ(balls.mesh.made.mesh.quads[i],
              balls.model.mesh().quads[balls.mesh.made.quadSources[i]]);
  }
}

TEST(DropComponents, GoesByTheSizeThatItTold) {
  TwoBalls balls;
  const double next = balls.drop(0.1);
  EXPECT_EQ(balls.drop(0.999 * next), next);
  EXPECT_TRUE(balls.dropped.empty());
  (void)balls.drop(1.001 * next);
  EXPECT_EQ(balls.dropped.size(), 1U);
}

TEST(DropComponents, KeepsTheLargestWhateverTheTolerance) {
  TwoBalls balls;
  (void)balls.drop(1e6);
  EXPECT_EQ(balls.dropped.size(), 1U);
  EXPECT_EQ(balls.components(), 1U);
}

TEST(DropComponents, AsksTheToleranceWhereTheyLie) {
  TwoBalls balls;
  octree::CutRule rule;
  rule.tolerance = 100;
  rule.scale = [](const Vec3& at) { return at[0] > 10 ? 0.0 : 1.0; };
  EXPECT_EQ(dropComponents(balls.model.model().view(), rule, balls.mesh.cut, balls.mesh.made,
                           balls.dropped),
            0)
      << "no tolerance would make it go";
  EXPECT_TRUE(balls.dropped.empty());
}

TEST(RemoveUnused, LeavesTheVerticesOfPolygonsInTheirOrder) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back(i, 0, 0);
    mesh.normals.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  }
  mesh.quads.emplace_back(7, 1, 2, 4);
  mesh.triangles.emplace_back(4, 2, 5);
  std::vector<VertexIndex> baseVertices = {10, 11, 12, 13, 14, 15, 16, 17};
  const auto used = removeUnused(mesh, baseVertices);
  EXPECT_EQ(used, (std::vector<std::uint8_t>{0, 1, 1, 0, 1, 1, 0, 1}));
  EXPECT_EQ(baseVertices, (std::vector<VertexIndex>{11, 12, 14, 15, 17}));
  ASSERT_EQ(mesh.positions.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(mesh.positions[i].x, baseVertices[i] - 10);
    EXPECT_EQ(static_cast<double>(mesh.normals[i].x), mesh.positions[i].x);
  }
  EXPECT_EQ(mesh.quads[0], Quad(4, 0, 1, 2));
  EXPECT_EQ(mesh.triangles[0], Triangle(2, 1, 3));
}

}  // namespace
}  // namespace tufa::refine
