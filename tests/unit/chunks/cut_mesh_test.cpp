// The uniform mesh divided at the planes between chunks.

#include "chunks/cut/cut_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "chunks/cut/flip_caps.h"
#include "chunks/cut/join_vertices.h"
#include "chunks/cut/move_to_planes.h"
#include "chunks/cut/separate_rounded.h"
#include "support/mesh_oracle.h"
#include "support/model.h"

namespace tufa::chunks {
namespace {

constexpr int kChunk = 16;

struct Cut {
  test::ModelOf model;
  CutMesh mesh;

  explicit Cut(const openvdb::FloatGrid::Ptr& grid, double flatDistance = 0)
      : model(grid),
        mesh(cutAtChunks(model.mesh(), model.model().affine(), kChunk, true, flatDistance,
                         model.job())) {}

  [[nodiscard]] Vec3 latticeOf(VertexIndex v) const {
    return model.model().affine().latticePoint(mesh.mesh.positions[v], Coord(0));
  }
};

// Each triangle in its chunk, each vertex of two chunks on a plane, the surface as before.
void expectDivided(const Cut& cut, double uniformArea) {
  const CutMesh& mesh = cut.mesh;
  const test::MeshTopology topology = test::inspect(mesh.mesh),
                           before = test::inspect(cut.model.mesh());
  EXPECT_TRUE(topology.closed()) << topology;
  EXPECT_EQ(topology.euler(), before.euler());
  EXPECT_EQ(topology.nonManifoldEdges + topology.nonManifoldVertices + topology.misorientedEdges,
            0U);
  EXPECT_NEAR(test::area(mesh.mesh), uniformArea, 2e-3 * uniformArea);
  EXPECT_LT(mesh.moved, 0.02);
  std::vector<std::set<std::uint32_t>> chunksAt(mesh.mesh.positions.size());
  for (std::size_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    const Coord& chunk = mesh.chunks[mesh.chunkOf[t]];
    for (const VertexIndex v : mesh.mesh.triangles[t].vertices) {
      chunksAt[v].insert(mesh.chunkOf[t]);
      const Vec3 at = cut.latticeOf(v);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(at[axis], kChunk * chunk[axis] - 1e-9);
        EXPECT_LE(at[axis], kChunk * (chunk[axis] + 1) + 1e-9);
      }
    }
  }
  for (VertexIndex v = 0; v < chunksAt.size(); ++v) {
    if (chunksAt[v].size() < 2) continue;
    ASSERT_NE(mesh.planesAt(v)[0], ChunkPlane::kNone);
    const ChunkPlane& plane = mesh.planes[mesh.planesAt(v)[0]];
    EXPECT_NEAR(cut.latticeOf(v)[plane.axis], kChunk * plane.at, 1e-9);
  }
  EXPECT_TRUE(std::is_sorted(mesh.chunks.begin(), mesh.chunks.end()));
}

TEST(CutMesh, DividesABall) {
  const Cut cut(test::ballOf(21.3, 0.5));
  EXPECT_EQ(cut.mesh.chunks.size(), 32U);  // those around the origin and beside them
  expectDivided(cut, test::area(test::triangulated(cut.model.mesh())));
}

openvdb::FloatGrid::Ptr boxOf(const Vec3& half) {
  return test::levelSetOf(24, 0.1, [half](const Vec3& p) {
    double outside = 0, inside = -1e9;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = std::abs(p[axis]) - half[axis];
      outside += std::max(d, 0.0) * std::max(d, 0.0), inside = std::max(inside, d);
    }
    return inside > 0 ? std::sqrt(outside) : inside;
  });
}

// Four of its faces lie in planes between chunks but for rounding.
TEST(CutMesh, LeavesFacesInPlanesWhole) {
  const Cut cut(boxOf({16, 16, 9.4}));
  EXPECT_EQ(cut.mesh.chunks.size(), 8U);
  expectDivided(cut, test::area(test::triangulated(cut.model.mesh())));
}

// Four of its faces lie a hundredth of a voxel beside planes.
TEST(CutMesh, MovesFacesToPlanesAndSaysHowFar) {
  const openvdb::FloatGrid::Ptr box = boxOf({16.012, 16.012, 9.4});
  const Cut near(box);
  EXPECT_GT(near.mesh.chunks.size(), 8U);
  EXPECT_TRUE(near.mesh.far.empty());
  const Cut cut(box, 0.02);
  EXPECT_EQ(cut.mesh.chunks.size(), 8U);
  expectDivided(cut, test::area(test::triangulated(cut.model.mesh())));
  EXPECT_LT(cut.mesh.moved, 0.006);
  std::vector<double> most(cut.mesh.mesh.positions.size(), cut.mesh.moved);
  for (const CutMesh::Far& far : cut.mesh.far) most[far.vertex] += far.more;
  const Mesh& uniform = cut.model.mesh();
  double farthest = 0;
  for (std::size_t v = 0; v < uniform.positions.size(); ++v) {
    const double by = (Vec3(cut.mesh.mesh.positions[v]) - Vec3(uniform.positions[v])).length() /
                      cut.model.voxelSize();
    EXPECT_LE(by, most[v] + 1e-9) << v;
    farthest = std::max(farthest, by);
  }
  EXPECT_GT(farthest, 0.01);
}

// A sheet across the plane x = 8 of chunks of eight voxels, whose vertices have these heights in
// columns around it; it is cut there already. Which columns were moved to the plane z = 0.
std::vector<bool> movedColumns(const std::vector<double>& heights, double flatDistance = 0,
                               VertexIndex rows = 6) {
  constexpr double kColumns[] = {6.5, 7.5, 8, 8.5, 9.5};
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  for (VertexIndex x = 0; x < 5; ++x) {
    for (VertexIndex y = 0; y < rows; ++y) points.emplace_back(kColumns[x], y + 0.5, heights[x]);
  }
  for (VertexIndex x = 0; x + 1 < 5; ++x) {
    for (VertexIndex y = 0; y + 1 < rows; ++y) {
      const VertexIndex v = x * rows + y;
      triangles.emplace_back(v, v + rows, v + 1);
      triangles.emplace_back(v + 1, v + rows, v + rows + 1);
    }
  }
  base::Job job(1, {});
  (void)moveToPlanes(ChunkPlanes(Coord(0), 8), 2, flatDistance, triangles, points, job);
  std::vector<bool> moved;
  for (VertexIndex x = 0; x < 5; ++x) {
    for (VertexIndex y = 0; y < rows; ++y) {
      const bool isOn = points[x * rows + y][2] == 0;
      if (y == 0) moved.push_back(isOn);
      EXPECT_EQ(isOn, moved.back()) << kColumns[x] << ' ' << y;
    }
  }
  return moved;
}

// Else all vertices of the column would be ends of curves.
TEST(MoveToPlanes, LeavesVerticesOnOtherPlanesWhereASheetLeavesThePlane) {
  using Columns = std::vector<bool>;
  EXPECT_EQ(movedColumns({0.001, 0.001, 0.001, 0.001, 0.001}), Columns(5, true));
  EXPECT_EQ(movedColumns({0.001, 0.001, -0.002, -0.006, -0.03}),
            (Columns{true, true, false, false, false}));
  EXPECT_EQ(movedColumns({-0.03, -0.006, -0.003, -0.001, 0.001}),
            (Columns{false, false, false, true, true}));
  // Too near to be told from the plane.
  EXPECT_EQ(movedColumns({0.001, 0.001, -1e-5, -0.006, -0.03}),
            (Columns{true, true, true, false, false}));
}

TEST(MoveToPlanes, MovesManyVerticesFartherWhereASheetLiesAlongThePlane) {
  using Columns = std::vector<bool>;
  const std::vector<double> beside(5, 0.012);
  EXPECT_EQ(movedColumns(beside, 0.02, 40), Columns(5, true));
  EXPECT_EQ(movedColumns(beside, 0.02, 6), Columns(5, false));
  EXPECT_EQ(movedColumns(beside, 0.01, 40), Columns(5, false));
  EXPECT_EQ(movedColumns(beside, 0, 40), Columns(5, false));
  EXPECT_EQ(movedColumns({0.012, 0.012, 0.012, 0.012, -0.3}, 0.02, 40),
            (Columns{true, true, true, true, false}));
}

TEST(CutMesh, IsTheSameForAnyNumberOfThreads) {
  const auto make = [](int threads) {
    ContourOptions options;
    base::Job job(threads, {});
    CutMesh out;
    job.run([&] {
      const test::ModelOf model(test::ballOf(21.3, 0.5), options);
      out = cutAtChunks(model.mesh(), model.model().affine(), kChunk, true, 0, job);
    });
    return out;
  };
  const CutMesh one = make(1), two = make(2);
  EXPECT_TRUE(test::sameBytes(one.mesh, two.mesh));
  EXPECT_TRUE(std::ranges::equal(one.chunkOf, two.chunkOf));
}

// A fan around the origin, of which one vertex is near its neighbour.
TEST(JoinNearVertices, CollapsesShortEdgesWhereTheTopologyAllowsIt) {
  const std::vector<Vec3> points = {{0, 0, 1},  {1, 0, 0},     {0, 1, 0}, {-1, 0, 0},
                                    {0, -1, 0}, {1e-5, -1, 0}, {0, 0, -1}};
  const auto octahedron = [] {
    return std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                                 {6, 2, 1}, {6, 3, 2}, {6, 4, 3}, {6, 5, 4}, {6, 1, 5}};
  };
  base::Job job(1, {});
  std::vector<Triangle> joined = octahedron();
  std::vector<VertexIndex> changed;
  const auto always = [](VertexIndex, VertexIndex) { return true; };
  EXPECT_NEAR(joinNearVertices(points, 1e-3, {}, always, joined, changed, job), 1e-5, 1e-12);
  EXPECT_EQ(joined.size(), 8U);
  EXPECT_EQ(changed, std::vector<VertexIndex>{4});
  Mesh mesh;
  mesh.positions.assign(points.begin(), points.end());
  mesh.triangles = joined;
  EXPECT_TRUE(test::inspect(mesh).closed());
  EXPECT_EQ(test::inspect(mesh).nonManifoldEdges, 0U);
  std::vector<Triangle> kept = octahedron();
  const auto never = [](VertexIndex, VertexIndex) { return false; };
  EXPECT_EQ(joinNearVertices(points, 1e-3, {}, never, kept, changed, job), 0);
  EXPECT_EQ(kept, octahedron());
  // An edge of a tetrahedron cannot go, however short.
  const std::vector<Vec3> few = {{0, 0, 0}, {1e-5, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<Triangle> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(joinNearVertices(few, 1e-3, {}, always, tetrahedron, changed, job), 0);
  EXPECT_EQ(tetrahedron.size(), 4U);
}

// The vertex in the middle of an edge of a square's two triangles.
TEST(FlipCaps, TurnsTheEdgeThatAVertexLiesOn) {
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 1e-6, 0}};
  base::Job job(1, {});
  std::vector<Triangle> triangles = {{0, 1, 2}, {1, 0, 3}};
  std::vector<VertexIndex> changed;
  const std::vector<Triangle> before = triangles;
  const auto never = [](const std::array<VertexIndex, 4>&) { return false; };
  EXPECT_EQ(flipCaps(points, 1e-4, {}, never, triangles, changed, job), 0);
  EXPECT_EQ(triangles, before);
  EXPECT_TRUE(changed.empty());
  const std::vector<std::uint8_t> marks = {0, 0, 1, 0};  // on the square's far corner
  const auto always = [](const std::array<VertexIndex, 4>&) { return true; };
  EXPECT_EQ(flipCaps(points, 1e-4, marks, always, triangles, changed, job), 0);
  EXPECT_NEAR(flipCaps(points, 1e-4, {}, always, triangles, changed, job), 1e-6, 1e-12);
  EXPECT_EQ(changed.size(), 4U);
  ASSERT_EQ(triangles.size(), 2U);
  for (const Triangle& t : triangles) {
    const Vec3 n = (points[t.vertices[1]] - points[t.vertices[0]])
                       .cross(points[t.vertices[2]] - points[t.vertices[0]]);
    EXPECT_NEAR(n[2], 2, 1e-4);  // half of what the two were
  }
}

// Far from the origin, what lay apart is at one place in world space.
TEST(CutMesh, KeepsVerticesApartThatAreRoundedToOnePlace) {
  base::Job job(1, {});
  const auto far = openvdb::math::Transform::createLinearTransform(0.5);
  far->postTranslate(openvdb::Vec3d(1e6, 0, 0));
  const grid::Affine affine{grid::Transform(*far)};
  for (const bool singlePrecision : {false, true}) {
    CutMesh cut;
    cut.mesh.positions = {{1, 0, 0}, {1 + 1e-13, 0, 0}, {1 + 2e-13, 0, 0}, {2, 0, 0}};
    cut.mesh.triangles = {{0, 1, 2}, {1, 2, 3}};
    keepApart(cut, affine, singlePrecision, job);
    std::set<double> places;
    for (const Position& p : cut.mesh.positions) {
      const double x = affine.toWorld(p).x;
      places.insert(singlePrecision ? static_cast<double>(static_cast<float>(x)) : x);
    }
    EXPECT_EQ(places.size(), 4u);
    EXPECT_EQ(cut.mesh.positions[3].x, 2);
    EXPECT_GT(cut.moved, 0);
    EXPECT_LE(cut.moved, singlePrecision ? 0.3 : 1e-9);
  }
}

// One vertex of each pair at one place moves, and no other one, for any threads.
TEST(CutMesh, FindsVerticesAtOnePlaceAmongMany) {
  constexpr VertexIndex kCount = 60000, kStep = 20000;
  const grid::Affine affine{grid::Transform(*openvdb::math::Transform::createLinearTransform(1))};
  std::vector<CutMesh> cuts(2);
  for (int i = 0; i < 2; ++i) {
    CutMesh& cut = cuts[static_cast<std::size_t>(i)];
    for (VertexIndex v = 0; v < kCount; ++v) {
      const VertexIndex n = v % kStep == 7 ? 7 : v;  // three at the place of vertex 7
      cut.mesh.positions.push_back(
          {0.1F * static_cast<float>(n % 200), 0.1F * static_cast<float>(n / 200), 0.25});
    }
    for (VertexIndex v = 0; v + 2 < kCount; v += 2) cut.mesh.triangles.push_back({v, v + 1, v + 2});
    const std::vector<Position> before = cut.mesh.positions;
    base::Job job(1 + 2 * i, {});
    job.run([&] { keepApart(cut, affine, true, job); });
    std::size_t moved = 0;
    for (VertexIndex v = 0; v < kCount; ++v) {
      if (cut.mesh.positions[v] == before[v]) continue;
      EXPECT_EQ(v % kStep, 7U);
      ++moved;
    }
    EXPECT_EQ(moved, 2U);
    EXPECT_LE(cut.moved, 1e-5);
  }
  EXPECT_EQ(cuts[0].mesh.positions, cuts[1].mesh.positions);
}

// Next to 0 there are more numbers than anyone can count through, and index space knows few of
// them.
TEST(CutMesh, KeepsVerticesApartThatAreRoundedToTheOrigin) {
  base::Job job(1, {});
  const auto moved = openvdb::math::Transform::createLinearTransform(0.5);
  moved->postTranslate(openvdb::Vec3d(-2.5, 0, 0));
  const grid::Affine affine{grid::Transform(*moved)};
  for (const bool singlePrecision : {false, true}) {
    CutMesh cut;
    cut.mesh.positions = {{2.5, 1, 0}, {2.5, 1, 0}, {2.5, 1, 0}, {2.5, 1, 0}};
    cut.mesh.triangles = {{0, 1, 2}};  // the last vertex is none of the mesh's any more
    keepApart(cut, affine, singlePrecision, job);
    std::set<double> places;
    for (int i = 0; i < 3; ++i) places.insert(affine.toWorld(cut.mesh.positions[i]).x);
    EXPECT_EQ(places.size(), 3u);
    EXPECT_EQ(cut.mesh.positions[3].x, 2.5);
    EXPECT_GT(cut.moved, 0);
    EXPECT_LE(cut.moved, 1e-14);
  }
}

}  // namespace
}  // namespace tufa::chunks
