// Metaballs against their sum, convolution surfaces against quadrature.

#include <gtest/gtest.h>
#include <tufa/implicit.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "implicit/boxes.h"
#include "implicit/convolution.h"
#include "implicit/metaballs.h"

namespace tufa {
namespace {

using implicit::BallKernel;
using implicit::ConvolutionKernel;
using implicit::ConvolutionOptions;
using implicit::makeConvolution;
using implicit::makeMetaballs;
using implicit::Metaball;
using implicit::SkeletonArc;
using implicit::SkeletonPart;
using implicit::SkeletonSegment;
using implicit::SkeletonTriangle;

constexpr double kPi = std::numbers::pi;

double uniform(std::mt19937& random, double least, double greatest) {
  return least + (greatest - least) * static_cast<double>(random()) / 4294967295.0;
}
Vec3 anyPoint(std::mt19937& random, double reach) {
  const double x = uniform(random, -reach, reach);
  const double y = uniform(random, -reach, reach);
  return {x, y, uniform(random, -reach, reach)};
}

double kernelAt(ConvolutionKernel kernel, double r) {
  switch (kernel) {
    case ConvolutionKernel::Gaussian:
      return std::exp(-r * r);
    case ConvolutionKernel::Polynomial:
      return r < 1 ? (1 - r * r) * (1 - r * r) : 0;
    case ConvolutionKernel::Cauchy:
      break;
  }
  return 1 / ((1 + r * r) * (1 + r * r));
}

/// Over [0, 1], by Simpson's rule.
double integrate(const std::function<double(double)>& function) {
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int n = 0; n <= kSteps; ++n) {
    const double weight = n == 0 || n == kSteps ? 1 : n % 2 == 1 ? 4 : 2;
    sum += weight * function(static_cast<double>(n) / kSteps);
  }
  return sum / (3 * kSteps);
}

/// What a curve adds: point(t) for t from 0 to 1, at even speed.
double quadrature(ConvolutionKernel kernel, double width, double length, const Vec3& p,
                  const std::function<Vec3(double)>& point) {
  const double whole = kernel == ConvolutionKernel::Cauchy     ? kPi / 2
                       : kernel == ConvolutionKernel::Gaussian ? std::sqrt(kPi)
                                                               : 16.0 / 15;
  return integrate([&](double t) { return kernelAt(kernel, (point(t) - p).length() / width); }) *
         length / width / whole;
}

constexpr ConvolutionKernel kKernels[] = {ConvolutionKernel::Cauchy, ConvolutionKernel::Gaussian,
                                          ConvolutionKernel::Polynomial};

TEST(Convolution, SegmentsAreTheirQuadrature) {
  const SkeletonSegment bone{{-0.7, 0.1, 0}, {0.8, -0.2, 0.4}};
  for (const ConvolutionKernel kernel : kKernels) {
    const auto field = makeConvolution({{bone, 1}}, {kernel, 0.5, 0.3});
    std::mt19937 random;
    for (int n = 0; n < 50; ++n) {
      const Vec3 p = anyPoint(random, 1.2);
      const double sum = quadrature(kernel, 0.5, (bone.b - bone.a).length(), p,
                                    [&](double t) { return bone.a + (bone.b - bone.a) * t; });
      EXPECT_NEAR(0.3 - field->value(p), sum, 1e-6);
    }
  }
}

TEST(Convolution, ArcsAreTheirQuadrature) {
  const Vec3 axis = Vec3(2, 1, 2) / 3.0;
  for (const double angle : {0.7, 3.5, 2 * kPi}) {
    const SkeletonArc bow{{0.1, 0, -0.1}, axis, Vec3(1, -2, 0) * 0.3, angle};
    const auto field = makeConvolution({{bow, 1}}, {ConvolutionKernel::Cauchy, 0.4, 0.3});
    std::mt19937 random;
    for (int n = 0; n < 50; ++n) {
      const Vec3 p = n == 0 ? bow.centre + axis * 0.2 : anyPoint(random, 1.2);
      const double sum =
          quadrature(ConvolutionKernel::Cauchy, 0.4, bow.start.length() * angle, p, [&](double t) {
            return bow.centre + bow.start * std::cos(t * angle) +
                   axis.cross(bow.start) * std::sin(t * angle);
          });
      EXPECT_NEAR(0.3 - field->value(p), sum, 1e-6) << angle;
    }
  }
}

TEST(Convolution, TrianglesAreTheirQuadrature) {
  const SkeletonTriangle sail{{-0.6, -0.5, 0.1}, {0.8, -0.3, 0.2}, {0.1, 0.9, -0.4}};
  const auto field = makeConvolution({{sail, 1}}, {ConvolutionKernel::Cauchy, 0.5, 0.3});
  const double area = (sail.b - sail.a).cross(sail.c - sail.a).length() / 2;
  std::mt19937 random;
  for (int n = 0; n < 20; ++n) {
    const Vec3 p = anyPoint(random, 1.2);
    // The middles of small triangles.
    constexpr int kSide = 200;
    double sum = 0;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide - i; ++j) {
        const auto add = [&](double u, double v) {
          const Vec3 at =
              sail.a + (sail.b - sail.a) * (u / kSide) + (sail.c - sail.a) * (v / kSide);
          sum += kernelAt(ConvolutionKernel::Cauchy, (at - p).length() / 0.5);
        };
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j < kSide - 1) add(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
    sum *= area / (kSide * kSide) / (0.25 * kPi);
    EXPECT_NEAR(0.3 - field->value(p), sum, 1e-4);
  }
}

TEST(Convolution, PartsAddUpToTheWhole) {
  const Vec3 a(-0.7, 0.1, 0);
  const Vec3 b(0.8, -0.2, 0.4);
  const Vec3 cut = a + (b - a) * 0.37;
  const Vec3 c(0.1, 0.9, -0.4);
  const SkeletonArc whole{{0, 0, 0}, {0, 0, 1}, {0.7, 0, 0}, 3};
  const SkeletonArc first{{0, 0, 0}, {0, 0, 1}, {0.7, 0, 0}, 1.2};
  const SkeletonArc second{
      {0, 0, 0}, {0, 0, 1}, {0.7 * std::cos(1.2), 0.7 * std::sin(1.2), 0}, 1.8};
  const auto expectEqual = [](const std::vector<SkeletonPart>& one,
                              const std::vector<SkeletonPart>& parts,
                              const ConvolutionOptions& options) {
    const auto field = makeConvolution(one, options);
    const auto sum = makeConvolution(parts, options);
    std::mt19937 random;
    for (int n = 0; n < 300; ++n) {
      const Vec3 p = anyPoint(random, 1.5);
      // No bulge where two parts of one line meet.
      ASSERT_NEAR(field->value(p), sum->value(p), 1e-12);
      ASSERT_LT((Vec3(field->gradient(p)) - Vec3(sum->gradient(p))).length(), 1e-11);
    }
  };
  for (const ConvolutionKernel kernel : kKernels) {
    expectEqual({{SkeletonSegment{a, b}, 1}},
                {{SkeletonSegment{a, cut}, 1}, {SkeletonSegment{cut, b}, 1}}, {kernel, 0.4, 0.3});
  }
  const ConvolutionOptions cauchy{ConvolutionKernel::Cauchy, 0.4, 0.3};
  expectEqual({{SkeletonTriangle{a, b, c}, 1}},
              {{SkeletonTriangle{a, cut, c}, 1}, {SkeletonTriangle{cut, b, c}, 1}}, cauchy);
  expectEqual({{whole, 1}}, {{first, 1}, {second, 1}}, cauchy);
}

TEST(Convolution, AreOneOnLinesAndInPlanesWithoutEnd) {
  for (const ConvolutionKernel kernel : kKernels) {
    const auto line =
        makeConvolution({{SkeletonSegment{{-1e4, 0, 0}, {1e4, 0, 0}}, 1}}, {kernel, 0.5, 0.3});
    EXPECT_NEAR(0.3 - line->value({3, 0, 0}), 1, 1e-9);
  }
  const auto plane =
      makeConvolution({{SkeletonTriangle{{-1e4, -1e4, 0}, {1e4, -1e4, 0}, {0, 1e4, 0}}, 1}},
                      {ConvolutionKernel::Cauchy, 0.5, 0.3});
  EXPECT_NEAR(0.3 - plane->value({3, 0, 0}), 1, 1e-6);
}

double densityOf(BallKernel kernel, double s, double blobbiness) {
  switch (kernel) {
    case BallKernel::Blinn:
      return std::exp(-blobbiness * s * s);
    case BallKernel::Nishimura:
      return s < 1.0 / 3 ? 1 - 3 * s * s : s < 1 ? 1.5 * (1 - s) * (1 - s) : 0;
    case BallKernel::Wyvill:
      break;
  }
  return s < 1 ? 1 - 22.0 / 9 * s * s + 17.0 / 9 * std::pow(s, 4) - 4.0 / 9 * std::pow(s, 6) : 0;
}

TEST(Metaballs, AreTheSumOfAllBalls) {
  std::mt19937 random;
  std::vector<Metaball> balls;
  for (int n = 0; n < 2000; ++n) {
    balls.push_back({anyPoint(random, 1), uniform(random, 0.05, 0.3), uniform(random, -0.5, 1)});
  }
  for (const BallKernel kernel : {BallKernel::Blinn, BallKernel::Nishimura, BallKernel::Wyvill}) {
    const auto field = makeMetaballs(balls, {kernel, 0.5, 4});
    for (int n = 0; n < 100; ++n) {
      const Vec3 p = anyPoint(random, 1.2);
      double sum = 0;
      for (const Metaball& ball : balls) {
        sum += ball.weight * densityOf(kernel, (p - ball.centre).length() / ball.radius, 4);
      }
      EXPECT_NEAR(field->value(p), 0.5 - sum, 1e-6);
    }
  }
}

TEST(Metaballs, BoundsHoldWhereBlinnsKernelEnds) {
  const auto ball = makeMetaballs({{{0, 0, 0}, 1, -3}}, {BallKernel::Blinn, 0.4, 4});
  const double end = std::sqrt(-std::log(1e-9) / 4);
  const implicit::Box box{{end - 1e-6, 0, 0}, {end + 2e-6, 1e-9, 1e-9}};
  const implicit::Interval bound = ball->bound(box);
  for (const double x : {end - 1e-6, end - 1e-9, end + 1e-9}) {
    const double value = ball->value({x, 0, 0});
    EXPECT_GE(value, bound.least);
    EXPECT_LE(value, bound.greatest);
  }
  EXPECT_LT(bound.greatest - bound.least, 2e-8);
}

TEST(Metaballs, HaveTheKernelsOfTheirAuthors) {
  for (const BallKernel kernel : {BallKernel::Blinn, BallKernel::Nishimura, BallKernel::Wyvill}) {
    const auto field = makeMetaballs({{{0, 0, 0}, 2, 1}}, {kernel, 0.5, 4});
    EXPECT_NEAR(field->value({0, 0, 0}), -0.5, 1e-15);
    EXPECT_NEAR(Vec3(field->gradient({0, 0, 0})).length(), 0, 1e-15);
  }
  const auto at = [](BallKernel kernel, double s) {
    return 0.5 - makeMetaballs({{{0, 0, 0}, 2, 1}}, {kernel, 0.5, 4})->value({2 * s, 0, 0});
  };
  EXPECT_NEAR(at(BallKernel::Wyvill, 0.5), 0.5, 1e-12);
  EXPECT_NEAR(at(BallKernel::Wyvill, 1), 0, 1e-12);
  EXPECT_NEAR(at(BallKernel::Nishimura, 1.0 / 3), 2.0 / 3, 1e-12);
  EXPECT_NEAR(at(BallKernel::Blinn, 1), std::exp(-4), 1e-12);
}

}  // namespace
}  // namespace tufa
