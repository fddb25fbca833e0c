#include "creases/promote.h"

#include <gtest/gtest.h>

#include <cmath>

#include "creases/vertex_sides.h"

namespace tufa::creases {
namespace {

using Kind = VertexSides::Kind;

const float kHalf = std::sqrt(0.5F);
const Normal kLeft(-kHalf, 0, kHalf);
const Normal kRight(kHalf, 0, kHalf);

/// A roof with its ridge along y at x = 0, z = 0, and quads that step over it.
struct Roof {
  Mesh mesh;
  VertexSides sides;

  void add(double x, double y) {
    mesh.positions.emplace_back(x, y, -std::abs(x));
    mesh.normals.push_back(x < 0 ? kLeft : kRight);
  }
  Roof() {
    for (int y = 0; y < 4; ++y) {
      add(-0.5, y);
      add(0.3, y);
    }
    for (VertexIndex y = 0; y < 3; ++y) {
      mesh.quads.emplace_back(2 * y, 2 * y + 1, 2 * y + 3, 2 * y + 2);
    }
    sides = VertexSides(mesh.positions.size());
    sides.setKinds(0, std::vector<Kind>(mesh.positions.size(), Kind::Near));
  }
};

TEST(VertexSides, TellSidesApart) {
  Roof roof;
  EXPECT_EQ(roof.sides.kind(0), Kind::Near);
  EXPECT_EQ(roof.sides.sides(roof.mesh, 0).count, 1);
  EXPECT_EQ(roof.sides.sides(roof.mesh, 0).normals[0], kLeft);
  roof.sides.setMeeting(1, {2, {kLeft, kRight}});
  EXPECT_EQ(roof.sides.sides(roof.mesh, 1).count, 2);
  EXPECT_TRUE(roof.sides.isSharp(1));
  roof.sides.setKinds(2, {Kind::Unknown});
  EXPECT_EQ(roof.sides.sides(roof.mesh, 2).count, 0);
  EXPECT_EQ(roof.sides.sharpCount(), 2U);
}

TEST(QuadSides, FitWhereADiagonalFollowsTheCrease) {
  Roof roof;
  const Quad& quad = roof.mesh.quads[0];
  EXPECT_EQ(QuadSides(roof.mesh, roof.sides, quad).count(), 2);
  EXPECT_FALSE(QuadSides(roof.mesh, roof.sides, quad).fits(false));
  EXPECT_FALSE(QuadSides(roof.mesh, roof.sides, quad).fits(true));
  // Corners 1 and 3 on the ridge: the diagonal between them leaves one side on either side.
  roof.sides.setMeeting(quad.vertices[1], {2, {kLeft, kRight}});
  roof.sides.setMeeting(quad.vertices[3], {2, {kLeft, kRight}});
  EXPECT_FALSE(QuadSides(roof.mesh, roof.sides, quad).fits(false));
  EXPECT_TRUE(QuadSides(roof.mesh, roof.sides, quad).fits(true));
}

TEST(PromoteToCreases, MovesTheNearestVerticesOntoTheRidge) {
  Roof roof;
  const Mesh before = roof.mesh;
  base::Job job(2, {});
  const std::size_t moved = promoteToCreases(roof.mesh, roof.sides, 1, job);
  EXPECT_GT(moved, 0U);
  EXPECT_EQ(moved, roof.sides.sharpCount());
  for (VertexIndex v = 0; v < before.positions.size(); ++v) {
    const Position& p = roof.mesh.positions[v];
    if (roof.sides.kind(v) != Kind::Meeting) {
      EXPECT_EQ(p, before.positions[v]);
      continue;
    }
    EXPECT_EQ(v % 2, 1U) << "the right ones are nearer";
    EXPECT_NEAR(p.x, 0, 1e-6);
    EXPECT_NEAR(p.z, 0, 1e-6);
    EXPECT_NEAR(p.y, before.positions[v].y, 1e-6);
    EXPECT_NEAR(roof.mesh.normals[v].z, 1, 1e-6);
  }
  for (const Quad& quad : roof.mesh.quads) {
    const QuadSides around(roof.mesh, roof.sides, quad);
    EXPECT_TRUE(around.fits(false) || around.fits(true));
  }
}

TEST(PromoteToCreases, LeavesWhatIsTooFar) {
  Roof roof;
  base::Job job(1, {});
  EXPECT_EQ(promoteToCreases(roof.mesh, roof.sides, 0.2, job), 0U);  // in voxels of a fifth
}

TEST(PromoteToCreases, LeavesSmoothVertices) {
  Roof roof;
  roof.sides = VertexSides(roof.mesh.positions.size());
  base::Job job(1, {});
  EXPECT_EQ(promoteToCreases(roof.mesh, roof.sides, 1, job), 0U);
}

}  // namespace
}  // namespace tufa::creases
