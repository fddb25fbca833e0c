#include "intersect/surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "support/mesh_oracle.h"

namespace tufa::intersect {
namespace {

using Polygons = std::vector<PolygonIndex>;

Polygons allOf(const Surface& surface) {
  Polygons all(surface.size());
  std::iota(all.begin(), all.end(), PolygonIndex{0});
  return all;
}

Mesh cube() {
  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  cube.quads = {Quad(0, 2, 3, 1), Quad(4, 5, 7, 6), Quad(0, 1, 5, 4),
                Quad(2, 6, 7, 3), Quad(0, 4, 6, 2), Quad(1, 3, 7, 5)};
  return cube;
}

// Two quads that cross in the middle, and a triangle above both.
Mesh crossing() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 1, -2}, {2, 3, -2},
                    {2, 3, 2}, {2, 1, 2}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  mesh.quads = {Quad(0, 1, 2, 3), Quad(4, 5, 6, 7)};
  mesh.triangles = {Triangle(8, 9, 10)};
  return mesh;
}

TEST(Surface, NumbersQuadsBeforeTriangles) {
  Mesh mesh = crossing();
  base::Job job(1, {});
  const Surface surface(mesh, job);
  ASSERT_EQ(surface.size(), 3U);
  EXPECT_TRUE(surface.isQuad(1));
  EXPECT_FALSE(surface.isQuad(2));
  const auto corners = surface.corners(2);
  EXPECT_EQ(Polygons(corners.begin(), corners.end()), (Polygons{8, 9, 10}));
  std::array<Triangle, 2> triangles;
  EXPECT_EQ(trianglesOf(surface.corners(0), triangles), 2);
  EXPECT_EQ(triangles[0], Triangle(0, 1, 2));
  EXPECT_EQ(triangles[1], Triangle(0, 2, 3));
  EXPECT_EQ(trianglesOf(corners, triangles), 1);
}

TEST(Surface, TurnsAQuadToItsOtherDiagonal) {
  Mesh mesh = cube();
  base::Job job(1, {});
  Surface surface(mesh, job);
  surface.turn(0);
  surface.finish();
  std::array<Triangle, 2> triangles;
  (void)trianglesOf(surface.corners(0), triangles);
  // 2 and 1 are on both, 0 and 3 were.
  for (const Triangle& triangle : triangles) {
    for (const VertexIndex vertex : {VertexIndex{2}, VertexIndex{1}}) {
      EXPECT_NE(std::find(triangle.vertices.begin(), triangle.vertices.end(), vertex),
                triangle.vertices.end());
    }
  }
  EXPECT_NEAR(test::volume(mesh), 1, 1e-12) << "still outward";
  EXPECT_TRUE(test::inspect(mesh).manifold());
}

TEST(Surface, PutsAFanInPlaceOfAQuad) {
  Mesh mesh = cube();
  base::Job job(1, {});
  Surface surface(mesh, job);
  surface.fan(1, Position(0.5, 0.5, 1.5));
  EXPECT_TRUE(surface.corners(1).empty());
  EXPECT_EQ(surface.size(), 6U + 4U) << "quads keep their numbers";
  EXPECT_EQ(surface.corners(2)[1], 1U);
  surface.finish();
  EXPECT_EQ(mesh.quads.size(), 5U);
  EXPECT_EQ(mesh.triangles.size(), 4U);
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.closed() && topology.manifold()) << topology;
  EXPECT_NEAR(test::volume(mesh), 1 + 0.5 / 3, 1e-12) << "with a pyramid on top";
}

TEST(Surface, KnowsWherePolygonsWentOnceTold) {
  Mesh mesh = crossing();
  base::Job job(1, {});
  Surface surface(mesh, job);
  for (VertexIndex vertex = 4; vertex < 8; ++vertex) {
    const Position& p = mesh.positions[vertex];
    surface.move(vertex, {p.x + 100, p.y, p.z});
  }
  surface.update(1);
  EXPECT_EQ(surface.box(1).lower[0], 102);
  EXPECT_TRUE(findPairs(surface, allOf(surface), job).empty());
  EXPECT_TRUE(surface.runBox(0).meets(surface.box(1)));
}

TEST(FindPairs, NamesThePolygonsThatIntersect) {
  Mesh mesh = crossing();
  base::Job job(1, {});
  const Surface surface(mesh, job);
  EXPECT_EQ(findPairs(surface, {0, 1, 2}, job), (std::vector<PolygonPair>{{0, 1}}));
  EXPECT_EQ(findPairs(surface, {1}, job), (std::vector<PolygonPair>{{0, 1}})) << "one is enough";
  EXPECT_TRUE(findPairs(surface, {2}, job).empty()) << "no candidate among the two";
  const auto none = [](PolygonIndex, PolygonIndex) { return false; };
  EXPECT_TRUE(findPairs(surface, {0, 1, 2}, job, none).empty());
}

TEST(FindPairs, NamesAFoldedQuadAsAPairWithItself) {
  Mesh mesh;
  // Its second triangle lies flat on the first.
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 1, 0}};
  mesh.quads = {Quad(0, 1, 2, 3)};
  base::Job job(1, {});
  const Surface surface(mesh, job);
  EXPECT_EQ(findPairs(surface, {0}, job), (std::vector<PolygonPair>{{0, 0}}));
}

// More polygons than share a box, against each pair asked for itself.
TEST(FindPairs, FindsAllPairsOfARandomSoup) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(0, 6), step(-1, 1);
  Mesh mesh;
  const auto add = [&](int corners) {
    const Position middle(place(random), place(random), place(random));
    for (int i = 0; i < corners; ++i) {
      mesh.positions.emplace_back(middle.x + step(random), middle.y + step(random),
                                  middle.z + step(random));
    }
    return static_cast<VertexIndex>(mesh.positions.size()) - static_cast<VertexIndex>(corners);
  };
  for (int i = 0; i < 100; ++i) {
    const VertexIndex quad = add(4), triangle = add(3);
    mesh.quads.emplace_back(quad, quad + 1, quad + 2, quad + 3);
    mesh.triangles.emplace_back(triangle, triangle + 1, triangle + 2);
  }
  base::Job job(2, {});
  const Surface surface(mesh, job);
  ASSERT_GT(surface.runCount(), 4U);
  std::vector<PolygonPair> expected;
  for (PolygonIndex a = 0; a < surface.size(); ++a) {
    for (PolygonIndex b = a; b < surface.size(); ++b) {
      if (a == b && !surface.isQuad(a)) continue;
      if (intersectElsewhere(mesh.positions, surface.corners(a), surface.corners(b), a == b)) {
        expected.push_back({a, b});
      }
    }
  }
  EXPECT_GT(expected.size(), 50U);
  EXPECT_EQ(findPairs(surface, allOf(surface), job), expected);
}

// A crumpled sheet: most pairs of its quads share an edge or a vertex. What intersects once its
// vertices are moved was close before.
TEST(FindClosePairs, HoldsWhatComesToIntersect) {
  constexpr int kSide = 12;
  constexpr double kMargin = 0.2;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-0.45, 0.45), height(-1, 1), way(-1, 1);
  std::size_t later = 0, all = 0, close = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Mesh mesh;
    for (int i = 0; i < kSide * kSide; ++i) {
      mesh.positions.emplace_back(i % kSide + place(random), i / kSide + place(random),
                                  height(random));
    }
    for (int y = 0; y + 1 < kSide; ++y) {
      for (int x = 0; x + 1 < kSide; ++x) {
        const auto at = static_cast<VertexIndex>(y * kSide + x);
        mesh.quads.emplace_back(at, at + 1, at + kSide + 1, at + kSide);
      }
    }
    base::Job job(2, {});
    const Surface surface(mesh, job);
    const ClosePairs found = findClosePairs(surface, allOf(surface), kMargin, job);
    EXPECT_EQ(found.intersecting, findPairs(surface, allOf(surface), job));
    const std::vector<PolygonPair>& pairs = found.close;
    EXPECT_TRUE(std::includes(pairs.begin(), pairs.end(), found.intersecting.begin(),
                              found.intersecting.end()));
    EXPECT_EQ(intersectingAmong(pairs, mesh, mesh.positions, job), found.intersecting);
    close += pairs.size();
    for (int jitter = 0; jitter < 20; ++jitter) {
      Mesh moved = mesh;
      for (Position& p : moved.positions) {
        Vec3 to(way(random), way(random), way(random));
        if (!to.normalize()) continue;
        p = Vec3(p) + to * (kMargin / 2);
      }
      const Surface other(moved, job);
      const std::vector<PolygonPair> after = findPairs(other, allOf(other), job);
      EXPECT_TRUE(std::includes(pairs.begin(), pairs.end(), after.begin(), after.end()));
      EXPECT_EQ(intersectingAmong(pairs, mesh, moved.positions, job), after);
      all += after.size();
      for (const PolygonPair& pair : after) {
        later += std::binary_search(found.intersecting.begin(), found.intersecting.end(), pair)
                     ? 0U
                     : 1U;
      }
    }
  }
  EXPECT_GT(later, 100U) << "pairs that only moving made";
  EXPECT_GT(all, later);
  EXPECT_LT(close, std::size_t{20} * kSide * kSide * 4) << "most pairs of neighbours are not";
}

TEST(PolygonsOf, AreThoseOfPairsAsOftenAsTheyOccur) {
  const Polygons polygons = polygonsOf({{1, 4}, {1, 1}, {2, 4}});
  EXPECT_EQ(std::count(polygons.begin(), polygons.end(), 4U), 2);
  EXPECT_EQ(std::count(polygons.begin(), polygons.end(), 2U), 1);
  EXPECT_EQ(std::count(polygons.begin(), polygons.end(), 1U), 3);
  EXPECT_EQ(distinctPolygonsOf({{1, 4}, {1, 1}, {2, 4}}), (Polygons{1, 2, 4}));
}

TEST(VerticesOf, AreSortedAndDistinct) {
  EXPECT_EQ(verticesOf(cube(), {1, 2}), (std::vector<VertexIndex>{0, 1, 4, 5, 6, 7}));
  EXPECT_EQ(verticesOf(crossing(), {2, 2}), (std::vector<VertexIndex>{8, 9, 10}));
}

}  // namespace
}  // namespace tufa::intersect
