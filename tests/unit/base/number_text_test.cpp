#include "base/number_text.h"

#include <gtest/gtest.h>

#include <string>

namespace tufa::base {
namespace {

TEST(NumberText, IsTheShortestThatReadsBack) {
  EXPECT_EQ(numberText(0.1), "0.1");
  EXPECT_EQ(numberText(-3), "-3");
  EXPECT_EQ(numberText(1e-300), "1e-300");
  EXPECT_EQ(std::stod(numberText(1.0 / 3)), 1.0 / 3);
}

TEST(RoughNumberText, HasThreeSignificantDigits) {
  EXPECT_EQ(roughNumberText(1725907638.4272392), "1730000000");
  EXPECT_EQ(roughNumberText(999.7), "1000");
  EXPECT_EQ(roughNumberText(12.345), "12.3");
  EXPECT_EQ(roughNumberText(0.012345), "0.0123");
  EXPECT_EQ(roughNumberText(0), "0");
  EXPECT_EQ(roughNumberText(-45678), "-45700");
  EXPECT_EQ(roughNumberText(1e300), "1e+300");
}

}  // namespace
}  // namespace tufa::base
