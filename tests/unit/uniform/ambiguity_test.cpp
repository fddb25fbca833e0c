#include "uniform/ambiguity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tufa::uniform {
namespace {

using Values = std::array<double, 4>;

// Values in cyclic order that alternate in sign, the first inside.
Values randomFace(std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.01, 1);
  return {-size(random), size(random), -size(random), size(random)};
}

Values turned(const Values& v) { return {v[1], v[2], v[3], v[0]}; }
Values turnedOver(const Values& v) { return {v[3], v[2], v[1], v[0]}; }

TEST(Ambiguity, FixedRulesDoNotLookAtValues) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Values face = randomFace(random);
    EXPECT_FALSE(joinsInside(Ambiguity::Separate, face));
    EXPECT_TRUE(joinsInside(Ambiguity::Join, face));
  }
}

TEST(Ambiguity, RulesDoNotDependOnWhereTheFaceStarts) {
  std::mt19937 random(2);
  for (const Ambiguity rule : {Ambiguity::Asymptotic, Ambiguity::Chord}) {
    for (int i = 0; i < 10000; ++i) {
      Values face = randomFace(random);
      const bool joins = joinsInside(rule, face);
      EXPECT_EQ(joinsInside(rule, turnedOver(face)), joins);
      for (int turn = 0; turn < 4; ++turn) {
        EXPECT_EQ(joinsInside(rule, face), joins);
        face = turned(face);
      }
    }
  }
}

TEST(Ambiguity, AsymptoticDeciderIsTheSignAtTheSaddle) {
  std::mt19937 random(3);
  for (int i = 0; i < 10000; ++i) {
    const Values v = randomFace(random);
    // Bilinear f(u, w) with corners (0,0), (1,0), (1,1), (0,1); its saddle is where both partial
    // derivatives vanish.
    const double mixed = v[0] - v[1] + v[2] - v[3];
    const double u = (v[0] - v[3]) / mixed, w = (v[0] - v[1]) / mixed;
    const double saddle =
        v[0] * (1 - u) * (1 - w) + v[1] * u * (1 - w) + v[2] * u * w + v[3] * (1 - u) * w;
    if (std::abs(saddle) < 1e-12) continue;
    EXPECT_EQ(joinsInside(Ambiguity::Asymptotic, v), saddle < 0);
  }
}

TEST(Ambiguity, StrongInsideCornersJoinUnderBothDeciders) {
  for (const Ambiguity rule : {Ambiguity::Asymptotic, Ambiguity::Chord}) {
    EXPECT_TRUE(joinsInside(rule, {-1, 0.1, -1, 0.1}));
    EXPECT_TRUE(joinsInside(rule, {0.1, -1, 0.1, -1}));
    EXPECT_FALSE(joinsInside(rule, {-0.1, 1, -0.1, 1}));
    EXPECT_FALSE(joinsInside(rule, {1, -0.1, 1, -0.1}));
  }
}

TEST(Ambiguity, CornersOnTheIsovalueDoNotUpsetTheDeciders) {
  for (const Ambiguity rule : {Ambiguity::Asymptotic, Ambiguity::Chord}) {
    // Outside corners at zero: the saddle is inside, and the chords are the same.
    EXPECT_EQ(joinsInside(rule, {-1, 0, -1, 0}), rule == Ambiguity::Asymptotic);
    EXPECT_EQ(joinsInside(rule, {-1, 0, -1, 1}), joinsInside(rule, {0, -1, 1, -1}));
  }
}

}  // namespace
}  // namespace tufa::uniform
