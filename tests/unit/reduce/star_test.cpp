#include "reduce/star.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace tufa::reduce {
namespace {

// The neighbours of a vertex: `count` of them around the z axis, `turns` times, at heights
// h(angle).
template <class Height>
std::vector<Vec3f> linkOf(int count, int turns, const Height& height) {
  std::vector<Vec3f> link;
  for (int i = 0; i < count; ++i) {
    const float angle = 6.2831853f * static_cast<float>(turns * i) / static_cast<float>(count);
    link.emplace_back(std::cos(angle), std::sin(angle), height(angle));
  }
  return link;
}

std::vector<Vec3f> normalsOf(const std::vector<Vec3f>& link) {
  std::vector<Vec3f> normals;
  for (std::size_t i = 0; i < link.size(); ++i) {
    normals.push_back(unit(cross(link[i], link[(i + 1) % link.size()])));
  }
  return normals;
}

float leastCosineOf(const std::vector<Vec3f>& link) {
  const std::vector<Vec3f> normals = normalsOf(link);
  float leastCosine;
  static_cast<void>(commonAxis(normals.data(), static_cast<int>(normals.size()), leastCosine));
  return leastCosine;
}

bool isSimple(std::vector<Vec3f> link) {
  for (Vec3f& v : link) v = unit(v);
  const int count = static_cast<int>(link.size());
  return linkIsSimple(link.data(), count, 0, count - 1);
}

TEST(Star, OfAHillHasAnAxis) {
  EXPECT_GT(leastCosineOf(linkOf(6, 1, [](float) { return -1.0f; })), 0.5f);
}

// The mean of the normals alone would not do: many of them look one way.
TEST(Star, WithManyTrianglesOnOneSideHasAnAxis) {
  std::vector<Vec3f> link{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  for (int i = 1; i < 20; ++i) {  // a wall of needles
    const float angle = 3.1415927f * static_cast<float>(i) / 20;
    link.emplace_back(-std::cos(angle), -0.2f * std::sin(angle), -std::sin(angle));
  }
  EXPECT_GE(leastCosineOf(link), kLeastCosine);
}

TEST(Star, OfAFoldHasNoAxis) {
  // The third neighbour lies behind the second: its triangle looks down.
  const std::vector<Vec3f> link{
      {1, 0, 0}, {0.5f, 1, 0}, {0.9f, 0.5f, 0.05f}, {-1, 1, 0}, {0, -1, 0}};
  EXPECT_LT(leastCosineOf(link), kLeastCosine);
}

// All triangles face the axis, yet the star passes through itself.
TEST(Star, ThatWindsTwiceIsNoGraph) {
  const std::vector<Vec3f> once = linkOf(10, 1, [](float) { return 0.0f; });
  const std::vector<Vec3f> twice = linkOf(10, 2, [](float a) { return 0.3f * std::sin(a / 2); });
  EXPECT_GE(leastCosineOf(twice), kLeastCosine);
  EXPECT_TRUE(windsOnce(once.data(), 10, {0, 0, 1}));
  EXPECT_FALSE(windsOnce(twice.data(), 10, {0, 0, 1}));
  EXPECT_FALSE(isSimple(twice));
}

TEST(Star, OnAnAcuteEdgeHasASimpleLink) {
  // A wedge of 20 degrees along x: no axis, but no crossing either.
  const std::vector<Vec3f> link{{1, 0, 0}, {0, 0.17f, -1}, {-1, 0, 0}, {0, -0.17f, -1}};
  EXPECT_LT(leastCosineOf(link), kLeastCosine);
  EXPECT_TRUE(isSimple(link));
}

TEST(Star, OnAnAcuteEdgeMayCrossItself) {
  // The same with one neighbour pushed through the other side.
  const std::vector<Vec3f> link{{1, 0, 0},          {0.3f, 0.17f, -1}, {0, -0.5f, -1},
                                {-0.3f, 0.17f, -1}, {-1, 0, 0},        {0, -0.17f, -1}};
  EXPECT_FALSE(isSimple(link));
}

TEST(Star, LooksAtWhatHasChangedOnly) {
  std::vector<Vec3f> link{{1, 0, 0},      {0.8f, 0.1f, -0.4f}, {0.3f, 0.17f, -1},
                          {0, -0.5f, -1}, {-0.3f, 0.17f, -1},  {-1, 0, 0},
                          {0, -0.17f, -1}};
  for (Vec3f& v : link) v = unit(v);
  EXPECT_FALSE(linkIsSimple(link.data(), 7, 3, 3));  // the one that was pushed
  EXPECT_TRUE(linkIsSimple(link.data(), 7, 1, 1));   // its arcs cross none
}

// Whether arcs on the sphere meet, by their points: sampled finely, with a margin either way.
TEST(Star, ArcsPartWhereTheirPointsAreApart) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  const auto direction = [&] {
    return unit(Vec3f(normal(random), normal(random), normal(random)));
  };
  int apart = 0, crossing = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f s = direction(), t = direction(), x = direction(), y = direction();
    // Two arcs shorter than half a turn cross if the ends of each lie on two sides of the other, on
    // the same half of the sphere.
    const Vec3f n = cross(s, t), m = cross(x, y), at = cross(n, m);
    const auto holds = [&](Vec3f p, Vec3f a, Vec3f b, Vec3f across) {
      return dot(cross(a, p), across) > 0 && dot(cross(p, b), across) > 0;
    };
    const bool isCrossing = (holds(at, s, t, n) && holds(at, x, y, m)) ||
                            (holds(at * -1, s, t, n) && holds(at * -1, x, y, m));
    if (isCrossing) {
      ++crossing;
      EXPECT_FALSE(arcsPart(s, t, x, y)) << i;
    } else {
      apart += arcsPart(s, t, x, y);
    }
  }
  EXPECT_GT(crossing, 200);
  EXPECT_GT(apart, (2000 - crossing) * 90 / 100);
}

}  // namespace
}  // namespace tufa::reduce
