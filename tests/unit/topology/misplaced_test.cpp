#include "topology/misplaced.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tufa::topology {
namespace {

// Adds a tetrahedron that faces outward, or inward.
void addTetrahedron(Mesh& mesh, const Position& corner, double size, bool outward = true) {
  const auto first = static_cast<VertexIndex>(mesh.positions.size());
  for (const Position& p :
       {Position(0, 0, 0), Position(1, 0, 0), Position(0, 1, 0), Position(0, 0, 1)}) {
    mesh.positions.emplace_back(corner.x + size * p.x, corner.y + size * p.y,
                                corner.z + size * p.z);
  }
  const auto add = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
    if (!outward) std::swap(b, c);
    mesh.triangles.emplace_back(first + a, first + b, first + c);
  };
  add(0, 2, 1);
  add(0, 1, 3);
  add(0, 3, 2);
  add(1, 2, 3);
}

std::vector<VertexIndex> misplaced(const Mesh& mesh) {
  base::Job job(1, {});
  return findMisplaced(mesh, job);
}

using Vertices = std::vector<VertexIndex>;

TEST(Pieces, AreNamedByTheirLeastVertex) {
  Mesh mesh;
  addTetrahedron(mesh, {0, 0, 0}, 1);
  addTetrahedron(mesh, {5, 0, 0}, 1);
  mesh.positions.emplace_back(9, 9, 9);
  EXPECT_EQ(connectedComponentsOf(mesh), (Vertices{0, 0, 0, 0, 4, 4, 4, 4, 8}));
}

TEST(Misplaced, AreNone) {
  Mesh mesh;
  EXPECT_EQ(misplaced(mesh), Vertices());
  addTetrahedron(mesh, {0, 0, 0}, 1);
  EXPECT_EQ(misplaced(mesh), Vertices());
  addTetrahedron(mesh, {0, 0, 2}, 1);                 // above: rays cross it twice
  addTetrahedron(mesh, {0.2, 0.2, 0.2}, 0.2, false);  // a bubble
  addTetrahedron(mesh, {0.21, 0.21, 0.21}, 0.1);      // and what lies in it
  mesh.positions.emplace_back(0.1, 0.1, 0.1);         // of no polygon
  EXPECT_EQ(misplaced(mesh), Vertices());
}

TEST(Misplaced, AreSolidsInSolidsAndTheNearestTriangles) {
  Mesh mesh;
  addTetrahedron(mesh, {0, 0, 0}, 10);
  addTetrahedron(mesh, {1, 1, 0.1}, 0.2);
  addTetrahedron(mesh, {-4, 0, 0}, 1);
  // Nearest to all of its corners is the lowest triangle.
  EXPECT_EQ(misplaced(mesh), (Vertices{0, 1, 2, 4, 5, 6, 7}));
}

TEST(Misplaced, AreBubblesOutsideOfAll) {
  Mesh mesh;
  addTetrahedron(mesh, {0, 0, 0}, 1, false);
  addTetrahedron(mesh, {-1, -1, -3}, 10);
  EXPECT_EQ(misplaced(mesh), Vertices());
  addTetrahedron(mesh, {-3, 0, 0}, 1, false);
  EXPECT_EQ(misplaced(mesh).size(), 4u + 3u);
}

// A solid without end around cavities, or a mirrored space.
TEST(Misplaced, AreToldByTheLargestPiece) {
  Mesh mesh;
  addTetrahedron(mesh, {0, 0, 0}, 1, false);
  addTetrahedron(mesh, {9, 0, 0}, 2, false);
  addTetrahedron(mesh, {9.2, 0.2, 0.2}, 0.5);
  EXPECT_EQ(misplaced(mesh), Vertices());
  addTetrahedron(mesh, {-9, 0.1, 0.1}, 0.2);  // nearest to the triangle at x = 0
  EXPECT_EQ(misplaced(mesh), (Vertices{0, 2, 3, 12, 13, 14, 15}));
}

// As thin as rounding, whichever way it faces.
TEST(Misplaced, AreThinOnesIfAskedFor) {
  Mesh mesh;
  addTetrahedron(mesh, {0, 0, 0}, 1);
  addTetrahedron(mesh, {3, 0, 0}, 0.1);
  addTetrahedron(mesh, {6, 0, 0}, 0.1);
  mesh.positions.back().z = 1e-6;  // of an apex over 0.005 square units: on average a third of that
  base::Job job(1, {});
  EXPECT_EQ(findMisplaced(mesh, job), Vertices());
  EXPECT_EQ(findMisplaced(mesh, job, 4, 3e-7), Vertices());
  EXPECT_EQ(findMisplaced(mesh, job, 4, 4e-7), (Vertices{8, 9, 10, 11}));
  EXPECT_EQ(findMisplaced(mesh, job, 3, 4e-7), Vertices());
}

// Above each of its vertices is a vertex or an edge of the larger ones.
TEST(Misplaced, AreFoundWhereRaysPassThroughVertices) {
  Mesh mesh;
  addTetrahedron(mesh, {0, 0, 0}, 1);
  addTetrahedron(mesh, {0, 0, -3}, 1);
  addTetrahedron(mesh, {0, 0, 3}, 1);
  EXPECT_EQ(misplaced(mesh), Vertices());
  addTetrahedron(mesh, {0.25, 0.25, 0.25}, 0.125);
  addTetrahedron(mesh, {0.25, 0.25, 3.25}, 0.125);
  EXPECT_EQ(misplaced(mesh).size(), 2u * (4 + 3));
}

// A tube that is cut off at both ends, and pieces in it and beside it. Rays go across its axis.
TEST(Misplaced, AreFoundInAPartOfAMesh) {
  for (const int axis : {0, 1, 2}) {
    Mesh mesh;
    for (const double x : {-20.0, 20.0}) {
      for (const auto& [y, z] : {std::pair(0, 0), {10, 0}, {10, 10}, {0, 10}}) {
        mesh.positions.emplace_back(x, y, z);
      }
    }
    for (VertexIndex a = 0; a < 4; ++a) {
      const VertexIndex b = (a + 1) % 4;
      mesh.triangles.emplace_back(a, 4 + b, 4 + a);
      mesh.triangles.emplace_back(a, b, 4 + b);
    }
    addTetrahedron(mesh, {5, 5, 5}, 1);          // 8: wrong
    addTetrahedron(mesh, {-5, 5, 5}, 1, false);  // 12
    addTetrahedron(mesh, {-10, 5, -4}, 1);       // 16
    addTetrahedron(mesh, {5, 5, -3}, 1, false);  // 20: wrong
    addTetrahedron(mesh, {-18.5, 5, 5}, 1);      // 24: near an end
    for (Position& p : mesh.positions) {
      const double at[] = {p.x, p.y, p.z};
      p = {at[(3 - axis) % 3], at[(4 - axis) % 3], at[(5 - axis) % 3]};
    }
    const auto isNearEnd = [axis](const Position& p) {
      return std::abs(axis == 0 ? p.x : axis == 1 ? p.y : p.z) > 18;
    };
    OpenMesh open{axis, false, isNearEnd};
    base::Job job(1, {});
    const auto areFound = [&](const std::vector<VertexIndex>& pieces) {
      const Vertices found = findMisplaced(mesh, job, 4, 0, &open);
      for (VertexIndex piece = 8; piece < 28; piece += 4) {
        const bool isWanted = std::count(pieces.begin(), pieces.end(), piece) > 0;
        EXPECT_EQ(std::binary_search(found.begin(), found.end(), piece), isWanted)
            << axis << ' ' << piece;
      }
    };
    areFound({8, 20});
    open.isHoleOutermost = true;
    areFound({12, 16});
    open.isHoleOutermost = false;
    open.isNearEnd = [](const Position&) { return false; };
    areFound({8, 20, 24});
  }
}

// Over several parts that are summed up by themselves, whichever threads do it.
TEST(Misplaced, AreTheSameForAnyThreads) {
  Mesh mesh;
  addTetrahedron(mesh, {-1, -1, -1}, 400);
  Vertices expected;
  for (int i = 0; i < 40'000; ++i) {
    const double x = 1 + i % 40, y = 1 + i / 40 % 40, z = 1 + i / 1600;
    const auto first = static_cast<VertexIndex>(mesh.positions.size());
    addTetrahedron(mesh, {x, y, z}, 0.5, i % 1000 == 0);
    if (i % 1000 == 0) expected.insert(expected.end(), {first, first + 1, first + 2, first + 3});
  }
  Vertices found[3];
  for (int threads = 1; threads <= 3; ++threads) {
    base::Job job(threads, {});
    found[threads - 1] = findMisplaced(mesh, job);
  }
  EXPECT_EQ(found[1], found[0]);
  EXPECT_EQ(found[2], found[0]);
  // And the triangles nearest to them.
  EXPECT_TRUE(std::includes(found[0].begin(), found[0].end(), expected.begin(), expected.end()));
  EXPECT_LE(found[0].size(), 40U * (4 + 4 * 3));
}

}  // namespace
}  // namespace tufa::topology
