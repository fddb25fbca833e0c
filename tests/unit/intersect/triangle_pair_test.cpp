#include "intersect/triangle_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "check/exact.h"

namespace tufa {
namespace {

// CGAL's answer by the definition of check(), which leaves triangles on a line out.
bool expected(const std::vector<Position>& p, const Triangle& a, const Triangle& b) {
  if (checks::areCollinear(p, a) || checks::areCollinear(p, b)) return false;
  return checks::intersectElsewhere(p, a, b);
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
      const bool meet = intersect::intersectElsewhere(p, a, b);
      met += meet ? 1 : 0;
      ASSERT_EQ(meet, expected(p, a, b)) << "lattice of " << size << ", pair " << i;
      ASSERT_EQ(meet, intersect::intersectElsewhere(p, b, a));
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
      ASSERT_EQ(intersect::intersectElsewhere(p, {0, 1, 2}, b), expected(p, {0, 1, 2}, b)) << i;
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
      ASSERT_EQ(intersect::intersectElsewhere(p, {0, 1, 2}, b), expected(p, {0, 1, 2}, b)) << i;
    }
  }
}

// Two quads over one edge, from nearly flat to folded over, at any place and scale.
TEST(TrianglePair, WhatIsSeparatedAlongAnEdgeDoesNotMeet) {
  std::mt19937 random(14);
  std::uniform_real_distribution<double> coordinate(-1, 1), place(-1e6, 1e6);
  const Triangle own[] = {{0, 1, 2}, {0, 2, 3}}, other[] = {{1, 0, 4}, {1, 4, 5}};
  int separated = 0, met = 0;
  for (int i = 0; i < 20000; ++i) {
    // Flatter and flatter, so that rounding counts at last.
    const double flat = std::pow(10.0, -20.0 * (i % 1000) / 1000);
    const double shift = i % 2 == 0 ? 0 : place(random);
    std::vector<Position> p = {{shift, 0, 0}, {shift + 1, 0, 0}};
    for (int k = 2; k < 6; ++k) {
      const double side = k < 4 ? 1 : -1;
      const double across = i % 3 == 0 ? coordinate(random) : side * (coordinate(random) + 1.1);
      p.emplace_back(shift + coordinate(random), across, flat * coordinate(random));
    }
    bool meet = false;
    for (const Triangle& a : own) {
      for (const Triangle& b : other) meet |= expected(p, a, b);
    }
    const bool apart =
        intersect::areSeparatedAlong(p[0], p[1], {p.data() + 2, 2}, {p.data() + 4, 2});
    ASSERT_FALSE(apart && meet) << i;
    separated += apart ? 1 : 0;
    met += meet ? 1 : 0;
  }
  EXPECT_GT(separated, 8000);
  EXPECT_GT(met, 2000);
}

TEST(TrianglePair, NothingIsSeparatedAlongAPoint) {
  const std::vector<Position> p = {{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}};
  EXPECT_FALSE(intersect::areSeparatedAlong(p[0], p[1], {&p[2], 1}, {&p[3], 1}));
  EXPECT_TRUE(intersect::areSeparatedAlong(p[0], p[4], {&p[2], 1}, {&p[3], 1}));
  EXPECT_FALSE(intersect::areSeparatedAlong(p[0], p[4], {&p[2], 1}, {&p[2], 1}));
  EXPECT_FALSE(intersect::areSeparatedAlong(p[0], p[4], {&p[4], 1}, {&p[3], 1}));
}

TEST(TrianglePair, FlatMeansOnALine) {
  const std::vector<Position> p = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {0, 0, 1e-300}};
  EXPECT_TRUE(intersect::isFlat(p, {0, 1, 2}));
  EXPECT_FALSE(intersect::isFlat(p, {0, 1, 3}));
}

}  // namespace
}  // namespace tufa
