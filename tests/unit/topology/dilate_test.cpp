#include "topology/dilate.h"

#include <gtest/gtest.h>

#include <vector>

namespace tufa::topology {
namespace {

using Marks = std::vector<std::uint8_t>;

// A strip of quads along x: vertices 2 i and 2 i + 1 at place i.
Mesh strip(int quads) {
  Mesh mesh;
  for (int i = 0; i <= quads; ++i) {
    mesh.positions.emplace_back(i, 0, 0);
    mesh.positions.emplace_back(i, 1, 0);
  }
  for (int i = 0; i < quads; ++i) {
    const auto v = static_cast<VertexIndex>(2 * i);
    mesh.quads.emplace_back(v, v + 2, v + 3, v + 1);
  }
  return mesh;
}

TEST(Dilate, MarksARingAtATime) {
  const Mesh mesh = strip(5);
  Marks marks(12, 0);
  marks[4] = 1;
  EXPECT_EQ(dilate(mesh, marks, 0), marks);
  EXPECT_EQ(dilate(mesh, marks, 1), (Marks{0, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(dilate(mesh, marks, 2), (Marks{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0}));
}

TEST(Dilate, GoesAcrossTrianglesToo) {
  Mesh mesh = strip(1);
  mesh.positions.emplace_back(5, 0, 0);
  mesh.triangles.emplace_back(2, 4, 3);
  EXPECT_EQ(dilate(mesh, Marks{1, 0, 0, 0, 0}, 1), (Marks{1, 1, 1, 1, 0}));
  EXPECT_EQ(dilate(mesh, Marks{1, 0, 0, 0, 0}, 2), (Marks{1, 1, 1, 1, 1}));
}

TEST(Dilate, StaysInItsComponent) {
  Mesh mesh = strip(1);
  const Mesh other = strip(1);
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.quads.emplace_back(4, 6, 7, 5);
  EXPECT_EQ(dilate(mesh, Marks{0, 0, 0, 0, 0, 0, 1, 0}, 9), (Marks{0, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(Dilate, OfNoMarksIsNone) {
  const Mesh mesh = strip(3);
  EXPECT_EQ(dilate(mesh, Marks(8, 0), 3), Marks(8, 0));
}

}  // namespace
}  // namespace tufa::topology
