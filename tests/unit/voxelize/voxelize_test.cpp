#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/voxelize.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vec3.h"
#include "support/expect_error.h"

namespace tufa {
namespace {

using test::expectError;

/// A cube of half side 1 in quads.
Mesh makeCube() {
  Mesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.positions.emplace_back(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1);
  mesh.quads = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return mesh;
}

double cubeDistance(const openvdb::Vec3d& p) {
  const openvdb::Vec3d q(std::abs(p.x()) - 1, std::abs(p.y()) - 1, std::abs(p.z()) - 1);
  const double inside = std::min(std::max({q.x(), q.y(), q.z()}), 0.0);
  return inside +
         openvdb::Vec3d(std::max(q.x(), 0.0), std::max(q.y(), 0.0), std::max(q.z(), 0.0)).length();
}

// Adds a cube of another half side, inside out or not.
void addCube(Mesh& mesh, double size, bool facesInward) {
  const auto first = static_cast<VertexIndex>(mesh.positions.size());
  const Mesh cube = makeCube();
  for (const Position& p : cube.positions) {
    mesh.positions.emplace_back(size * p.x, size * p.y, size * p.z);
  }
  for (const Quad& quad : cube.quads) {
    auto [a, b, c, d] = quad.vertices;
    if (facesInward) std::swap(b, d);
    mesh.quads.emplace_back(first + a, first + b, first + c, first + d);
  }
}

TEST(Voxelize, GivesTheSignedDistance) {
  VoxelizeOptions options;
  options.voxelSize = 0.07;
  const auto grid = voxelize(makeCube(), options);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->getName(), "surface");
  EXPECT_NEAR(grid->background(), 0.21, 1e-6);
  EXPECT_GT(grid->activeVoxelCount(), 10000u);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const double truth = cubeDistance(grid->indexToWorld(value.getCoord()));
    ASSERT_NEAR(*value, truth, 1e-6) << value.getCoord();
  }
  for (auto at = openvdb::CoordBBox(openvdb::Coord(-18), openvdb::Coord(18)).begin(); at; ++at) {
    const double truth = cubeDistance(grid->indexToWorld(*at));
    if (std::abs(truth) < 0.2) {
      ASSERT_TRUE(grid->tree().isValueOn(*at)) << *at;
    }
  }
}

// An angle of two walls of length 2 and thickness 1 along z, turned, and how far the samples within
// a voxel of its surface are off, in voxels.
double largestErrorOfAngle(bool exact) {
  const double outline[6][2] = {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
  const Vec3 axes[] = {Vec3(0.36, 0.48, -0.8), Vec3(-0.8, 0.6, 0), Vec3(0.48, 0.64, 0.6)};
  Mesh mesh;
  for (const double z : {-1, 1}) {
    for (const auto& [x, y] : outline) {
      const Vec3 p = axes[0] * x + axes[1] * y + axes[2] * z;
      mesh.positions.emplace_back(p[0], p[1], p[2]);
    }
  }
  for (VertexIndex i = 0; i < 6; ++i) {
    const VertexIndex next = (i + 1) % 6;
    mesh.quads.emplace_back(i, next, next + 6, i + 6);
  }
  mesh.quads.emplace_back(0, 3, 2, 1), mesh.quads.emplace_back(0, 5, 4, 3);
  mesh.quads.emplace_back(6, 7, 8, 9), mesh.quads.emplace_back(6, 9, 10, 11);
  VoxelizeOptions options;
  options.voxelSize = 0.07;
  options.exactDistances = exact;
  MeshDistances distances{};
  const auto grid = voxelize(mesh, options, &distances);
  EXPECT_EQ(distances, exact ? MeshDistances::Exact : MeshDistances::OpenVdb);
  const auto box = [](const Vec3& p, const Vec3& half) {
    return cubeDistance({p[0] / half[0], p[1] / half[1], p[2] / half[2]}) <= 0;
  };
  double largest = 0;
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d at = grid->indexToWorld(value.getCoord());
    const Vec3 world(at[0], at[1], at[2]);
    const Vec3 p(axes[0].dot(world), axes[1].dot(world), axes[2].dot(world));
    // Inside, near the concave edge and far from all others: the distance to that edge's faces, or
    // to the edge itself.
    const bool isInside =
        box(p + Vec3(0, 0.5, 0), Vec3(1, 0.5, 1)) || box(p + Vec3(0.5, 0, 0), Vec3(0.5, 1, 1));
    if (!isInside || std::hypot(p[0], p[1]) > 0.3 || std::abs(p[2]) > 0.7) continue;
    const double truth = p[0] > 0 ? p[1] : p[1] > 0 ? p[0] : -std::hypot(p[0], p[1]);
    if (std::abs(truth) > options.voxelSize) continue;
    largest = std::max(largest, std::abs(static_cast<double>(*value) - truth));
  }
  return largest / options.voxelSize;
}

TEST(Voxelize, IsExactBesideConcaveEdgesToo) {
  EXPECT_LT(largestErrorOfAngle(true), 1e-5);
  EXPECT_GT(largestErrorOfAngle(false), 0.1);
}

// Where two solids overlap, the nearest face may lie in one of them and bound nothing.
TEST(Voxelize, FillsSolidsThatOverlap) {
  Mesh mesh = makeCube();
  const Mesh other = makeCube();
  for (const Position& p : other.positions) mesh.positions.emplace_back(p.x + 0.9, p.y, p.z + 0.3);
  for (const Quad& quad : other.quads) {
    const auto [a, b, c, d] = quad.vertices;
    mesh.quads.emplace_back(a + 8, b + 8, c + 8, d + 8);
  }
  VoxelizeOptions options;
  options.voxelSize = 0.07;
  MeshDistances distances{};
  const auto grid = voxelize(mesh, options, &distances);
  EXPECT_EQ(distances, MeshDistances::OpenVdb);
  for (int x = -13; x < 27; ++x) {
    EXPECT_LT(grid->tree().getValue(openvdb::Coord(x, 0, 2)), 0) << x;
  }
}

// A slit of a voxel and a half, narrower than the band.
TEST(Voxelize, KeepsNarrowSlitsOpen) {
  Mesh mesh;
  addCube(mesh, 1, false);
  addCube(mesh, 1, false);
  for (std::size_t v = 8; v < 16; ++v) mesh.positions[v].x += 2.15;
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  const auto grid = voxelize(mesh, options);
  const auto at = [&](int x) { return grid->tree().getValue(openvdb::Coord(x, 0, 0)); };
  EXPECT_NEAR(at(9), -0.1, 1e-6);
  EXPECT_NEAR(at(11), 0.05, 1e-6);
  EXPECT_NEAR(at(12), -0.05, 1e-6);
}

// OpenVDB fills what closed parts enclose.
TEST(Voxelize, PartsThatFaceInwardAreCavities) {
  VoxelizeOptions options;
  options.voxelSize = 0.05;
  Mesh mesh = makeCube();
  addCube(mesh, 0.6, true);
  addCube(mesh, 0.3, false);
  const auto grid = voxelize(mesh, options);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d p = grid->indexToWorld(value.getCoord());
    const double outer = cubeDistance(p), cavity = cubeDistance(p / 0.6) * 0.6,
                 inner = cubeDistance(p / 0.3) * 0.3;
    const double truth = std::min(std::max(outer, -cavity), inner);
    if (std::abs(truth) > 0.1) continue;
    ASSERT_NEAR(*value, truth, 0.15 * options.voxelSize) << value.getCoord();
  }
  const auto isInside = [&](int z) { return grid->tree().getValue(openvdb::Coord(0, 0, z)) < 0; };
  EXPECT_TRUE(isInside(0));
  EXPECT_FALSE(isInside(9));
  EXPECT_TRUE(isInside(16));
  EXPECT_FALSE(isInside(25));
}

// Whichever way they face: a part alone, and one that faces outward in another.
TEST(Voxelize, OtherPartsAreFilled) {
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  Mesh inward;
  addCube(inward, 1, true);
  Mesh nested = makeCube();
  addCube(nested, 0.5, false);
  for (const Mesh& mesh : {inward, nested}) {
    const auto grid = voxelize(mesh, options);
    for (int z = 0; z < 10; ++z) {
      EXPECT_LT(grid->tree().getValue(openvdb::Coord(0, 0, z)), 0) << z;
    }
  }
}

// As at the poles of spheres of other programs.
TEST(Voxelize, IsExactDespiteDegenerateFaces) {
  Mesh mesh = makeCube();
  mesh.triangles.emplace_back(0, 0, 1);
  mesh.positions.push_back(mesh.positions[0]);
  mesh.triangles.emplace_back(0, 8, 2);
  VoxelizeOptions options;
  options.voxelSize = 0.07;
  const auto grid = voxelize(mesh, options);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const double truth = cubeDistance(grid->indexToWorld(value.getCoord()));
    ASSERT_NEAR(*value, truth, 1e-6) << value.getCoord();
  }
}

// A cube with a slot of 0.8 voxels. OpenVDB takes voxels beside it for inside, and leaves them out
// of a band of one voxel.
TEST(Voxelize, KnowsTheSidesBesideANarrowBand) {
  const double slot = 0.028;
  const double outline[8][2] = {{-1, -1},    {1, -1},      {1, 1},     {slot, 1},
                                {slot, 0.5}, {-slot, 0.5}, {-slot, 1}, {-1, 1}};
  Mesh mesh;
  for (const double z : {-1, 1}) {
    for (const auto& [x, y] : outline) mesh.positions.emplace_back(x, y, z);
  }
  for (VertexIndex i = 0; i < 8; ++i) {
    const VertexIndex next = (i + 1) % 8;
    mesh.quads.emplace_back(i, next, next + 8, i + 8);
  }
  const VertexIndex caps[6][3] = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {0, 4, 5}, {0, 5, 7}, {5, 6, 7}};
  for (const auto& [a, b, c] : caps) {
    mesh.triangles.emplace_back(a, c, b), mesh.triangles.emplace_back(a + 8, b + 8, c + 8);
  }
  VoxelizeOptions options;
  options.voxelSize = 0.07;
  options.halfWidth = 1;
  const auto narrow = voxelize(mesh, options);
  options.halfWidth = 5;
  const auto wide = voxelize(mesh, options);
  for (auto value = wide->cbeginValueOn(); value; ++value) {
    if (std::abs(*value) < 1e-6f) continue;  // rounding tells the side
    ASSERT_EQ(narrow->tree().getValue(value.getCoord()) < 0, *value < 0) << value.getCoord();
  }
}

TEST(Voxelize, MakesFogVolumes) {
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  options.fog = true;
  const auto grid = voxelize(makeCube(), options);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(0)), 1);
  EXPECT_NEAR(grid->tree().getValue(openvdb::Coord(0, 0, 9)), 1.0 / 3, 1e-5);
}

TEST(Voxelize, DoesNotCareForOrientation) {
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  Mesh turned = makeCube();
  for (Quad& quad : turned.quads) std::reverse(quad.vertices.begin(), quad.vertices.end());
  turned.quads[2] = makeCube().quads[2];
  const auto grid = voxelize(turned, options);
  EXPECT_LT(grid->tree().getValue(openvdb::Coord(0)), 0);
}

TEST(Voxelize, TakesOpenMeshes) {
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  Mesh open = makeCube();
  open.quads.pop_back();
  const auto grid = voxelize(open, options);
  const auto closed = voxelize(makeCube(), options);
  // At the middle of each face that is left, 0.05 in front of it, the distance is that of the cube.
  std::size_t faces = 0;
  for (const Quad& quad : open.quads) {
    Vec3 middle(0.0);
    for (const VertexIndex v : quad.vertices) middle += Vec3(open.positions[v]) * 0.25;
    const Vec3 before = middle + middle.unitOrX() * options.voxelSize;
    const auto place = openvdb::Coord::round(
        grid->transform().worldToIndex(openvdb::Vec3d(before[0], before[1], before[2])));
    EXPECT_TRUE(grid->tree().isValueOn(place)) << place;
    EXPECT_NEAR(grid->tree().getValue(place), closed->tree().getValue(place), 1e-6) << place;
    ++faces;
  }
  EXPECT_EQ(faces, 5u);
}

TEST(Voxelize, RefusesWhatCannotBeDone) {
  const double infinity = std::numeric_limits<double>::infinity();
  VoxelizeOptions options;
  for (const double voxelSize : {0.0, -1.0, infinity, std::nan(""), 1e-12, 1e-320}) {
    options.voxelSize = voxelSize;
    expectError(ErrorCode::InvalidArgument, "voxel size",
                [&] { (void)voxelize(makeCube(), options); });
  }
  options.voxelSize = 0.1;
  options.halfWidth = 0;
  expectError(ErrorCode::InvalidArgument, "half width",
              [&] { (void)voxelize(makeCube(), options); });
  options.halfWidth = 3;
  expectError(ErrorCode::InvalidArgument, "no faces", [&] { (void)voxelize(Mesh(), options); });
  Mesh broken = makeCube();
  broken.triangles.emplace_back(0, 1, 8);
  expectError(ErrorCode::InvalidArgument, "vertex 8", [&] { (void)voxelize(broken, options); });
  broken = makeCube();
  broken.positions[0].x = infinity;
  expectError(ErrorCode::InvalidArgument, "finite", [&] { (void)voxelize(broken, options); });
}

TEST(Voxelize, CanBeCancelled) {
  VoxelizeOptions options;
  options.voxelSize = 0.02;
  options.progress = [](std::string_view, double) { return false; };
  expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)voxelize(makeCube(), options); });
}

// The shells of a mesh were told apart before the first call, for a fifth of a second.
TEST(Voxelize, AsksForCancellationBeforeItTellsShellsApart) {
  int calls = 0, allowed = 0;
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  options.progress = [&](std::string_view, double) { return ++calls <= allowed; };
  Mesh broken = makeCube();
  broken.triangles.emplace_back(0, 1, 8);
  expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)voxelize(broken, options); });
  // And once at least in each of its steps.
  for (allowed = 1; allowed < 5; ++allowed) {
    calls = 0;
    expectError(ErrorCode::Cancelled, "cancelled by the caller",
                [&] { (void)voxelize(makeCube(), options); });
    EXPECT_EQ(calls, allowed + 1);
  }
}

TEST(Voxelize, ProgressEndsAt1) {
  double last = 0;
  VoxelizeOptions options;
  options.voxelSize = 0.02;
  options.progress = [&](std::string_view, double fraction) {
    last = fraction;
    return true;
  };
  (void)voxelize(makeCube(), options);
  EXPECT_EQ(last, 1);
}

/// One vertex far away took 2.3 GB.
TEST(Voxelize, RefusesBandsOfTooManyVoxels) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {Triangle(0, 2, 1), Triangle(0, 1, 3), Triangle(1, 2, 3), Triangle(2, 0, 3)};
  VoxelizeOptions options;
  options.voxelSize = 0.1;
  EXPECT_GT(voxelize(mesh, options)->activeVoxelCount(), 0U);
  mesh.positions[3] = {0, 0, 1e6};
  expectError(ErrorCode::LimitExceeded, "VoxelizeOptions::bandVoxels",
              [&] { (void)voxelize(mesh, options); });
  // A needle of two million voxels has few of them for its blocks.
  mesh.positions[3] = {0, 0, 2e5};
  expectError(ErrorCode::LimitExceeded, "more than 134217728; ",
              [&] { (void)voxelize(mesh, options); });
  mesh.positions[3] = {0, 0, 1};
  options.halfWidth = 1000;
  expectError(ErrorCode::LimitExceeded, "VoxelizeOptions::bandVoxels",
              [&] { (void)voxelize(mesh, options); });
  options.halfWidth = 3;
  options.bandVoxels = 100;
  expectError(ErrorCode::LimitExceeded, "more than 100", [&] { (void)voxelize(mesh, options); });
}

}  // namespace
}  // namespace tufa
