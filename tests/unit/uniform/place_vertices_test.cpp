#include "uniform/place_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/index_box.h"
#include "support/block_field.h"
#include "support/mesh_oracle.h"
#include "support/print.h"
#include "uniform/cell_topology.h"

namespace tufa::uniform {
namespace {

using test::BlockField;
using test::distanceAroundBlock;

/// The vertices of a field, with the cell that each lies in.
struct Placed {
  Mesh mesh;
  uniform::VertexSheets sheets;
  std::vector<Coord> cells;
};

Placed place(BlockField& field, int threads = 1) {
  Placed placed;
  base::Job job(threads, {});
  const auto topology =
      uniform::buildCellTopology(field.blocks(), field.scale(), Ambiguity::Separate, false, job);
  const grid::Affine affine(grid::transformOf(field.grid()));
  job.run([&] {
    placed.sheets =
        placeVertices(field.blocks(), field.scale(), topology, affine, true, placed.mesh, job);
  });
  for (const uniform::SurfaceBlock& block : topology.blocks) {
    const auto corners = field.blocks().cornerWords(block.neighbours);
    for (int cell = 0; cell < grid::kBlockCells; ++cell) {
      if (!block.cells.get(cell)) continue;
      const Coord at =
          field.blocks().origin(block.block).offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7);
      const int count =
          topology.componentsAt(block, cell, uniform::cornerMask(corners, cell)).count();
      placed.cells.insert(placed.cells.end(), static_cast<std::size_t>(count), at);
    }
  }
  return placed;
}

Vec3 pointOf(const Mesh& mesh, std::size_t v) { return mesh.positions[v]; }
Vec3 normalOf(const Mesh& mesh, std::size_t v) { return Vec3(mesh.normals[v]); }

/// Farthest that a vertex is from the middle of its cell, along an axis.
double farthestFromCell(const Placed& placed) {
  double farthest = 0;
  for (std::size_t v = 0; v < placed.cells.size(); ++v) {
    const Vec3 off = pointOf(placed.mesh, v) - Vec3(placed.cells[v]) - Vec3(0.5);
    farthest = std::max({farthest, std::abs(off[0]), std::abs(off[1]), std::abs(off[2])});
  }
  return farthest;
}

TEST(PlaceVertices, OnAPlanePutsThemAllOnIt) {
  const Vec3 normal = Vec3(1, 3, -2).unitOrX();
  // Between lattice points: crossings keep a thousandth away from samples.
  const test::PlaneDistance plane{normal, normal.dot(Vec3(4)) + 0.5 / Vec3(1, 3, -2).length()};
  // A density with a border around, so that nothing but the QEF places vertices.
  auto grid = test::sampled<openvdb::FloatGrid>(
      test::boxAroundBlock(), -30,
      [&](const openvdb::Coord& at) { return -plane(Vec3(grid::fromVdb(at))); });
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  BlockField field(grid, {.isovalue = 0, .insideIsBelow = false});
  const Placed placed = place(field);
  ASSERT_EQ(placed.cells.size(), placed.mesh.positions.size());
  int within = 0;
  for (std::size_t v = 0; v < placed.cells.size(); ++v) {
    const base::IndexBox inner{Coord(-7), Coord(14)};
    if (!inner.contains(placed.cells[v])) continue;  // its gradient knows the border
    ++within;
    EXPECT_NEAR(plane(pointOf(placed.mesh, v)), 0, 2e-5);
    EXPECT_LT((normalOf(placed.mesh, v) - normal).length(), 1e-4);
  }
  EXPECT_GT(within, 300);
}

TEST(PlaceVertices, OnNoiseKeepsEachInItsCell) {
  for (const unsigned seed : {1U, 2U}) {
    BlockField field(
        test::noise<openvdb::FloatGrid>({.size = 20, .seed = seed, .first = openvdb::Coord(-3)}));
    const Placed placed = place(field);
    ASSERT_EQ(placed.cells.size(), placed.mesh.positions.size());
    EXPECT_LT(farthestFromCell(placed), 0.5);
    for (std::size_t v = 0; v < placed.cells.size(); ++v) {
      EXPECT_TRUE(std::isfinite(normalOf(placed.mesh, v).squaredLength()));
    }
  }
}

TEST(PlaceVertices, GivesTheSameForAnyThreads) {
  BlockField field(
      test::noise<openvdb::FloatGrid>({.size = 24, .seed = 3, .first = openvdb::Coord(-3)}));
  EXPECT_TRUE(test::sameBytes(place(field, 1).mesh, place(field, 2).mesh));
}

TEST(PlaceVertices, TellsWhichLieOnCreases) {
  const test::TurnedBoxDistance box = test::boxWithCornerInBlock();
  auto field = distanceAroundBlock(box);
  const Placed placed = place(field);
  std::size_t sharp = 0;
  for (VertexIndex v = 0; v < placed.cells.size(); ++v) {
    if (placed.sheets.kind(v) != uniform::VertexSheets::Kind::Meeting) continue;
    ++sharp;
    EXPECT_GE(placed.sheets.sheets(placed.mesh, v).count, 2);
  }
  EXPECT_GT(sharp, 10U);
  EXPECT_LT(sharp, placed.cells.size() / 2);
}

TEST(FaceNormals, OfACubePointAlongItsDiagonalsHoweverItIsSplit) {
  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  cube.quads = {Quad(0, 2, 3, 1), Quad(4, 5, 7, 6), Quad(0, 1, 5, 4),
                Quad(2, 6, 7, 3), Quad(0, 4, 6, 2), Quad(1, 3, 7, 5)};
  for (int turned = 0; turned < 64; ++turned) {
    Mesh mesh = cube;
    for (int i = 0; i < 6; ++i) {
      auto& v = mesh.quads[static_cast<std::size_t>(i)].vertices;
      if (((turned >> i) & 1) != 0) std::rotate(v.begin(), v.begin() + 1, v.end());
    }
    base::Job job(1, {});
    setFaceNormals(mesh, job);
    for (std::size_t v = 0; v < 8; ++v) {
      const Vec3 outward = (pointOf(mesh, v) - Vec3(0.5)).unitOrX();
      ASSERT_LT((normalOf(mesh, v) - outward).length(), 1e-6);
    }
  }
}

TEST(FaceNormals, OfDegenerateFacesAreZeroAndFinite) {
  Mesh mesh;
  mesh.positions = {Position(0, 0, 0), Position(1, 1, 1), Position(2, 2, 2), Position(5, 5, 5)};
  mesh.triangles = {Triangle(0, 1, 2)};
  base::Job job(1, {});
  setFaceNormals(mesh, job);
  ASSERT_EQ(mesh.normals.size(), 4U);
  for (const Normal& n : mesh.normals) EXPECT_EQ(n, Normal(0, 0, 0));
}

}  // namespace
}  // namespace tufa::uniform
