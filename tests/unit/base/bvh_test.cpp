#include "base/bvh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "base/job.h"
#include "check/triangle_soup.h"
#include "unit/check/meshes.h"

namespace tufa {
namespace {

using base::Box;
using base::Bvh;

std::vector<Box> randomBoxes(std::size_t count, double size, std::mt19937& random) {
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    Box box = Box::empty();
    const Vec3 corner(place(random), place(random), place(random));
    box.add(corner);
    box.add(corner + Vec3(place(random), place(random), place(random)) * size);
    boxes.push_back(box);
  }
  return boxes;
}

TEST(CheckBvh, FindsEachOverlappingPairOnce) {
  std::mt19937 random(5);
  for (const std::size_t count : {0, 1, 3, 4, 5, 9, 100, 777}) {
    const std::vector<Box> boxes = randomBoxes(count, 0.2, random);
    std::set<std::pair<std::size_t, std::size_t>> expected;
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) {
        if (boxes[a].meets(boxes[b])) expected.emplace(a, b);
      }
    }
    base::Job job(0, {});
    const Bvh tree(boxes, job);
    std::multiset<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t leaf = 0; leaf < tree.leafCount(); ++leaf) {
      tree.pairsOfLeaf(leaf,
                       [&](std::size_t a, std::size_t b) { found.insert(std::minmax(a, b)); });
    }
    EXPECT_EQ(found.size(), expected.size());
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), found.begin(), found.end()));
  }
}

TEST(CheckBvh, NearestIsTheNearest) {
  std::mt19937 random(6);
  const std::vector<Box> boxes = randomBoxes(500, 0.0, random);
  base::Job job(0, {});
  const Bvh tree(boxes, job);
  std::uniform_real_distribution<double> place(-1, 2);
  for (int run = 0; run < 200; ++run) {
    const Vec3 from(place(random), place(random), place(random));
    double expected = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes) expected = std::min(expected, box.distanceSquared(from));
    double best = std::numeric_limits<double>::infinity();
    const auto squared = [&](std::uint32_t i) { return boxes[i].distanceSquared(from); };
    const std::uint32_t found = tree.nearest(from, best, squared);
    ASSERT_NE(found, Bvh::kNone);
    EXPECT_EQ(best, expected);
    EXPECT_EQ(boxes[found].distanceSquared(from), expected);
    EXPECT_EQ(tree.nearest(from, best, squared), Bvh::kNone) << "nothing is nearer than that";
  }
}

// However far the ray goes, and whether it meets anything or not.
TEST(CheckBvh, RaysVisitWhatTheyPassAndNothingElse) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 2);
  const std::vector<Box> boxes = randomBoxes(2000, 0.2, random);
  base::Job job(0, {});
  const Bvh tree(boxes, job);
  std::size_t met = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 from(place(random), place(random), place(random));
    const Vec3 direction = Vec3(place(random), place(random), place(random)) - from;
    const base::BoxRay ray(from, direction, 0);
    double to = std::numeric_limits<double>::infinity();
    std::set<std::uint32_t> visited;
    tree.itemsAlong(ray, to, [&](std::uint32_t item) { visited.insert(item); });
    for (std::uint32_t item = 0; item < boxes.size(); ++item) {
      EXPECT_EQ(visited.contains(item), std::isfinite(ray.entry(boxes[item], 1e300)));
    }
    met += visited.size();
  }
  EXPECT_GT(met, 100U);
  EXPECT_LT(met, 40000U);
}

TEST(CheckBvh, EqualBoxesDoNoHarm) {
  const std::vector<Box> boxes(50, Box{Vec3(1, 2, 3), Vec3(1, 2, 3)});
  base::Job job(0, {});
  const Bvh tree(boxes, job);
  std::size_t pairs = 0;
  for (std::size_t leaf = 0; leaf < tree.leafCount(); ++leaf) {
    tree.pairsOfLeaf(leaf, [&](std::uint32_t, std::uint32_t) { ++pairs; });
  }
  EXPECT_EQ(pairs, 50U * 49 / 2);
}

TEST(CheckTriangleSoup, DistanceIsRightOverFacesEdgesAndCorners) {
  base::Job job(0, {});
  Mesh mesh;
  mesh.positions = {Position(0, 0, 0), Position(4, 0, 0), Position(0, 4, 0)};
  mesh.triangles = {Triangle(0, 1, 2)};
  const checks::TriangleSoup soup(mesh, grid::VoxelFrame(), job);
  const auto distance = [&](double x, double y, double z) {
    std::uint32_t hint = Bvh::kNone;
    return soup.distance(Vec3(x, y, z), hint);
  };
  EXPECT_DOUBLE_EQ(distance(1, 1, 2), 2);
  EXPECT_DOUBLE_EQ(distance(1, 1, -2), 2);
  EXPECT_DOUBLE_EQ(distance(2, -3, 0), 3);
  EXPECT_DOUBLE_EQ(distance(-3, -4, 0), 5);
  EXPECT_DOUBLE_EQ(distance(3, 3, 0), std::sqrt(2));
  EXPECT_DOUBLE_EQ(distance(7, 0, 4), 5);

  // No area: the edges are left.
  mesh.triangles = {Triangle(0, 1, 1)};
  const checks::TriangleSoup flat(mesh, grid::VoxelFrame(), job);
  std::uint32_t hint = Bvh::kNone;
  EXPECT_DOUBLE_EQ(flat.distance(Vec3(2, 3, 0), hint), 3);
}

}  // namespace
}  // namespace tufa
