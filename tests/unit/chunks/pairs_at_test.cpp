#include "chunks/cut/pairs_at.h"

#include <gtest/gtest.h>

#include <random>

namespace tufa::chunks {
namespace {

// Random triangles of up to three steps in a box, on both sides of the origin. `longOne`: a
// triangle through all of it, in place of that one.
struct Soup {
  std::vector<Triangle> triangles;
  std::vector<Vec3> points;

  explicit Soup(unsigned seed, std::size_t longOne = 2000) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-30, 30), step(-1.5, 1.5);
    for (VertexIndex t = 0; t < 2000; ++t) {
      const Vec3 middle(place(random), place(random), place(random));
      for (int i = 0; i < 3; ++i) {
        points.push_back(middle + Vec3(step(random), step(random), step(random)));
      }
      triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
    }
    if (longOne >= triangles.size()) return;
    points[3 * longOne] = Vec3(-400, -390, -380);
    points[3 * longOne + 1] = Vec3(400, 410, 390);
    points[3 * longOne + 2] = Vec3(390, 400, 410);
  }

  [[nodiscard]] PlaceOfVertex placeOf() const {
    return [this](VertexIndex v) { return points[v]; };
  }
};

TEST(PairsAt, AreAllPairsWithAMarkedVertex) {
  base::Job job(2, {});
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    // In the last two a long triangle, with a mark and without.
    const Soup soup = seed < 4 ? Soup(seed) : Soup(seed, seed == 4 ? 7 : 8);
    const std::vector<std::uint8_t> all(soup.points.size(), 1);
    std::vector<std::uint8_t> some(soup.points.size(), 0);
    for (std::size_t t = 0; t < soup.triangles.size(); t += 7) some[3 * t + t % 3] = 1;
    std::vector<intersect::PolygonPair> expected;
    for (const auto& pair : findPairsAt(soup.triangles, soup.points, soup.placeOf(), all, job)) {
      if (pair.a % 7 == 0 || pair.b % 7 == 0) expected.push_back(pair);
    }
    EXPECT_EQ(findPairsAt(soup.triangles, soup.points, soup.placeOf(), some, job), expected);
    found += expected.size();
  }
  EXPECT_GT(found, 20U);
}

TEST(PairsAt, AreNoneWithoutMarks) {
  base::Job job(1, {});
  const Soup soup(1);
  const std::vector<std::uint8_t> none(soup.points.size(), 0);
  EXPECT_TRUE(findPairsAt(soup.triangles, soup.points, soup.placeOf(), none, job).empty());
}

}  // namespace
}  // namespace tufa::chunks
