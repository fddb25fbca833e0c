#include "distance/certifier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/model.h"

namespace tufa::distance {
namespace {

constexpr double kVoxel = 0.5;

// A ball, its uniform mesh, and what measures it.
struct Ball {
  test::ModelOf model{test::ballOf(10.3, kVoxel)};
  octree::CutRule rule;
  refine::Measured mesh = model.uniformCut();

  explicit Ball(double tolerance) { rule.tolerance = tolerance; }

  [[nodiscard]] Certifier certifier() {
    return {model.model().view(), model.model().reference(), rule, model.job()};
  }
  /// Moves a vertex outward by so many voxels.
  void move(VertexIndex vertex, double voxels) {
    const Vec3 normal(mesh.made.mesh.normals[vertex]);
    mesh.made.mesh.positions[vertex] =
        Vec3(mesh.made.mesh.positions[vertex]) + normal * (voxels * kVoxel);
    mesh.altered.push_back(vertex);
  }
  [[nodiscard]] Deviation measure(Certifier& certifier) const {
    return certifier.measure(mesh.cut, mesh.made, mesh.altered);
  }
};

TEST(Certifier, FindsNoErrorOnTheUniformMesh) {
  Ball ball(0);
  Certifier certifier = ball.certifier();
  const Deviation deviation = ball.measure(certifier);
  EXPECT_EQ(deviation.worst, 0);
  EXPECT_EQ(deviation.largest, 0);
  EXPECT_EQ(deviation.mean, 0);
  EXPECT_TRUE(deviation.farPoints.empty());
  EXPECT_TRUE(deviation.coarse.empty());
}

TEST(Certifier, TellsHowFarAVertexWasMoved) {
  for (const double voxels : {0.1, 0.3, -0.4}) {
    Ball ball(1);
    ball.move(100, voxels);
    Certifier certifier = ball.certifier();
    const Deviation deviation = ball.measure(certifier);
    // The surface bends by a tenth of a voxel from vertex to vertex.
    EXPECT_NEAR(deviation.worst, std::abs(voxels), 0.1 * std::abs(voxels)) << voxels;
    EXPECT_EQ(deviation.largest, deviation.worst);
    EXPECT_GT(deviation.mean, 0);
    EXPECT_LT(deviation.mean, 0.01 * deviation.worst) << "of two thousand points few are off";
    EXPECT_TRUE(deviation.farPoints.empty());
  }
}

TEST(Certifier, NamesThePointsThatAreFartherThanTheTolerance) {
  Ball ball(0.2);
  ball.move(100, 0.4);
  Certifier certifier = ball.certifier();
  const Deviation deviation = ball.measure(certifier);
  EXPECT_NEAR(deviation.worst, 0.4, 0.04);
  EXPECT_LE(deviation.largest, 0.2) << "of what is within the tolerance";
  EXPECT_TRUE(std::binary_search(deviation.farPoints.begin(), deviation.farPoints.end(), 100U))
      << "the vertex itself";
  const std::size_t vertices = ball.model.mesh().positions.size();
  for (const std::uint64_t point : deviation.farPoints) {
    if (point < vertices) {
      EXPECT_EQ(point, 100U);
      continue;
    }
    const auto& corners = ball.model.mesh().quads[point - vertices].vertices;
    EXPECT_NE(std::find(corners.begin(), corners.end(), 100U), corners.end());
  }
}

TEST(Certifier, TellsTheErrorAtEachVertex) {
  Ball ball(1);
  ball.move(100, 0.3);
  Certifier certifier = ball.certifier();
  const Deviation deviation = ball.measure(certifier);
  const std::vector<float> errors = certifier.errorsAtVertices();
  ASSERT_EQ(errors.size(), ball.mesh.made.mesh.positions.size());
  EXPECT_NEAR(static_cast<double>(errors[100]), deviation.worst, 1e-6);
  // Others know of it only if they share a polygon with it.
  std::vector<std::uint8_t> near(errors.size(), 0);
  for (const Quad& quad : ball.model.mesh().quads) {
    const auto& v = quad.vertices;
    if (std::find(v.begin(), v.end(), 100U) == v.end()) continue;
    for (const VertexIndex vertex : v) near[vertex] = 1;
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_TRUE(near[i] != 0 || errors[i] == 0) << i;
  }
}

TEST(Certifier, MeasuresAgainWhatChangedAlone) {
  Ball ball(1);
  ball.move(100, 0.3);
  Certifier certifier = ball.certifier();
  const Deviation first = ball.measure(certifier);
  ball.move(300, 0.4);
  const Deviation both = ball.measure(certifier);
  Certifier fresh = ball.certifier();
  const Deviation anew = ball.measure(fresh);
  EXPECT_EQ(both.worst, anew.worst);
  EXPECT_EQ(both.largest, anew.largest);
  EXPECT_DOUBLE_EQ(both.mean, anew.mean);
  EXPECT_GT(both.mean, first.mean);
}

TEST(Certifier, LeavesOutTheQuadsThatItIsTold) {
  Ball ball(1);
  ball.move(100, 0.3);
  Certifier certifier = ball.certifier();
  certifier.setIgnored(std::vector<std::uint8_t>(ball.model.mesh().quads.size(), 1));
  Certifier whole = ball.certifier();
  // What is left is the vertex.
  EXPECT_LT(ball.measure(certifier).mean, ball.measure(whole).mean);
}

TEST(ToleranceAt, IsTheRulesAtTheLatticePoint) {
  const test::ModelOf model(test::ballOf(5.3, kVoxel));
  octree::CutRule rule;
  rule.tolerance = 2;
  EXPECT_EQ(toleranceAt(rule, model.model().affine(), Vec3(1, 2, 3)), 2);
  Vec3 asked(0.0);
  rule.scale = [&](const Vec3& at) {
    asked = at;
    return 0.25;
  };
  const Position local = model.model().affine().fromWorld(Position(-1, 0.5, 2));
  EXPECT_EQ(toleranceAt(rule, model.model().affine(), local), 0.5);
  EXPECT_LT((asked - Vec3(-2, 1, 4)).length(), 1e-9);
}

}  // namespace
}  // namespace tufa::distance
