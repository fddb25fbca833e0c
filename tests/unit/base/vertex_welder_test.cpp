#include "base/vertex_welder.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace tufa::base {
namespace {

TEST(VertexWelder, GivesEqualPositionsOneIndexInTheOrderTheyCame) {
  std::vector<Position> positions;
  VertexWelder welder(positions);
  EXPECT_EQ(welder.indexOf({1, 2, 3}), 0U);
  EXPECT_EQ(welder.indexOf({3, 2, 1}), 1U);
  EXPECT_EQ(welder.indexOf({1, 2, 3}), 0U);
  EXPECT_EQ(positions, (std::vector<Position>{{1, 2, 3}, {3, 2, 1}}));
}

TEST(VertexWelder, TakesBothZerosForOne) {
  std::vector<Position> positions;
  VertexWelder welder(positions);
  EXPECT_EQ(welder.indexOf({0, -0.0, 0}), welder.indexOf({-0.0, 0, -0.0}));
}

TEST(VertexWelder, KnowsAllWhenItHasGrown) {
  std::vector<Position> positions;
  VertexWelder welder(positions);
  std::map<std::tuple<double, double, double>, VertexIndex> expected;
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    const auto number = [&] { return static_cast<double>(random() % 25) / 8; };
    const Position p(number(), number(), number());
    const auto next = static_cast<VertexIndex>(expected.size());
    const auto entry = expected.try_emplace({p.x, p.y, p.z}, next).first;
    ASSERT_EQ(welder.indexOf(p), entry->second);
  }
  EXPECT_EQ(positions.size(), expected.size());
  EXPECT_GT(positions.size(), 8000U);
}

}  // namespace
}  // namespace tufa::base
