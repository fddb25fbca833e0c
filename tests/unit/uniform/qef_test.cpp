#include "uniform/qef.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "grid/vdb_coord.h"
#include "support/print.h"

namespace tufa::uniform {
namespace {

using openvdb::Mat3d;

struct Plane {
  Vec3 point;
  Vec3 normal;
};

Vector toVector(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Qef sumOf(const std::vector<Plane>& planes) {
  Qef sum;
  for (const Plane& plane : planes) sum += Qef(toVector(plane.point), toVector(plane.normal));
  return sum;
}

double errorAt(const std::vector<Plane>& planes, const Vec3& x) {
  double sum = 0;
  for (const Plane& plane : planes) sum += std::pow(plane.normal.dot(x - plane.point), 2);
  return sum;
}

Vec3 massPoint(const std::vector<Plane>& planes) {
  Vec3 sum(0);
  for (const Plane& plane : planes) sum += plane.point;
  return sum / static_cast<double>(planes.size());
}

class Planes {
 public:
  explicit Planes(unsigned seed) : random_(seed) {}
  double number(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Vec3 point(double half) {
    return {number(-half, half), number(-half, half), number(-half, half)};
  }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return Vec3(normal(random_), normal(random_), normal(random_)).unitOrX();
  }
  /// Planes whose normals lie about `mean`, the spread being 0 for equal ones.
  std::vector<Plane> about(const Vec3& mean, double spread, int count) {
    std::vector<Plane> planes;
    for (int i = 0; i < count; ++i) {
      planes.push_back({point(0.5), (mean + direction() * spread).unitOrX()});
    }
    return planes;
  }
  int count(int from, int to) { return std::uniform_int_distribution<int>(from, to)(random_); }

 private:
  std::mt19937 random_;
};

/// The least-squares point nearest to the mass point by OpenVDB's eigen-solver in double; none
/// where an eigenvalue lies too near the truncation for both to agree on it.
std::optional<Vec3> oracle(const std::vector<Plane>& planes) {
  Mat3d a = Mat3d::zero();
  Vec3 residual(0);
  const Vec3 c = massPoint(planes);
  for (const Plane& plane : planes) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) a(i, j) += plane.normal[i] * plane.normal[j];
    }
    residual += plane.normal * plane.normal.dot(plane.point - c);
  }
  Mat3d vectors;
  openvdb::Vec3d values;
  openvdb::math::diagonalizeSymmetricMatrix(a, vectors, values);
  const double largest = std::max({values[0], values[1], values[2]});
  Vec3 x = c;
  for (int i = 0; i < 3; ++i) {
    const double share = values[i] / largest;
    if (share > 0.007 && share < 0.013) return {};
    const Vec3 v = grid::fromVdb(vectors.col(i));
    if (share > 0.01) x += v * (v.dot(residual) / values[i]);
  }
  return x;
}

bool isInCube(const Vec3& x, double half) {
  return std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) <= half;
}

constexpr float kFar = 1e6F;

TEST(Qef, OfOnePlaneIsTheFootOfItsPoint) {
  const Plane plane{{0.1, -0.2, 0.3}, Vec3(1, 2, -2) / 3};
  EXPECT_LT((toVec3(solve(sumOf({plane}), 0.5F)) - plane.point).length(), 1e-6);
}

TEST(Qef, OfParallelPlanesIsOnTheirMeanBelowTheMassPoint) {
  Planes random(1);
  for (int n = 0; n < 200; ++n) {
    const Vec3 normal = random.direction();
    const auto planes = random.about(normal, 0, random.count(2, 9));
    const Vec3 x = toVec3(solve(sumOf(planes), kFar));
    EXPECT_LT((x - massPoint(planes)).length(), 2e-6);
  }
}

TEST(Qef, OfTwoSidesIsThePointOfTheirCreaseNearestToTheMassPoint) {
  Planes random(2);
  for (int n = 0; n < 200; ++n) {
    const Vec3 a = random.direction(), b = random.direction();
    const Vec3 along = a.cross(b);
    if (along.length() < 0.4) continue;
    const Vec3 start = random.point(0.3);
    std::vector<Plane> planes;
    for (int i = 0; i < 6; ++i) {
      const Vec3& normal = i < 3 ? a : b;
      planes.push_back({start + normal.cross(random.point(0.3)), normal});
    }
    const Vec3 direction = along.unitOrX();
    const Vec3 truth = start + direction * direction.dot(massPoint(planes) - start);
    EXPECT_LT((toVec3(solve(sumOf(planes), kFar)) - truth).length(), 2e-5);
  }
}

TEST(Qef, OfThreeSidesIsTheirCorner) {
  Planes random(3);
  int corners = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 corner = random.point(0.45);
    std::vector<Plane> planes;
    for (int side = 0; side < 3; ++side) {
      const Vec3 normal = random.direction();
      planes.push_back({corner + normal.cross(random.point(0.3)), normal});
      planes.push_back({corner + normal.cross(random.point(0.3)), normal});
    }
    if (std::abs(planes[0].normal.dot(planes[2].normal.cross(planes[4].normal))) < 0.4) continue;
    ++corners;
    EXPECT_LT((toVec3(solve(sumOf(planes), 0.5F)) - corner).length(), 2e-5);
  }
  EXPECT_GT(corners, 50);
}

TEST(Qef, AgreesWithAnotherSolverOnAnyPlanes) {
  Planes random(4);
  int compared = 0;
  for (int n = 0; n < 3000; ++n) {
    const auto planes = random.about(random.direction(), n % 2 == 0 ? 3 : random.number(0.2, 1),
                                     random.count(3, 12));
    const auto truth = oracle(planes);
    if (!truth) continue;
    ++compared;
    const double size = 1 + truth->length();
    ASSERT_LT((toVec3(solve(sumOf(planes), kFar)) - *truth).length(), 1e-3 * size) << n;
  }
  EXPECT_GT(compared, 2000);
}

/// Cells with one normal direction take the closed form; it must be as good as the eigen-solver.
TEST(Qef, ClosedFormOfOneDirectionAgreesWithTheSolver) {
  Planes random(5);
  int compared = 0;
  for (int n = 0; n < 3000; ++n) {
    const auto planes =
        random.about(random.direction(), random.number(0, 0.15), random.count(3, 12));
    const auto truth = oracle(planes);
    if (!truth) continue;
    ++compared;
    ASSERT_LT((toVec3(solve(sumOf(planes), kFar)) - *truth).length(), 5e-3) << n;
  }
  EXPECT_GT(compared, 2000);
}

TEST(Qef, DirectionsBelowAHundredthOfTheLargestEigenvalueAreFree) {
  // Two planes that meet at x = 0.2, z = 0, tilted by the angle to either side of z: the lesser
  // eigenvalue is tan^2(angle) of the larger.
  for (const double degrees : {1.0, 4.0, 5.5, 6.0, 8.0, 30.0}) {
    const double angle = degrees * std::acos(-1) / 180;
    std::vector<Plane> planes;
    for (const double side : {-1.0, 1.0}) {
      const Vec3 normal(side * std::sin(angle), 0, std::cos(angle));
      planes.push_back({Vec3(0.2, 0.1, 0) + normal.cross(Vec3(0, 0.1, 0)), normal});
    }
    const Vec3 mass = massPoint(planes);
    const Vec3 x = toVec3(solve(sumOf(planes), kFar));
    EXPECT_NEAR(x[0], degrees < 5.7 ? mass[0] : 0.2, 1e-4) << degrees;
    EXPECT_NEAR(x[1], mass[1], 1e-5) << degrees;
  }
}

TEST(Qef, BoundedSolutionIsTheBestOfTheCube) {
  Planes random(6);
  constexpr double kHalf = 0.5;
  int bounded = 0;
  for (int n = 0; n < 400; ++n) {
    const auto planes = random.about(random.direction(), 2, random.count(3, 8));
    const Vec3 x = toVec3(solve(sumOf(planes), kHalf));
    ASSERT_TRUE(isInCube(x, kHalf)) << x;
    const auto truth = oracle(planes);
    if (!truth || isInCube(*truth, kHalf)) continue;
    ++bounded;
    // The bounded problem has a slight pull to the mass point, 0.003 of its squared distance a
    // plane.
    const Vec3 c = massPoint(planes);
    const double pull = 0.003 * static_cast<double>(planes.size());
    const double error = errorAt(planes, x);
    constexpr int kSteps = 16;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        for (int k = 0; k <= kSteps; ++k) {
          const Vec3 p = Vec3(i, j, k) / kSteps - Vec3(0.5);
          ASSERT_LT(error, errorAt(planes, p) + pull * (p - c).squaredLength() + 1e-5)
              << n << " " << p;
        }
      }
    }
  }
  EXPECT_GT(bounded, 50);
}

TEST(Qef, SolutionInsideIsThatOfTheCubeOrNone) {
  Planes random(9);
  int inside = 0, none = 0;
  for (int n = 0; n < 2000; ++n) {
    const auto planes = random.about(random.direction(), n % 2 == 0 ? 2 : 0.1, random.count(3, 8));
    const auto found = solveInside(sumOf(planes), 0.5F);
    const Vector far = solve(sumOf(planes), kFar);
    // Where the far cube binds, so does the near one.
    EXPECT_EQ(found.has_value(), isInCube(toVec3(far), 0.5)) << n;
    ++(found ? inside : none);
    if (found) {
      EXPECT_EQ(*found, solve(sumOf(planes), 0.5F));
    }
  }
  EXPECT_GT(inside, 200);
  EXPECT_GT(none, 200);
}

TEST(Qef, BoundedSolutionIsNotTheClampedOne) {
  // A slanted crease that leaves the cube: clamping its nearest point would leave both planes.
  const std::vector<Plane> planes = {{{0.4, 0.4, 0}, Vec3(1, 0, 1).unitOrX()},
                                     {{0.4, -0.4, 0.3}, Vec3(1, 0, -1).unitOrX()},
                                     {{-0.4, 0.4, -0.3}, Vec3(0, 1, 0)}};
  const Vec3 x = toVec3(solve(sumOf(planes), 0.5F));
  const auto free = oracle(planes);
  ASSERT_TRUE(free);
  Vec3 clamped;
  for (int i = 0; i < 3; ++i) clamped[i] = std::clamp((*free)[i], -0.5, 0.5);
  EXPECT_LE(errorAt(planes, x), errorAt(planes, clamped) + 1e-6);
}

TEST(Qef, SolvedInBatchesAreThoseSolvedOneByOne) {
  Planes random(8);
  std::vector<Qef> qefs;
  std::vector<Vector> origins;
  for (int n = 0; n < 203; ++n) {
    qefs.push_back(
        sumOf(random.about(random.direction(), random.number(0, 2), random.count(1, 9))));
    origins.push_back(toVector(random.point(0.3)));
  }
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, qefs.size()}) {
    std::vector<Vector> solutions(count);
    solveAll(qefs.data(), origins.data(), count, 0.8F, solutions.data());
    for (std::size_t n = 0; n < count; ++n) {
      ASSERT_EQ(solutions[n], solve(qefs[n].seenFrom(origins[n]), 0.8F)) << n;
    }
  }
}

TEST(Qef, SumsDoNotDependOnTheOrigin) {
  Planes random(7);
  for (int n = 0; n < 100; ++n) {
    const auto planes = random.about(random.direction(), 3, 6);
    const Vec3 origin = random.point(4);
    std::vector<Plane> moved = planes;
    for (Plane& plane : moved) plane.point -= origin;
    const Qef seen = sumOf(planes).seenFrom(toVector(origin));
    const Qef direct = sumOf(moved);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(seen.b[i], direct.b[i], 1e-4);
      EXPECT_NEAR(seen.points[i], direct.points[i], 1e-4);
    }
    EXPECT_EQ(seen.a, direct.a);
    EXPECT_EQ(seen.count, direct.count);
  }
}

}  // namespace
}  // namespace tufa::uniform
