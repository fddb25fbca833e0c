#include "octree/solve_patch.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/print.h"

namespace tufa::octree {
namespace {

const grid::Affine kLattice{grid::Transform(*openvdb::math::Transform::createLinearTransform(1.0))};

struct Plane {
  Vec3 point, normal;
};

Patch patchOf(const std::vector<Plane>& planes) {
  Patch patch;
  for (const Plane& plane : planes) {
    patch.planes.addPlane(plane.point, plane.normal);
    patch.planes.addPoint(plane.point);
    patch.cone.add({plane.normal, 0});
  }
  return patch;
}

// The vertex, in the coordinates of the planes.
Vec3 vertexOf(const Cluster& cluster, const Vec3& corner, int size) {
  return corner + Vec3(0.5 * size) + Vec3(cluster.point[0], cluster.point[1], cluster.point[2]);
}

TEST(SolvePatch, OfAPlaneLiesOnItInTheMiddleOfItsPoints) {
  const Vec3 normal = Vec3(1, 2, 2) / 3, corner(8, 16, 0);
  const Vec3 middle = corner + Vec3(4);
  std::vector<Plane> planes;
  for (const Vec3& step : {Vec3(3, 0, 0), Vec3(-3, 0, 0), Vec3(0, 1, 2), Vec3(0, -1, -2)}) {
    planes.push_back({middle + normal.cross(step), normal});
  }
  const Cluster cluster = solvePatch(patchOf(planes), corner, 8, kLattice);
  EXPECT_LT((vertexOf(cluster, corner, 8) - middle).length(), 1e-4);
  EXPECT_NEAR(cluster.error, 0, 1e-5);
  EXPECT_NEAR(cluster.angle, 0, 1e-3);
  EXPECT_LT((Vec3(cluster.normal[0], cluster.normal[1], cluster.normal[2]) - normal).length(),
            1e-6);
}

TEST(SolvePatch, OfThreePlanesIsTheirCorner) {
  const Vec3 corner(0, 8, 8), meeting = corner + Vec3(1, 6, 3);
  const Cluster cluster = solvePatch(
      patchOf({{meeting, Vec3(1, 0, 0)}, {meeting, Vec3(0, 1, 0)}, {meeting, Vec3(0, 0, 1)}}),
      corner, 8, kLattice);
  EXPECT_LT((vertexOf(cluster, corner, 8) - meeting).length(), 1e-4);
  EXPECT_NEAR(cluster.error, 0, 1e-4);
  // The cone of three axes is wider than the angle between each of them and the mean.
  EXPECT_GE(static_cast<double>(cluster.angle), std::numbers::pi / 2);
}

TEST(SolvePatch, StaysInItsCell) {
  for (const int size : {2, 8, 64}) {
    const Vec3 corner(16, 0, -32), middle = corner + Vec3(0.5 * size);
    // The corner of the planes lies beyond the cell.
    const Vec3 meeting = corner + Vec3(1.5 * size, 0.5 * size, -0.25 * size);
    std::vector<Plane> planes;
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, 0.6, 0.8), Vec3(0, -0.8, 0.6)}) {
      planes.push_back({meeting, normal});
    }
    Patch patch = patchOf(planes);
    patch.planes.points = middle * 3;
    const Vec3 vertex = vertexOf(solvePatch(patch, corner, size, kLattice), corner, size);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(vertex[axis], corner[axis]) << size << vertex;
      EXPECT_LT(vertex[axis], corner[axis] + size) << size << vertex;
    }
  }
}

TEST(SolvePatch, TellsTheRootMeanSquareDistanceToItsPlanes) {
  // Parallel planes one voxel apart: the vertex lies between them.
  const Vec3 up(0, 0, 1), corner(0.0);
  const Cluster cluster =
      solvePatch(patchOf({{Vec3(2, 2, 1.5), up}, {Vec3(2, 2, 2.5), up}}), corner, 4, kLattice);
  EXPECT_NEAR(cluster.error, 0.5, 1e-5);
  EXPECT_NEAR(vertexOf(cluster, corner, 4)[2], 2, 1e-5);
}

TEST(SolvePatch, DoesNotDependOnWhereItsCellLies) {
  const Vec3 shift(1 << 20, -(1 << 18), 64);
  const auto planesAt = [](const Vec3& corner) {
    return std::vector<Plane>{{corner + Vec3(1, 2, 3), Vec3(0.6, 0.8, 0)},
                              {corner + Vec3(3, 2, 1), Vec3(0, 0.6, 0.8)}};
  };
  // As the forest has them: planes counted from the corner.
  const Cluster here = solvePatch(patchOf(planesAt(Vec3(0.0))), Vec3(0.0), 4, kLattice);
  const Cluster there = solvePatch(patchOf(planesAt(shift)), shift, 4, kLattice);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(here.point[axis], there.point[axis], 1e-3);
  }
}

TEST(PatchPlanes, AreTheSameProblemSeenFromElsewhere) {
  const Patch patch = patchOf({{Vec3(1, 2, 3), Vec3(0.6, 0.8, 0)}, {Vec3(3, 2, 1), Vec3(0, 0, 1)}});
  const Vec3 origin(5, -6, 7);
  const PatchPlanes moved = patch.planes.translatedTo(origin);
  for (const Vec3& x : {Vec3(0.0), Vec3(1, 1, 1), Vec3(-3, 4, 2)}) {
    EXPECT_NEAR(moved.meanSquare(x - origin), patch.planes.meanSquare(x), 1e-9);
  }
  EXPECT_LT((moved.points / moved.pointCount - (Vec3(2, 2, 2) - origin)).length(), 1e-12);
}

TEST(PatchPlanes, OfNoneHaveNoError) { EXPECT_EQ(PatchPlanes().meanSquare(Vec3(1, 2, 3)), 0); }

}  // namespace
}  // namespace tufa::octree
