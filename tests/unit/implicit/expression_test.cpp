#include <gtest/gtest.h>
#include <tufa/implicit.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "implicit/boxes.h"
#include "support/expect_error.h"

#ifdef TUFA_HAS_MUPARSER
#include <muParser.h>

#include <random>
#endif

namespace tufa {
namespace {

using implicit::makeExpression;
using test::expectError;

TEST(Expression, MeansWhatCWouldMean) {
  using Function = std::function<double(double, double, double)>;
  const std::vector<std::pair<std::string, Function>> all = {
      {"1", [](double, double, double) { return 1.0; }},
      {"z", [](double, double, double z) { return z; }},
      {"y - (x)", [](double x, double y, double) { return y - x; }},
      {" 1 + 2 * x - 3 / y ", [](double x, double y, double) { return 1 + 2 * x - 3 / y; }},
      {"x - y - z", [](double x, double y, double z) { return x - y - z; }},
      {"x / y / z", [](double x, double y, double z) { return x / y / z; }},
      {"-x^2", [](double x, double, double) { return -(x * x); }},
      {"2^3^2", [](double, double, double) { return 512.0; }},
      {"2^-1", [](double, double, double) { return 0.5; }},
      {"x^-2", [](double x, double, double) { return 1 / (x * x); }},
      {"x^7", [](double x, double, double) { return std::pow(x, 7); }},
      {"x^y", [](double x, double y, double) { return std::pow(x, y); }},
      {"x^0.5", [](double x, double, double) { return std::sqrt(x); }},
      {"--x+-y", [](double x, double y, double) { return x - y; }},
      {"3*-x", [](double x, double, double) { return -3 * x; }},
      {"x*x*x", [](double x, double, double) { return x * x * x; }},
      {"1.5e-2*x+.5", [](double x, double, double) { return 0.015 * x + 0.5; }},
      {"sin(x)*cos(y)+tan(z)",
       [](double x, double y, double z) { return std::sin(x) * std::cos(y) + std::tan(z); }},
      {"exp(ln(x)) + sqrt(abs(-y)) + atan(z)",
       [](double x, double y, double z) {
         return std::exp(std::log(x)) + std::sqrt(std::abs(-y)) + std::atan(z);
       }},
      {"min(x, max(y, z)) + pi * e",
       [](double x, double y, double z) {
         return std::min(x, std::max(y, z)) + std::numbers::pi * std::numbers::e;
       }},
  };
  for (const auto& [text, function] : all) {
    const auto field = makeExpression(text);
    for (const double x : {0.3, 1.7}) {
      for (const double y : {0.6, 2.1}) {
        for (const double z : {0.2, 1.1}) {
          EXPECT_NEAR(field->value({x, y, z}), function(x, y, z),
                      1e-13 * (1 + std::abs(function(x, y, z))))
              << text;
        }
      }
    }
  }
}

TEST(Expression, SaysWhereATextIsWrong) {
  const auto refused = [](const std::string& text, const std::string& part) {
    expectError(ErrorCode::InvalidArgument, part, [&] { static_cast<void>(makeExpression(text)); });
  };
  refused("", "at character 1");
  refused("x +", "at character 4 of the expression, its end");
  refused("(x", "closing parenthesis");
  refused("x y", "at character 3");
  refused("x + w", "there is no w");
  refused("sin x", "sin needs its argument in parentheses");
  refused("min(x)", "two arguments");
  refused("sin(x, y)", "closing parenthesis");
  refused("1e999", "number");
  refused("x $ y", "at character 3");
  refused(std::string("x\0y", 3), "at character 2");
  refused(std::string(100000, '('), "nested deeper");
  refused(std::string(100000, '-') + "x^" + std::string(1000, '('), "nested deeper");
  std::string longOne = "x";
  for (int n = 0; n < 20000; ++n) longOne += "+" + std::to_string(n) + "*y";
  refused(longOne, "more than 10000 operations");
  std::string powers = "x";
  for (int n = 0; n < 1000; ++n) powers += "^x";
  refused(powers, "nested deeper");
}

/// A point of no value is outside, and no bound says otherwise.
TEST(Expression, BoundsCoverWhatIsUndefined) {
  const auto field = makeExpression("(x - 1) / (x - 1) - 2");
  EXPECT_EQ(field->value({1, 0, 0}), std::numeric_limits<double>::infinity());
  const auto bound = field->bound({{0, 0, 0}, {2, 1, 1}});
  EXPECT_LT(bound.least, 0);
  EXPECT_GT(bound.greatest, 0);
  // Roots and logarithms of what is negative are those of 0.
  EXPECT_EQ(makeExpression("sqrt(x) - 1")->value({-4, 0, 0}), -1);
}

/// Powers that are whole have a value everywhere, however they are written.
TEST(Expression, WholePowersAreOfNumbersBelow0Too) {
  const auto at = [](const std::string& text, double x) {
    return makeExpression(text)->value({x, 0, 0});
  };
  EXPECT_EQ(at("x^66", -1), 1);
  EXPECT_EQ(at("x^999999", -1), -1);
  EXPECT_EQ(at("x^-(66)", -1), 1);
  EXPECT_EQ(at("x^2^2", -2), 16);
  EXPECT_EQ(at("x^(4/2)", -3), 9);
  EXPECT_EQ(at("x^(1 + min(2, sqrt(9)))", -2), -8);
  EXPECT_EQ(at("(2 - 1) * x^(2 - 1)", -2), -2);
  EXPECT_EQ(at("x^1.5", -2), 0);
  EXPECT_EQ(at("x^(1/0) - 1", 0.5), -1);
}

/// Where a power, or a logarithm, of a number below 0 ends, what is beside it in a sum does not.
TEST(Expression, HasAGradientBesidePowersOfNumbersBelow0) {
  const auto expectGradient = [](const std::string& text, const Position& p, const Position& due) {
    const auto field = makeExpression(text);
    const Position gradient = field->gradient(p);
    const auto bound = field->gradientBound({{p.x - 0.1, p.y - 0.1, p.z - 0.1}, p});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double slope = Vec3(gradient)[axis];
      EXPECT_NEAR(slope, Vec3(due)[axis], 1e-12) << text << " by " << axis;
      EXPECT_GE(slope, Vec3(bound.least)[axis]) << text << " by " << axis;
      EXPECT_LE(slope, Vec3(bound.greatest)[axis]) << text << " by " << axis;
    }
  };
  expectGradient("x^2+y^2+z^1.5-1", {0.6, 0.7, -0.3}, {1.2, 1.4, 0});
  expectGradient("x^2+y^2+z^1.5-1", {0.6, 0.7, 0}, {1.2, 1.4, 0});
  expectGradient("abs(x)^2.5+abs(y)^2.5+abs(z)^2.5-1", {0, 0.5, 0.9},
                 {0, 2.5 * std::pow(0.5, 1.5), 2.5 * std::pow(0.9, 1.5)});
  expectGradient("x^2+y^2+exp(1.5*ln(z))-1", {0.6, 0.7, -0.3}, {1.2, 1.4, 0});
  expectGradient("x^2+y^2+z^(1.5+0*x)-1", {0.6, 0.7, -0.3}, {1.2, 1.4, 0});
  expectGradient("x^2+y^2+atan(5/max(z,0))-1", {0.6, 0.7, -0.3}, {1.2, 1.4, 0});
  // Bounds of the slope are no wider where a power ends.
  EXPECT_NEAR(makeExpression("z^1.5")->lipschitz({{-1, -1, -1}, {1, 1, 1}}), 1.5, 1e-12);
}

/// Steps of half a voxel stood for distances there.
TEST(Expression, IsAsSmoothBesidePowersOfNumbersBelow0) {
  const auto field = makeExpression("x^2+y^2+z^1.5-1");
  EXPECT_NEAR(field->distance({0.6, 0.7, -0.3}, 0.3), std::hypot(0.6, 0.7) - 1, 1e-3);
}

/// In whichever order they come.
TEST(Expression, LeastAndGreatestOfNoValueHaveNone) {
  for (const std::string text : {"min(%, x)", "min(x, %)", "max(%, x)", "max(x, %)",
                                 "atan(min(max(-1, %), 2))", "max(%, %)"}) {
    std::string full = text;
    for (auto at = full.find('%'); at != std::string::npos; at = full.find('%')) {
      full.replace(at, 1, "(y/y - 2)");
    }
    const auto field = makeExpression(full);
    EXPECT_EQ(field->value({-5, 0, 0}), implicit::kInfinity) << full;
    EXPECT_LT(field->value({-5, 1, 0}), 0) << full;
    EXPECT_EQ(field->bound({{-6, -1, -1}, {-4, 1, 1}}).greatest, implicit::kInfinity) << full;
    EXPECT_GE(field->lipschitz({{-6, -1, -1}, {-4, 1, 1}}),
              Vec3(field->gradient({-5, 0, 0})).length())
        << full;
  }
}

TEST(Expression, EqualPartsAreOne) {
  // 2^14 products, if each were computed by itself.
  std::string text = "x";
  for (int n = 0; n < 14; ++n) text = "(" + text + "+0.1)*(" + text + "+0.1)";
  EXPECT_GT(text.size(), 100000u);
  EXPECT_TRUE(std::isfinite(makeExpression(text)->value({0.1, 0, 0})));
}

#ifdef TUFA_HAS_MUPARSER

/// An expression of any form, of positive numbers: what is negative, muParser gives no root of.
std::string anyExpression(std::mt19937& random, int depth) {
  const auto pick = [&](unsigned count) { return static_cast<unsigned>(random()) % count; };
  if (depth == 0 || pick(6) == 0) {
    constexpr const char* kAtoms[] = {"x", "y", "z", "1.5", "2", "0.25e1"};
    return kAtoms[pick(6)];
  }
  const std::string a = anyExpression(random, depth - 1);
  const std::string b = anyExpression(random, depth - 1);
  constexpr const char* kBetween[] = {" + ", "-", "*", " / "};
  constexpr const char* kAround[] = {"sin", "cos", "atan", "abs", "exp"};
  switch (pick(8)) {
    case 0:
      return kAround[pick(5)] + ("(" + a + ")");
    case 1:
      return "min(" + a + "," + b + ")";
    case 2:
      return "(-" + a + ")";
    case 3:
      return "sqrt(abs(" + a + "))";
    case 4:
      return "(" + a + ")^" + std::to_string(pick(5));
    case 5:
      return "(-(" + a + ")^2)";
    default:
      return "(" + a + kBetween[pick(4)] + b + ")" + kBetween[pick(4)] + b;
  }
}

TEST(Expression, MeansWhatMuParserMeans) {
  std::mt19937 random(22);
  int compared = 0;
  for (int n = 0; n < 2000; ++n) {
    const std::string text = anyExpression(random, 4);
    double x = 0.7;
    double y = 1.3;
    double z = 0.4;
    mu::Parser parser;
    parser.DefineVar("x", &x);
    parser.DefineVar("y", &y);
    parser.DefineVar("z", &z);
    parser.SetExpr(text);
    double due = 0;
    try {
      due = parser.Eval();
    } catch (const mu::Parser::exception_type& error) {
      FAIL() << text << ": " << error.GetMsg();
    }
    if (!(std::abs(due) < 1e6)) continue;  // where roundings count
    ++compared;
    ASSERT_NEAR(makeExpression(text)->value({x, y, z}), due, 1e-7 * (1 + std::abs(due))) << text;
  }
  EXPECT_GT(compared, 1000);
}

#endif

}  // namespace
}  // namespace tufa
