#include "base/bits.h"

#include <gtest/gtest.h>

#include <bitset>
#include <random>
#include <vector>

namespace tufa::base {
namespace {

TEST(Bits, AreVisitedLowestFirst) {
  std::vector<int> visited;
  forEachBit((std::uint64_t{1} << 63) | 0x12, [&](int bit) { visited.push_back(bit); });
  EXPECT_EQ(visited, (std::vector<int>{1, 4, 63}));
  forEachBit(0, [](int) { FAIL(); });
}

TEST(Bits, AreCounted) {
  std::mt19937_64 random(1);
  EXPECT_EQ(countBits(0), 0);
  EXPECT_EQ(countBits(~std::uint64_t{0}), 64);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t word = i % 2 == 0 ? random() : random() & random() & random();
    EXPECT_EQ(countBits(word), static_cast<int>(std::bitset<64>(word).count()));
  }
}

TEST(Bits, BelowABitAreAllLowerOnes) {
  EXPECT_EQ(bitsBelow(0), 0U);
  EXPECT_EQ(bitsBelow(3), 7U);
  EXPECT_EQ(bitsBelow(63), ~std::uint64_t{0} >> 1);
}

}  // namespace
}  // namespace tufa::base
