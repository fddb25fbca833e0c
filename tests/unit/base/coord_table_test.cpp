#include "base/coord_table.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>

namespace tufa::base {
namespace {

TEST(CoordTable, KeepsTheFirstNumberOfEachCoordinate) {
  // Few values, so that many coordinates come again, and steps of 8, as origins of blocks have.
  std::mt19937 random(1);
  for (const int step : {1, 8, 1 << 20}) {
    std::uniform_int_distribution<int> value(-9, 9);
    CoordTable table;
    table.reserve(3000);
    std::map<Coord, std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const Coord at(step * value(random), step * value(random), step * value(random));
      EXPECT_EQ(table.tryEmplace(at, i), numbers.try_emplace(at, i).first->second);
    }
    for (int x = -10; x <= 10; ++x) {
      for (int y = -10; y <= 10; ++y) {
        for (int z = -10; z <= 10; ++z) {
          const Coord at(step * x, step * y, step * z);
          const auto found = numbers.find(at);
          EXPECT_EQ(table.find(at), found == numbers.end() ? CoordTable::kNone : found->second);
        }
      }
    }
  }
}

TEST(CoordTable, HoldsTheEndsOfTheRangeAndForgetsAll) {
  CoordTable table;
  EXPECT_EQ(table.find(Coord(0)), CoordTable::kNone);
  const Coord least(std::numeric_limits<int>::min()), greatest(std::numeric_limits<int>::max());
  table.reserve(2);
  table.tryEmplace(least, 7);
  table.tryEmplace(greatest, 0);
  EXPECT_EQ(table.find(least), 7U);
  EXPECT_EQ(table.find(greatest), 0U);
  table.reserve(0);
  EXPECT_EQ(table.find(least), CoordTable::kNone);
}

}  // namespace
}  // namespace tufa::base
