#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "reduce/part_tree.h"

namespace tufa::reduce {
namespace {

std::vector<Vec3f> randomPoints(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    points.emplace_back(3 * x * x, 2 * y, z);
  }
  return points;
}

PartTree treeOf(const std::vector<Vec3f>& points, const PartSize& size, float share,
                int threads = 1) {
  base::Job job(threads, {});
  PartTree tree;
  job.run([&] { tree = splitIntoParts(points, {}, size, share, job); });
  return tree;
}

void expectParts(const PartTree& tree, const std::vector<Vec3f>& points) {
  ASSERT_EQ(tree.ranges.size(), tree.size() + 1);
  ASSERT_EQ(tree.vertices.size(), points.size());
  std::vector<int> times(points.size(), 0);
  for (std::size_t p = 0; p < tree.size(); ++p) {
    for (Index i = tree.ranges[p]; i < tree.ranges[p + 1]; ++i) {
      const Index v = tree.vertices[i];
      ++times[v];
      EXPECT_TRUE(tree.boxes[p].hasInside(points[v]));
      EXPECT_TRUE(i == tree.ranges[p] || tree.vertices[i - 1] < v);
    }
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ssize(points));
}

// A floor, or a ceiling, or both, whose heights rounding has changed by its last digits: vertices
// on a cut through it could not move.
TEST(PartTree, CutsNoFlatFaces) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const auto& [floor, ceiling] : {std::pair(0.6, 0.0), {0.0, 0.6}, {0.5, 0.5}, {0.3, 0.4}}) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 100000; ++i) {
      const float x = uniform(random), y = uniform(random), z = uniform(random);
      const double kind = uniform(random);
      const float height = kind < floor ? 0 : kind > 1 - ceiling ? 10 : 0.1f + 9.8f * z;
      points.emplace_back(x, y, height + 1e-5f * uniform(random));
    }
    for (const float share : {0.3f, 0.4f, 0.5f, 0.6f, 0.7f}) {
      const PartTree tree = treeOf(points, {4000}, share);
      expectParts(tree, points);
      for (const PartTree::Node& node : tree.nodes) {
        if (node.axis != 2) continue;
        EXPECT_GT(std::abs(node.at), 0.004f) << floor << ' ' << share;
        EXPECT_GT(std::abs(node.at - 10), 0.004f) << floor << ' ' << share;
      }
    }
  }
}

TEST(PartTree, CutsAtTheShareThatIsAskedFor) {
  const std::vector<Vec3f> points = randomPoints(200000);
  for (const float share : {0.3f, 0.5f, 0.7f}) {
    const PartTree tree = treeOf(points, {5000}, share);
    expectParts(tree, points);
    const PartTree::Node& root = tree.nodes[0];
    EXPECT_EQ(root.axis, 0);
    const auto below =
        std::count_if(points.begin(), points.end(), [&](const Vec3f& p) { return p.x < root.at; });
    EXPECT_NEAR(static_cast<double>(below) / 200000, share, 0.06);
    for (std::size_t p = 0; p < tree.size(); ++p) {
      EXPECT_LE(tree.ranges[p + 1] - tree.ranges[p], 5000U);
    }
  }
}

TEST(PartTree, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3f> points = randomPoints(300000);
  const PartTree one = treeOf(points, {3000}, 0.4f, 1), four = treeOf(points, {3000}, 0.4f, 4);
  EXPECT_EQ(one.vertices, four.vertices);
  EXPECT_EQ(one.ranges, four.ranges);
}

// Two thirds of the vertices have the least coordinate along the longest extent: no cut has the
// share below it.
TEST(PartTree, DividesWhatLiesOnAFace) {
  std::vector<Vec3f> points = randomPoints(30000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 3 != 0) points[i].x = 0;
  }
  const PartTree tree = treeOf(points, {1000}, 0.5f);
  expectParts(tree, points);
  for (std::size_t p = 0; p < tree.size(); ++p) {
    EXPECT_LE(tree.ranges[p + 1] - tree.ranges[p], 1000U);
  }
}

TEST(PartTree, KeepsVerticesInOnePlaceTogether) {
  const std::vector<Vec3f> points(5000, Vec3f(1, 2, 3));
  const PartTree tree = treeOf(points, {1000}, 0.5f);
  EXPECT_EQ(tree.size(), 1U);
  expectParts(tree, points);
}

TEST(PartTree, CutsAlongAnotherTree) {
  const std::vector<Vec3f> points = randomPoints(100000);
  const PartTree tree = treeOf(points, {2000}, 0.35f);
  base::Job job(1, {});
  const PartTree same = splitAlong(points, tree.nodes, job);
  EXPECT_EQ(same.vertices, tree.vertices);
  EXPECT_EQ(same.ranges, tree.ranges);
  std::vector<Vec3f> moved = points;
  for (std::size_t i = 0; i < moved.size(); i += 10) moved[i] = moved[i] + Vec3f(0.1f, 0, 0);
  const PartTree other = splitAlong(moved, tree.nodes, job);
  EXPECT_EQ(other.size(), tree.size());
  expectParts(other, moved);
}

}  // namespace
}  // namespace tufa::reduce
