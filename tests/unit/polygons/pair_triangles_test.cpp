#include <gtest/gtest.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/quads.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "support/mesh_oracle.h"
#include "support/shape.h"

namespace tufa {
namespace {

Mesh paired(Mesh mesh, double mostWarp = 0.05) {
  const std::size_t before = mesh.triangleCount();
  const std::size_t made = pairTriangles(mesh, mostWarp);
  EXPECT_EQ(made, mesh.quads.size());
  EXPECT_EQ(mesh.triangleCount(), before);
  return mesh;
}

/// Triangles from their lowest vertex on, in an order of their own.
std::vector<std::array<VertexIndex, 3>> sortedFaces(const Mesh& mesh) {
  std::vector<std::array<VertexIndex, 3>> faces;
  for (const Triangle& t : triangulate(mesh)) {
    auto v = t.vertices;
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    faces.push_back(v);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

/// A sheet of n by m cells of two triangles each, whose diagonals are random; `at(i, j)` places its
/// vertices.
template <class At>
Mesh sheet(int n, int m, const At& at) {
  Mesh mesh;
  std::mt19937 random(7);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= m; ++j) mesh.positions.push_back(at(i, j));
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const auto a = static_cast<VertexIndex>(i * (m + 1) + j), b = a + 1;
      const VertexIndex d = a + static_cast<VertexIndex>(m + 1), c = d + 1;
      if (random() % 2 == 0) {
        mesh.triangles.emplace_back(a, d, c), mesh.triangles.emplace_back(a, c, b);
      } else {
        mesh.triangles.emplace_back(a, d, b), mesh.triangles.emplace_back(b, d, c);
      }
    }
  }
  return mesh;
}

TEST(PairTriangles, MakesAllOfAFlatSheetQuads) {
  const Mesh mesh = sheet(9, 7, [](int i, int j) { return Position(i, j, 0); });
  const Mesh quads = paired(mesh);
  // Corners of the sheet keep their three edges where they have them.
  EXPECT_GE(quads.quads.size(), 9U * 7U - 4U);
  EXPECT_EQ(quads.triangleCount(), mesh.triangleCount());
  EXPECT_EQ(sortedFaces(quads), sortedFaces(mesh));
}

TEST(PairTriangles, FollowsACylinder) {
  const Mesh mesh = sheet(40, 10, [](int i, int j) {
    const double turn = 2 * std::numbers::pi * i / 48;
    return Position(10 * std::cos(turn), 10 * std::sin(turn), j);
  });
  const Mesh quads = paired(mesh);
  EXPECT_GE(quads.quads.size(), 40U * 10U - 4U);
  EXPECT_EQ(sortedFaces(quads), sortedFaces(mesh));
}

TEST(PairTriangles, LeavesWhatIsBentBothWays) {
  const Mesh mesh =
      sheet(10, 10, [](int i, int j) { return Position(i, j, 0.06 * (i - 5) * (j - 5)); });
  EXPECT_LT(paired(mesh, 0.001).quads.size(), 5U);
  EXPECT_GT(paired(mesh, 0.1).quads.size(), 90U);
}

TEST(PairTriangles, LeavesCreasesAndNeedles) {
  Mesh roof;
  roof.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0.3}, {-1, 0, 0.3}};
  roof.triangles = {{0, 2, 1}, {0, 1, 3}};
  EXPECT_TRUE(paired(roof).quads.empty());
  // Two needles, flat: a corner of 5 degrees.
  Mesh kite;
  kite.positions = {{0, 0, 0}, {10, 0, 0}, {5, 0.2, 0}, {5, -0.2, 0}};
  kite.triangles = {{0, 1, 2}, {0, 3, 1}};
  EXPECT_TRUE(paired(kite).quads.empty());
}

TEST(PairTriangles, KeepsThreeEdgesAtEachVertex) {
  // A box: a quad for each side, as each corner still has three.
  const Mesh mesh = paired(contour(*test::shapeOf(Shape::Box, 0.05)));
  EXPECT_EQ(mesh.quads.size(), 6U);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(test::inspect(mesh).manifold());
  EXPECT_TRUE(test::inspect(mesh).closed());
}

TEST(PairTriangles, OfAPartKeepsItsSurface) {
  const Mesh triangles = contour(*test::shapeOf(Shape::Bracket, 0.03));
  const Mesh quads = paired(triangles, 0.1 * 0.03);
  EXPECT_EQ(sortedFaces(quads), sortedFaces(triangles));
  EXPECT_GT(5 * quads.quads.size(), quads.triangleCount());  // 40% of the triangles and more
  const test::MeshTopology topology = test::inspect(quads);
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  EXPECT_EQ(topology.euler(), test::inspect(triangles).euler());
}

TEST(PairTriangles, RefusesVerticesThatAreNotThereAndABadWarp) {
  Mesh mesh = sheet(2, 2, [](int i, int j) { return Position(i, j, 0); });
  EXPECT_THROW((void)pairTriangles(mesh, -1), Error);
  EXPECT_THROW((void)pairTriangles(mesh, std::nan("")), Error);
  mesh.triangles.emplace_back(0, 1, 9);
  EXPECT_THROW((void)pairTriangles(mesh, 0), Error);
}

}  // namespace
}  // namespace tufa
