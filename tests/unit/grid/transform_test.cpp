#include "grid/transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "grid/affine.h"
#include "grid/vdb_coord.h"
#include "support/fields.h"
#include "support/print.h"

namespace tufa::grid {
namespace {

using openvdb::Mat4d;

// Scaled, sheared, turned, moved, and mirrored: rows are the world's directions of the axes.
Mat4d skewed(bool mirrored = false) {
  const double sign = mirrored ? -1 : 1;
  return Mat4d(0.5 * sign, 0.1, 0.0, 0.0,  //
               -0.2, 0.8, 0.3, 0.0,        //
               0.1, -0.4, 1.5, 0.0,        //
               7.0, -3.0, 11.0, 1.0);
}

Transform transformBy(const Mat4d& matrix) {
  return Transform(*openvdb::math::Transform::createLinearTransform(matrix));
}

// By the definition: a row vector times the matrix.
Vec3 applied(const Mat4d& m, const Vec3& p) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) {
    out[i] = p[0] * m[0][i] + p[1] * m[1][i] + p[2] * m[2][i] + m[3][i];
  }
  return out;
}

// However far away a grid lies: differences of world points there have few digits.
TEST(Affine, HasTheStepsOfTheLattice) {
  for (const double far : {0.0, 1e6, 9e10}) {
    const auto transform = openvdb::math::Transform::createLinearTransform(0.1);
    transform->postTranslate(openvdb::Vec3d(far, -far, far / 3));
    const Affine affine{Transform(*transform)};
    EXPECT_NEAR(affine.voxelSize(), 0.1, 1e-15) << far;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(affine.axis(axis)[static_cast<std::size_t>(axis)], 0.1, 1e-15) << far;
    }
  }
}

const std::vector<Vec3> kPoints = {Vec3(0.0), Vec3(1, 2, 3), Vec3(-4.5, 0.25, 100)};

TEST(Transform, IsTheGridsAndItsInverse) {
  const Transform transform = transformBy(skewed());
  for (const Vec3& point : kPoints) {
    const Vec3 world = transform.indexToWorld(point);
    EXPECT_LT((world - applied(skewed(), point)).length(), 1e-12) << point;
    EXPECT_LT((transform.worldToIndex(world) - point).length(), 1e-12) << point;
  }
}

TEST(Transform, HasTheMatrixThatRowVectorsAreMultipliedWith) {
  const auto matrix = transformBy(skewed()).matrix();
  const Mat4d expected = skewed();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_DOUBLE_EQ(matrix[row][column], expected[row][column]);
    }
  }
}

TEST(Transform, StaysWhatItWasWhenTheGridChanges) {
  auto grid = openvdb::FloatGrid::create(1);
  const Transform transform = transformOf(*grid);
  grid->transform().postScale(5);
  EXPECT_EQ(transform.indexToWorld(Vec3(1, 2, 3)), Vec3(1, 2, 3));
}

TEST(Affine, PutsCellsWhereTheTransformDoes) {
  const Transform transform = transformBy(skewed());
  const Affine affine(transform, Coord(5, -6, 7));
  for (const Coord& cell : {Coord(0), Coord(5, -6, 7), Coord(-3, 20, 1)}) {
    const Vec3 offset(0.25, 0.5, 0.75);
    const Position p = affine.position(cell, offset[0], offset[1], offset[2]);
    const Vec3 world = transform.indexToWorld(Vec3(cell) + offset);
    EXPECT_LT((Vec3(affine.toWorld(p)) - world).length(), 1e-12) << cell;
    EXPECT_LT((Vec3(affine.fromWorld(world)) - Vec3(p)).length(), 1e-12) << cell;
    EXPECT_LT((affine.latticePoint(p, cell) - offset).length(), 1e-12) << cell;
  }
}

// Far from the lattice's origin, where the world's digits are few.
TEST(Affine, CountsPositionsFromItsOriginWithoutLoss) {
  const Transform transform(*openvdb::math::Transform::createLinearTransform(0.1));
  const Affine here(transform), there(transform, Coord(1 << 30));
  for (const Coord& cell : {Coord(0), Coord(3, 5, -7)}) {
    EXPECT_EQ(there.position(cell.offsetBy(1 << 30), 0.3, 0.6, 0.9),
              here.position(cell, 0.3, 0.6, 0.9));
  }
}

TEST(Affine, KnowsTheSizesOfAVoxel) {
  // A voxel of 2 x 3 x 4 along turned axes would be the same; here the axes are the world's.
  Mat4d matrix = Mat4d::identity();
  matrix.preScale(openvdb::Vec3d(2, 3, 4));
  const Affine affine(transformBy(matrix));
  EXPECT_DOUBLE_EQ(affine.voxelSize(), std::cbrt(24));
  EXPECT_DOUBLE_EQ(affine.leastHeight(), 2);
  EXPECT_EQ(affine.axis(1), Vec3(0, 3, 0));
  // Sheared by 45 degrees: the faces across x are 1 / sqrt(2) apart.
  Mat4d sheared = Mat4d::identity();
  sheared[0][1] = 1;
  EXPECT_NEAR(Affine(transformBy(sheared)).leastHeight(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(Affine(transformBy(sheared)).voxelSize(), 1, 1e-12);
}

TEST(Affine, TellsWhetherItMirrors) {
  EXPECT_FALSE(Affine(transformBy(skewed())).mirrored());
  EXPECT_TRUE(Affine(transformBy(skewed(true))).mirrored());
}

// The plane g . x = 0 of index space: its directions must lie across the normal in the world.
TEST(Affine, NormalsStayAcrossTheirPlanes) {
  for (const bool mirrored : {false, true}) {
    const Affine affine(transformBy(skewed(mirrored)));
    for (const Vec3& g : {Vec3(0, 0, 1), Vec3(1, -2, 0.5), Vec3(-3, 1, 1)}) {
      const Vec3 normal(affine.normalOfPlane(g));
      EXPECT_NEAR(normal.length(), 1, 1e-6);
      for (const Vec3& other : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        const Vec3 inPlane = g.cross(other);
        const Vec3 world =
            affine.axis(0) * inPlane[0] + affine.axis(1) * inPlane[1] + affine.axis(2) * inPlane[2];
        EXPECT_NEAR(normal.dot(world), 0, 1e-5) << g;
      }
      // Where the field rises in index space it rises along the normal.
      const Vec3 upward = affine.axis(0) * g[0] + affine.axis(1) * g[1] + affine.axis(2) * g[2];
      EXPECT_GT(normal.dot(upward), 0) << g;
    }
  }
}

TEST(Affine, OfNoGradientHasNoNormal) {
  EXPECT_EQ(Affine(transformBy(skewed())).normal(0, 0, 0), Normal(0, 0, 0));
}

TEST(Affine, MeasuresAlongANormalInVoxels) {
  const Affine affine(transformBy(skewed()));
  const Normal normal(Vec3(2, -1, 2) / 3);
  const Vec3 g = affine.planeInLattice(normal);
  for (const Vec3& step : kPoints) {
    const Vec3 world =
        affine.axis(0) * step[0] + affine.axis(1) * step[1] + affine.axis(2) * step[2];
    EXPECT_NEAR(g.dot(step), Vec3(normal).dot(world) / affine.voxelSize(), 1e-9);
  }
}

}  // namespace
}  // namespace tufa::grid
