#include "uniform/qef.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tufa::uniform {
namespace {

// Eigenvalues below this share of the largest belong to directions that the planes leave free:
// noise in normals a few degrees apart would move the point far along them.
constexpr double kFreeShare = 0.01;
// Pull to the mass point in the bounded problem, in units of the number of planes. It keeps the
// problem definite; at a right-angled crease it moves the vertex by about a hundredth of its way.
constexpr double kPull = 0.003;

using Vector3 = std::array<double, 3>;
using Matrix3 = std::array<Vector3, 3>;

Matrix3 matrixOf(const Qef& qef) {
  const auto& a = qef.a;
  return {{{a[0], a[1], a[2]}, {a[1], a[3], a[4]}, {a[2], a[4], a[5]}}};
}

// The right-hand side of the normal equations with the origin at c: sum of n (n . (p - c)).
Vector residualAt(const Qef& qef, const Vector& c) {
  const auto& a = qef.a;
  return {qef.b[0] - (a[0] * c[0] + a[1] * c[1] + a[2] * c[2]),
          qef.b[1] - (a[1] * c[0] + a[3] * c[1] + a[4] * c[2]),
          qef.b[2] - (a[2] * c[0] + a[4] * c[1] + a[5] * c[2])};
}

// One Jacobi rotation in the plane of rows p and q; zeroes m[p][q].
void rotate(Matrix3& m, Matrix3& vectors, int p, int q) {
  if (m[p][q] == 0) return;
  const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
  const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  for (int i = 0; i < 3; ++i) {
    const double mp = m[i][p], mq = m[i][q];
    m[i][p] = c * mp - s * mq;
    m[i][q] = s * mp + c * mq;
  }
  for (int i = 0; i < 3; ++i) {
    const double mp = m[p][i], mq = m[q][i];
    m[p][i] = c * mp - s * mq;
    m[q][i] = s * mp + c * mq;
    const double vp = vectors[i][p], vq = vectors[i][q];
    vectors[i][p] = c * vp - s * vq;
    vectors[i][q] = s * vp + c * vq;
  }
}

// The least-squares step from the mass point by the pseudo-inverse without the free directions, as
// Ju et al. 2002 truncate theirs. Cyclic Jacobi sweeps converge quadratically: a few do.
Vector truncatedStep(const Qef& qef, const Vector& residual) {
  Matrix3 m = matrixOf(qef);
  Matrix3 vectors = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const double size = m[0][0] + m[1][1] + m[2][2];
  for (int sweep = 0; sweep < 12; ++sweep) {
    if (std::abs(m[0][1]) + std::abs(m[0][2]) + std::abs(m[1][2]) < 1e-12 * size) break;
    rotate(m, vectors, 0, 1);
    rotate(m, vectors, 0, 2);
    rotate(m, vectors, 1, 2);
  }
  const double largest = std::max({m[0][0], m[1][1], m[2][2]});
  Vector step{};
  for (int i = 0; i < 3; ++i) {
    if (m[i][i] <= kFreeShare * largest) continue;
    double along = 0;
    for (int j = 0; j < 3; ++j) along += vectors[j][i] * static_cast<double>(residual[j]);
    for (int j = 0; j < 3; ++j) {
      step[j] += static_cast<float>(vectors[j][i] * along / m[i][i]);
    }
  }
  return step;
}

// Solves the system for the free axes, the others being held, by Gaussian elimination. The matrix
// is positive definite, so no pivoting is needed.
void solveFree(const Matrix3& m, const Vector3& r, const std::array<bool, 3>& free, Vector3& x) {
  Matrix3 a = m;
  Vector3 right = r;
  for (int i = 0; i < 3; ++i) {
    if (!free[i]) continue;
    for (int j = 0; j < 3; ++j) {
      if (!free[j]) right[i] -= m[i][j] * x[j];
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (!free[i]) continue;
    for (int k = i + 1; k < 3; ++k) {
      if (!free[k]) continue;
      const double f = a[k][i] / a[i][i];
      for (int j = i; j < 3; ++j) a[k][j] -= free[j] ? f * a[i][j] : 0;
      right[k] -= f * right[i];
    }
  }
  for (int i = 2; i >= 0; --i) {
    if (!free[i]) continue;
    double sum = right[i];
    for (int j = i + 1; j < 3; ++j) sum -= free[j] ? a[i][j] * x[j] : 0;
    x[i] = sum / a[i][i];
  }
}

// The step to the least error in the cube; `c` is the mass point. The error is strictly convex, and
// its least point lies inside exactly one of the cube, its 6 faces, 12 edges and 8 corners, where
// it is stationary. So the best of these 27 stationary points that lie in the cube is the solution;
// corners always do. Clamping the unbounded solution would leave the planes. Cost: 27 small
// eliminations, for the few vertices whose solution leaves the cube.
Vector boundedStep(const Qef& qef, const Vector& residual, const Vector& c, float halfSize) {
  Matrix3 m = matrixOf(qef);
  for (int i = 0; i < 3; ++i) m[i][i] += kPull * static_cast<double>(qef.count);
  const Vector3 r = {residual[0], residual[1], residual[2]};
  Vector best{};
  double bestError = std::numeric_limits<double>::infinity();
  for (int places = 0; places < 27; ++places) {
    const std::array<int, 3> place = {places / 9, places / 3 % 3, places % 3};
    std::array<bool, 3> free{};
    Vector3 x{};
    for (int i = 0; i < 3; ++i) {
      free[i] = place[i] == 2;
      x[i] = (place[i] == 0 ? -halfSize : halfSize) - static_cast<double>(c[i]);
    }
    solveFree(m, r, free, x);
    bool feasible = true;
    for (int i = 0; i < 3; ++i) {
      feasible &= !free[i] || std::abs(x[i] + static_cast<double>(c[i])) <= halfSize;
    }
    if (!feasible) continue;
    double error = 0;
    for (int i = 0; i < 3; ++i) {
      error -= 2 * r[i] * x[i];
      for (int j = 0; j < 3; ++j) error += x[i] * m[i][j] * x[j];
    }
    if (error >= bestError) continue;
    bestError = error;
    for (int i = 0; i < 3; ++i) best[i] = static_cast<float>(x[i]);
  }
  return best;
}

// The result of the closed form.
struct Solution {
  float x, y, z;
  int oneDirection;  // the planes have one normal direction: the point is their solution
  int inside;        // it lies in the cube
};

// The closed form for one normal direction, as most cells have. With normals that differ by angles
// of order e, their sum n is along the first eigenvector up to order e^2, its Rayleigh quotient n A
// n / n n is the first eigenvalue up to order e^4, and the rest of the trace bounds the other two
// eigenvalues: if it is under kFreeShare, truncatedStep() would drop both. Without branches, so
// that the compiler can work on several problems at a time.
inline Solution solveOneDirection(const Qef& qef, float halfSize) {
  const Vector c = qef.massPoint();
  const Vector residual = residualAt(qef, c);
  const Vector& n = qef.normals;
  const auto& a = qef.a;
  const Vector an = {a[0] * n[0] + a[1] * n[1] + a[2] * n[2],
                     a[1] * n[0] + a[3] * n[1] + a[4] * n[2],
                     a[2] * n[0] + a[4] * n[1] + a[5] * n[2]};
  const float squared = dot(n, n), first = dot(n, an), trace = a[0] + a[3] + a[5];
  const float along = dot(n, residual) / first;
  const Vector x = {c[0] + n[0] * along, c[1] + n[1] * along, c[2] + n[2] * along};
  const int oneDirection = (squared > 0.25F * qef.count * qef.count) &
                           (trace * squared < (1 + static_cast<float>(kFreeShare)) * first);
  const int insideX = std::abs(x[0]) <= halfSize;
  const int insideY = std::abs(x[1]) <= halfSize;
  const int insideZ = std::abs(x[2]) <= halfSize;
  return {x[0], x[1], x[2], oneDirection, insideX & insideY & insideZ};
}

// Several problems, one array for each number.
struct Lanes {
  static constexpr std::size_t kCount = 8;
  std::array<std::array<float, kCount>, 6> a;
  std::array<std::array<float, kCount>, 3> b, points, normals, origins;
  std::array<float, kCount> count;

  void load(std::size_t lane, const Qef& qef, const Vector& origin) {
    for (int i = 0; i < 6; ++i) a[i][lane] = qef.a[i];
    for (int i = 0; i < 3; ++i) {
      b[i][lane] = qef.b[i];
      points[i][lane] = qef.points[i];
      normals[i][lane] = qef.normals[i];
      origins[i][lane] = origin[i];
    }
    count[lane] = qef.count;
  }
  [[nodiscard]] Qef seenFromOrigin(std::size_t lane) const {
    Qef qef;
    qef.a = {a[0][lane], a[1][lane], a[2][lane], a[3][lane], a[4][lane], a[5][lane]};
    qef.b = {b[0][lane], b[1][lane], b[2][lane]};
    qef.points = {points[0][lane], points[1][lane], points[2][lane]};
    qef.normals = {normals[0][lane], normals[1][lane], normals[2][lane]};
    qef.count = count[lane];
    return qef.seenFrom({origins[0][lane], origins[1][lane], origins[2][lane]});
  }
};

}  // namespace

std::optional<Vector> solveInside(const Qef& qef, float halfSize) {
  const Solution quick = solveOneDirection(qef, halfSize);
  if ((quick.oneDirection & quick.inside) != 0) return Vector{quick.x, quick.y, quick.z};
  if (quick.oneDirection != 0) return std::nullopt;
  const Vector c = qef.massPoint();
  const Vector step = truncatedStep(qef, residualAt(qef, c));
  const Vector x = {c[0] + step[0], c[1] + step[1], c[2] + step[2]};
  if (std::abs(x[0]) <= halfSize && std::abs(x[1]) <= halfSize && std::abs(x[2]) <= halfSize) {
    return x;
  }
  return std::nullopt;
}

Vector solve(const Qef& qef, float halfSize) {
  if (const auto inside = solveInside(qef, halfSize)) return *inside;
  const Vector c = qef.massPoint();
  const Vector step = boundedStep(qef, residualAt(qef, c), c, halfSize);
  Vector x{};
  for (int i = 0; i < 3; ++i) x[i] = std::clamp(c[i] + step[i], -halfSize, halfSize);
  return x;
}

void solveAll(const Qef* qefs, const Vector* origins, std::size_t count, float halfSize,
              Vector* solutions) {
  for (std::size_t first = 0; first < count; first += Lanes::kCount) {
    Lanes lanes;
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      // The last problem also fills the unused lanes.
      const std::size_t i = std::min(first + lane, count - 1);
      lanes.load(lane, qefs[i], origins[i]);
    }
    std::array<std::array<float, Lanes::kCount>, 3> points;
    std::array<int, Lanes::kCount> found;
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      const Solution solution = solveOneDirection(lanes.seenFromOrigin(lane), halfSize);
      points[0][lane] = solution.x;
      points[1][lane] = solution.y;
      points[2][lane] = solution.z;
      found[lane] = solution.oneDirection & solution.inside;
    }
    for (std::size_t lane = 0; lane < std::min(Lanes::kCount, count - first); ++lane) {
      solutions[first + lane] = found[lane] != 0
                                    ? Vector{points[0][lane], points[1][lane], points[2][lane]}
                                    : solve(lanes.seenFromOrigin(lane), halfSize);
    }
  }
}

}  // namespace tufa::uniform
