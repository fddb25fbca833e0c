#include "intersect/exact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tufa {
namespace {

__extension__ using Wide = __int128;

int signOf(Wide value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

struct Integers {
  std::int64_t x, y, z;
  [[nodiscard]] Position position() const {
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
};

// The sign of the determinant of b - a, c - a and d - a, turned so that d seeing the rest
// counter-clockwise is positive.
int orientationOf(const Integers& a, const Integers& b, const Integers& c, const Integers& d) {
  const Wide bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z;
  const Wide cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
  const Wide dx = d.x - a.x, dy = d.y - a.y, dz = d.z - a.z;
  return signOf(bx * (cy * dz - cz * dy) - by * (cx * dz - cz * dx) + bz * (cx * dy - cy * dx));
}

TEST(Exact, ASeerAboveSeesCounterClockwise) {
  const Position a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(intersect::orientation(a, b, c, {0.2, 0.2, 1}), 1);
  EXPECT_EQ(intersect::orientation(a, b, c, {0.2, 0.2, -1}), -1);
  EXPECT_EQ(intersect::orientation(a, b, c, {7, -3, 0}), 0);
}

TEST(Exact, OrientationAgreesWithWholeNumbers) {
  std::mt19937 random(3);
  for (const std::int64_t size : {2, 1000, 1 << 26}) {
    std::uniform_int_distribution<std::int64_t> coordinate(-size, size);
    const auto point = [&] {
      return Integers{coordinate(random), coordinate(random), coordinate(random)};
    };
    for (int i = 0; i < 20000; ++i) {
      const Integers a = point(), b = point(), c = point(), d = point();
      ASSERT_EQ(intersect::orientation(a.position(), b.position(), c.position(), d.position()),
                orientationOf(a, b, c, d));
    }
  }
}

// d lies in the plane of the others up to one unit in coordinates of 27 bits: rounding would tell
// many of these wrong.
TEST(Exact, OrientationOfNearlyFlatPointsAgreesWithWholeNumbers) {
  std::mt19937 random(4);
  std::uniform_int_distribution<std::int64_t> coordinate(1 << 24, 1 << 25), step(-1, 1);
  int flat = 0;
  for (int i = 0; i < 20000; ++i) {
    const Integers a{coordinate(random), coordinate(random), coordinate(random)};
    const Integers b{coordinate(random), coordinate(random), coordinate(random)};
    const Integers c{2 * b.x - a.x + step(random), 2 * b.y - a.y + step(random),
                     2 * b.z - a.z + step(random)};
    const Integers d{3 * b.x - 2 * a.x + step(random), 3 * b.y - 2 * a.y,
                     3 * b.z - 2 * a.z + step(random)};
    const int expected = orientationOf(a, b, c, d);
    flat += expected == 0 ? 1 : 0;
    ASSERT_EQ(intersect::orientation(a.position(), b.position(), c.position(), d.position()),
              expected);
  }
  EXPECT_GT(flat, 100);
}

TEST(Exact, NeighbouringNumbersAreToldApart) {
  const double above = std::nextafter(0.5, 1.0);
  const Position a(0.1, 0.1, 0.5), b(12.3, 0.1, 0.5), c(0.1, 45.6, 0.5);
  EXPECT_EQ(intersect::orientation(a, b, c, {78.9, 0.3, above}), 1);
  EXPECT_EQ(intersect::orientation(a, b, c, {78.9, 0.3, 0.5}), 0);
  EXPECT_EQ(intersect::orientationAcross(2, {0, 0, 0}, {1, 1, 0}, {0.5, above, 0}), 1);
  EXPECT_EQ(intersect::orientationAcross(2, {0, 0, 0}, {1, 1, 0}, {above, above, 9}), 0);
}

TEST(Exact, EachAxisIsSeenTheSameWay) {
  const Position a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), up(0, 0, 1);
  EXPECT_EQ(intersect::orientationAcross(2, a, b, c), 1);
  EXPECT_EQ(intersect::orientationAcross(0, a, c, up), 1);
  EXPECT_EQ(intersect::orientationAcross(1, a, up, b), 1);
}

}  // namespace
}  // namespace tufa
