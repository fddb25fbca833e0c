// The uniform mesh divided at the planes between chunks.

#include "chunks/cut/cut_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "chunks/cut/flip_caps.h"
#include "chunks/cut/join_vertices.h"
#include "chunks/cut/move_to_planes.h"
#include "chunks/cut/push_apart.h"
#include "chunks/cut/separate_rounded.h"
#include "chunks/cut/surface_moves.h"
#include "chunks/cut/turned.h"
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
  EXPECT_LT(mesh.moved, 1e-6);
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
  for (const MovedVertex& moved : near.mesh.movedAt) EXPECT_LT(moved.by, 0.012);
  const Cut cut(box, 0.02);
  EXPECT_EQ(cut.mesh.chunks.size(), 8U);
  expectDivided(cut, test::area(test::triangulated(cut.model.mesh())));
  std::vector<double> most(cut.mesh.mesh.positions.size(), cut.mesh.moved);
  for (const MovedVertex& moved : cut.mesh.movedAt) most[moved.vertex] += moved.by;
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
  std::vector<MovedVertex> changed;
  const auto always = [](VertexIndex, VertexIndex) { return true; };
  joinNearVertices(points, 1e-3, false, {}, always, joined, changed, job);
  EXPECT_EQ(joined.size(), 8U);
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].vertex + changed[1].vertex, 4U + 5U);
  for (const MovedVertex& end : changed) EXPECT_NEAR(end.by, 1e-5, 1e-12);
  changed.clear();
  Mesh mesh;
  mesh.positions.assign(points.begin(), points.end());
  mesh.triangles = joined;
  EXPECT_TRUE(test::inspect(mesh).closed());
  EXPECT_EQ(test::inspect(mesh).nonManifoldEdges, 0U);
  std::vector<Triangle> kept = octahedron();
  const auto never = [](VertexIndex, VertexIndex) { return false; };
  joinNearVertices(points, 1e-3, false, {}, never, kept, changed, job);
  EXPECT_EQ(kept, octahedron());
  // An edge of a tetrahedron cannot go, however short.
  const std::vector<Vec3> few = {{0, 0, 0}, {1e-5, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<Triangle> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  joinNearVertices(few, 1e-3, false, {}, always, tetrahedron, changed, job);
  EXPECT_EQ(tetrahedron.size(), 4U);
  EXPECT_TRUE(changed.empty());
}

// Two sheets that meet along a strip as narrow as the edges that go: collapsed, they would be
// neighbours, one lying on the other. Every other edge of the strip may go.
TEST(JoinNearVertices, MakesNoFoldsUnlessTold) {
  constexpr double kThin = 1e-5, kOpening = 0.02;
  constexpr VertexIndex kRows = 6;
  std::vector<Vec3> points;
  for (VertexIndex i = 0; i < kRows; ++i) {
    points.insert(points.end(), {{1, double(i), kOpening},
                                 {0, double(i), kThin},
                                 {0, double(i), 0},
                                 {1, double(i), -kOpening}});
  }
  std::vector<Triangle> triangles;
  for (VertexIndex i = 0; i + 1 < kRows; ++i) {
    for (VertexIndex c = 0; c < 3; ++c) {
      const VertexIndex a = 4 * i + c, b = a + 1, d = a + 4, e = a + 5;
      triangles.insert(triangles.end(), {{a, b, d}, {b, e, d}});
    }
  }
  base::Job job(1, {});
  const auto always = [](VertexIndex, VertexIndex) { return true; };
  std::vector<MovedVertex> changed;
  const auto countFolds = [&] {
    const auto normalOf = [&](const Triangle& t) {
      const Vec3 p = points[t.vertices[0]];
      return (points[t.vertices[1]] - p).cross(points[t.vertices[2]] - p);
    };
    std::map<std::pair<VertexIndex, VertexIndex>, Vec3> normals;
    for (const Triangle& t : triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        normals[{t.vertices[i], t.vertices[(i + 1) % 3]}] = normalOf(t);
      }
    }
    int folds = 0;
    for (const auto& [edge, normal] : normals) {
      const auto other = normals.find({edge.second, edge.first});
      if (other != normals.end() && isFold(normal, other->second)) ++folds;
    }
    return folds;
  };
  ASSERT_EQ(countFolds(), 0);
  joinNearVertices(points, 1e-3, false, {}, always, triangles, changed, job);
  EXPECT_EQ(countFolds(), 0);
  joinNearVertices(points, 1e-3, true, {}, always, triangles, changed, job);
  EXPECT_GT(countFolds(), 0);
}

// The vertex of a sheet has gone through another one by rounding.
TEST(PushApart, TakesVerticesBackThatHavePassedATriangle) {
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
  const auto pointsWith = [](double depth) {
    return std::vector<Vec3>{{-1, -1, 0},    {1, -1, 0}, {0, 1, 0},
                             {0, 0, -depth}, {1, 0, 1},  {-1, 0, 1}};
  };
  const std::vector<intersect::PolygonPair> pairs = {{0, 1}};
  const auto always = [](VertexIndex, const Vec3&) { return true; };
  std::vector<Vec3> points = pointsWith(1e-6);
  std::vector<MovedVertex> moved;
  pushApart(triangles, pairs, 1e-3, always, points, moved);
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(moved[0].vertex, 3U);
  EXPECT_NEAR(points[3][2], 1e-3, 1e-12);
  EXPECT_NEAR(moved[0].by, 1e-3 + 1e-6, 1e-12);
  // Not where that may not be, nor by more than the surface is to be moved.
  std::vector<Vec3> held = pointsWith(1e-6);
  moved.clear();
  pushApart(
      triangles, pairs, 1e-3, [](VertexIndex v, const Vec3&) { return v != 3; }, held, moved);
  EXPECT_TRUE(moved.empty());
  std::vector<Vec3> deep = pointsWith(0.5);
  pushApart(triangles, pairs, 1e-3, always, deep, moved);
  EXPECT_TRUE(moved.empty());
}

// The vertex in the middle of an edge of a square's two triangles.
TEST(FlipCaps, TurnsTheEdgeThatAVertexLiesOn) {
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 1e-6, 0}};
  base::Job job(1, {});
  std::vector<Triangle> triangles = {{0, 1, 2}, {1, 0, 3}};
  std::vector<MovedVertex> changed;
  const std::vector<Triangle> before = triangles;
  const auto never = [](const std::array<VertexIndex, 4>&) { return false; };
  flipCaps(points, 1e-4, {}, never, triangles, changed, job);
  EXPECT_EQ(triangles, before);
  EXPECT_TRUE(changed.empty());
  const std::vector<std::uint8_t> marks = {0, 0, 1, 0};  // on the square's far corner
  const auto always = [](const std::array<VertexIndex, 4>&) { return true; };
  flipCaps(points, 1e-4, marks, always, triangles, changed, job);
  EXPECT_TRUE(changed.empty());
  flipCaps(points, 1e-4, {}, always, triangles, changed, job);
  EXPECT_EQ(changed.size(), 4U);
  for (const MovedVertex& corner : changed) EXPECT_NEAR(corner.by, 1e-6, 1e-12);
  ASSERT_EQ(triangles.size(), 2U);
  for (const Triangle& t : triangles) {
    const Vec3 n = (points[t.vertices[1]] - points[t.vertices[0]])
                       .cross(points[t.vertices[2]] - points[t.vertices[0]]);
    EXPECT_NEAR(n[2], 2, 1e-4);  // half of what the two were
  }
}

// A strip of triangles along two rows of vertices, even ones below and odd ones above.
TEST(SurfaceMoves, AddUpWhereChangesMeetAndOnlyThere) {
  constexpr VertexIndex kCount = 20;
  std::vector<Triangle> strip;
  for (VertexIndex v = 0; v + 2 < kCount; ++v) strip.push_back({v, v + 1, v + 2});
  base::Job job(1, {});
  const auto movedAfter = [&](const auto& change) {
    SurfaceMoves moves;
    moves.reserve(kCount, kCount, job);
    change(moves);
    std::vector<double> by(kCount, 0);
    for (const auto& [v, most] : moves.take(strip, job)) by[v] = most;
    return by;
  };
  using Kind = SurfaceMoves::Kind;
  // The triangles at a vertex that has moved are those of vertices up to two places on.
  const std::vector<double> once = movedAfter([&](SurfaceMoves& moves) {
    moves.add(Kind::Places, strip, {{9, 0.5}}, job);
  });
  for (VertexIndex v = 0; v < kCount; ++v) EXPECT_EQ(once[v], v >= 7 && v <= 11 ? 0.5 : 0) << v;
  // A second move beside it is on top of the first one, and far from it is not.
  const std::vector<double> twice = movedAfter([&](SurfaceMoves& moves) {
    moves.add(Kind::Places, strip, {{9, 0.5}}, job);
    moves.add(Kind::Places, strip, {{10, 0.25}, {17, 0.25}}, job);
  });
  EXPECT_EQ(twice[10], 0.75);
  EXPECT_EQ(twice[17], 0.25);
  EXPECT_EQ(twice[3], 0);
  // Collapses that hang together: what the first vertex had goes on to the last one.
  const std::vector<double> chain = movedAfter([&](SurfaceMoves& moves) {
    moves.add(Kind::Places, strip, {{4, 0.5}}, job);
    moves.add(Kind::Triangles, strip, {{5, 0.125}, {7, 0.125}, {9, 0.25}, {16, 0.125}}, job);
  });
  EXPECT_EQ(chain[9], 0.75);
  EXPECT_EQ(chain[5], 0.75);
  EXPECT_EQ(chain[16], 0.125);
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
