#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/direction.h"

namespace tufa::base {
namespace {

TEST(Direction, IsCloseToTheVectorThatItWasMadeOf) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  float worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3f v = unit({normal(random), normal(random), normal(random)});
    const Vec3f kept = Direction(v * 3).vector();
    worst = std::max(worst, length(kept - v));
    EXPECT_NEAR(length(kept), 1, 1e-6);
  }
  EXPECT_LT(worst, 1e-4f);
  EXPECT_GT(worst, 1e-6f);
}

TEST(Direction, IsExactAlongAxesAndBetweenThem) {
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Vec3f v(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        EXPECT_LE(length(Direction(v).vector() - unit(v)), 2e-7f) << x << y << z;
      }
    }
  }
}

TEST(Direction, OfNoLengthIsNone) {
  EXPECT_TRUE(Direction().isNone());
  EXPECT_TRUE(Direction(Vec3f()).isNone());
  EXPECT_EQ(Direction().vector(), Vec3f());
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(Direction(Vec3f(1, kNoNumber, 0)).isNone());
  EXPECT_FALSE(Direction(Vec3f(-1e-30f, 0, 0)).isNone());
}

}  // namespace
}  // namespace tufa::base
