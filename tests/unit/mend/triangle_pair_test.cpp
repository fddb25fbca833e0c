#include "mend/triangle_pair.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "check/exact.h"

namespace tufa {
namespace {

// CGAL's answer by the definition of check(), which leaves triangles on a line out.
bool expected(const std::vector<Position>& p, const Triangle& a, const Triangle& b) {
  if (checks::areCollinear(p, a) || checks::areCollinear(p, b)) return false;
  return checks::meetElsewhere(p, a, b);
}

// Points of a small lattice: most pairs touch, lie in one plane or share lines.
TEST(TrianglePair, AgreesWithCgalOnSmallLattices) {
  std::mt19937 random(11);
  for (const int size : {1, 2, 4}) {
    std::uniform_int_distribution<int> coordinate(0, size);
    std::uniform_int_distribution<VertexIndex> vertex(0, 5);
    int met = 0;
    for (int i = 0; i < 60000; ++i) {
      std::vector<Position> p;
      for (int k = 0; k < 6; ++k) {
        p.emplace_back(coordinate(random), coordinate(random), coordinate(random));
      }
      const Triangle a(0, 1, 2);
      Triangle b(vertex(random), vertex(random), vertex(random));
      if (b.vertices[0] == b.vertices[1] || b.vertices[1] == b.vertices[2] ||
          b.vertices[2] == b.vertices[0]) {
        b = {3, 4, 5};
      }
      const bool meet = mend::meetElsewhere(p, a, b);
      met += meet ? 1 : 0;
      ASSERT_EQ(meet, expected(p, a, b)) << "lattice of " << size << ", pair " << i;
      ASSERT_EQ(meet, mend::meetElsewhere(p, b, a));
    }
    EXPECT_GT(met, 1000);
  }
}

TEST(TrianglePair, AgreesWithCgalOnFlatTriangles) {
  std::mt19937 random(12);
  std::uniform_int_distribution<int> coordinate(0, 5), plane(0, 2);
  for (int i = 0; i < 60000; ++i) {
    std::vector<Position> p;
    const int axis = plane(random);
    for (int k = 0; k < 6; ++k) {
      const double u = coordinate(random), v = coordinate(random);
      p.push_back(axis == 0   ? Position(3, u, v)
                  : axis == 1 ? Position(u, 3, v)
                              : Position(u, v, u));
    }
    for (const Triangle& b : {Triangle(3, 4, 5), Triangle(3, 4, 0), Triangle(1, 0, 3)}) {
      ASSERT_EQ(mend::meetElsewhere(p, {0, 1, 2}, b), expected(p, {0, 1, 2}, b)) << i;
    }
  }
}

TEST(TrianglePair, AgreesWithCgalOnRandomPoints) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> coordinate(0, 1);
  for (int i = 0; i < 60000; ++i) {
    std::vector<Position> p;
    for (int k = 0; k < 6; ++k) {
      p.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    }
    for (const Triangle& b : {Triangle(3, 4, 5), Triangle(3, 4, 0), Triangle(1, 0, 3)}) {
      ASSERT_EQ(mend::meetElsewhere(p, {0, 1, 2}, b), expected(p, {0, 1, 2}, b)) << i;
    }
  }
}

TEST(TrianglePair, FlatMeansOnALine) {
  const std::vector<Position> p = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {0, 0, 1e-300}};
  EXPECT_TRUE(mend::isFlat(p, {0, 1, 2}));
  EXPECT_FALSE(mend::isFlat(p, {0, 1, 3}));
}

}  // namespace
}  // namespace tufa
