#include "refine/collapse/partition.h"

#include <gtest/gtest.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <vector>

#include "refine/collapse/edge_mesh.h"
#include "support/uniform_mesh.h"

namespace tufa::refine {
namespace {

constexpr std::size_t kMost = 1000;

EdgeMesh terrain() {
  ShapeOptions options;
  options.voxelSize = 0.04;
  return EdgeMesh(test::uniformMesh(*makeShape(Shape::Terrain, options)));
}

Regions regionsOf(const EdgeMesh& mesh, Parting parting) {
  base::Job job(2, {});
  return makeRegions(mesh, kMost, parting, job);
}

TEST(Regions, HoldEachVertexOnce) {
  EdgeMesh mesh = terrain();
  std::vector<VertexIndex> around;
  mesh.collectNeighbours(0, around);
  mesh.collapse(0, around.front(), mesh.point(0));
  for (const Parting parting : {Parting::Halves, Parting::Thirds}) {
    const Regions regions = regionsOf(mesh, parting);
    ASSERT_GT(regions.vertices.size(), 8U);
    std::vector<int> times(mesh.vertexCount(), 0);
    for (std::size_t i = 0; i < regions.vertices.size(); ++i) {
      const std::vector<VertexIndex>& own = regions.vertices[i];
      EXPECT_LE(own.size(), kMost);
      EXPECT_GE(own.size(), kMost / 4);
      EXPECT_TRUE(std::is_sorted(own.begin(), own.end(), [&](VertexIndex a, VertexIndex b) {
        return mesh.isBefore(a, b);
      }));
      for (const VertexIndex vertex : own) {
        ++times[vertex];
        EXPECT_EQ(regions.of[vertex], i);
      }
    }
    for (VertexIndex i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], mesh.isRoot(i) ? 1 : 0);
  }
}

TEST(Regions, TellWhichVerticesHaveAllNeighboursInTheirs) {
  const EdgeMesh mesh = terrain();
  const Regions halves = regionsOf(mesh, Parting::Halves),
                thirds = regionsOf(mesh, Parting::Thirds);
  std::size_t atBorders = 0, atBoth = 0;
  for (VertexIndex i = 0; i < mesh.vertexCount(); ++i) {
    bool inside = true;
    mesh.forTriangles(i, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
      inside &= halves.of[x] == halves.of[i] && halves.of[y] == halves.of[i];
    });
    EXPECT_EQ(halves.inner[i] != 0, inside);
    atBorders += inside ? 0 : 1;
    atBoth += inside || thirds.inner[i] != 0 ? 0 : 1;
  }
  EXPECT_GT(atBorders, 0U);
  EXPECT_LT(atBoth, atBorders / 3);
}

TEST(Regions, AreOneWhereThereIsLittle) {
  ShapeOptions options;
  options.voxelSize = 0.2;
  const EdgeMesh mesh(test::uniformMesh(*makeShape(Shape::Sphere, options)));
  ASSERT_LE(mesh.vertexCount(), kMost);
  const Regions regions = regionsOf(mesh, Parting::Halves);
  ASSERT_EQ(regions.vertices.size(), 1U);
  EXPECT_EQ(regions.vertices[0], mesh.byPlace());
}

}  // namespace
}  // namespace tufa::refine
