#include "uniform/qef.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tufa::uniform {
namespace {

// Eigenvalues below this share of the largest belong to directions that the planes leave free:
// noise in normals a few degrees apart would move the point far along them.
constexpr float kFreeShare = 0.01F;
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

// N symmetric matrices, and the rotations that have made them more diagonal: one array of lanes for
// each number. All lanes take the same steps, so that the compiler can work on several at a time,
// and a lane's result does not depend on the others.
template <std::size_t N>
struct Diagonalization {
  using Lane = std::array<float, N>;
  std::array<Lane, 3> diagonal;
  std::array<Lane, 3> beside;  // the entry in the other two rows
  std::array<std::array<Lane, 3>, 3> vectors;
  Lane isActive;  // 1 until the lane is diagonal to single precision, then 0

  explicit Diagonalization(const std::array<Lane, 6>& a)
      : diagonal{a[0], a[3], a[5]}, beside{a[4], a[2], a[1]}, vectors{} {
    for (std::size_t i = 0; i < 3; ++i) vectors[i][i].fill(1);
  }

  // Cyclic Jacobi sweeps, which converge quadratically: a few do.
  void run() {
    for (int sweep = 0; sweep < 8 && findActive(); ++sweep) {
      rotate(0, 1, 2);
      rotate(0, 2, 1);
      rotate(1, 2, 0);
    }
  }

 private:
  bool findActive() {
    constexpr float kDiagonal = 1e-7F;
    float any = 0;
    for (std::size_t k = 0; k < N; ++k) {
      const float off = std::abs(beside[0][k]) + std::abs(beside[1][k]) + std::abs(beside[2][k]);
      isActive[k] = off > kDiagonal * (diagonal[0][k] + diagonal[1][k] + diagonal[2][k]) ? 1 : 0;
      any += isActive[k];
    }
    return any > 0;
  }

  // In the plane of rows p and q; r is the third one. Zeroes the entry of p and q.
  void rotate(std::size_t p, std::size_t q, std::size_t r) {
    Lane cosine, sine;
    for (std::size_t k = 0; k < N; ++k) {
      const float entry = beside[r][k], apart = diagonal[q][k] - diagonal[p][k];
      const float hypotenuse = std::sqrt(apart * apart + 4 * entry * entry);
      const float twice = std::copysign(2.0F, apart) * entry;
      const float tangent =
          isActive[k] * twice / (std::abs(apart) + hypotenuse + std::numeric_limits<float>::min());
      cosine[k] = 1 / std::sqrt(tangent * tangent + 1);
      sine[k] = tangent * cosine[k];
      diagonal[p][k] -= tangent * entry;
      diagonal[q][k] += tangent * entry;
      beside[r][k] = (1 - isActive[k]) * entry;
    }
    turn(beside[q], beside[p], cosine, sine);
    for (auto& row : vectors) turn(row[p], row[q], cosine, sine);
  }
  static void turn(Lane& x, Lane& y, const Lane& cosine, const Lane& sine) {
    for (std::size_t k = 0; k < N; ++k) {
      const float was = x[k];
      x[k] = cosine[k] * was - sine[k] * y[k];
      y[k] = sine[k] * was + cosine[k] * y[k];
    }
  }
};

// The least-squares steps from the mass points by the pseudo-inverse without the free directions,
// as Ju et al. 2002 truncate theirs.
template <std::size_t N>
std::array<std::array<float, N>, 3> truncatedSteps(
    const std::array<std::array<float, N>, 6>& a,
    const std::array<std::array<float, N>, 3>& residual) {
  Diagonalization<N> m(a);
  m.run();
  std::array<std::array<float, N>, 3> step{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < N; ++k) {
      const float largest =
          std::max(std::max(m.diagonal[0][k], m.diagonal[1][k]), m.diagonal[2][k]);
      const float along = m.vectors[0][i][k] * residual[0][k] +
                          m.vectors[1][i][k] * residual[1][k] + m.vectors[2][i][k] * residual[2][k];
      const float own = m.diagonal[i][k];
      const float isBound = own > kFreeShare * largest ? 1 : 0;  // no branch around a division
      const float share = isBound * along / (isBound * own + (1 - isBound));
      for (std::size_t j = 0; j < 3; ++j) step[j][k] += m.vectors[j][i][k] * share;
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
  const int oneDirection =
      (squared > 0.25F * qef.count * qef.count) & (trace * squared < (1 + kFreeShare) * first);
  const int insideX = std::abs(x[0]) <= halfSize;
  const int insideY = std::abs(x[1]) <= halfSize;
  const int insideZ = std::abs(x[2]) <= halfSize;
  return {x[0], x[1], x[2], oneDirection, insideX & insideY & insideZ};
}

// The solutions of N problems without bounds, where they lie in the cube.
template <std::size_t N>
std::array<std::optional<Vector>, N> solveTruncated(const Qef* qefs, float halfSize) {
  std::array<std::array<float, N>, 6> a;
  std::array<std::array<float, N>, 3> residual;
  for (std::size_t k = 0; k < N; ++k) {
    const Vector r = residualAt(qefs[k], qefs[k].massPoint());
    for (std::size_t i = 0; i < 6; ++i) a[i][k] = qefs[k].a[i];
    for (std::size_t i = 0; i < 3; ++i) residual[i][k] = r[i];
  }
  const auto step = truncatedSteps<N>(a, residual);
  std::array<std::optional<Vector>, N> solutions;
  for (std::size_t k = 0; k < N; ++k) {
    Vector x = qefs[k].massPoint();
    bool isInside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] += step[i][k];
      isInside &= std::abs(x[i]) <= halfSize;
    }
    if (isInside) solutions[k] = x;
  }
  return solutions;
}

Vector solveBounded(const Qef& qef, float halfSize) {
  const Vector c = qef.massPoint();
  const Vector step = boundedStep(qef, residualAt(qef, c), c, halfSize);
  Vector x{};
  for (int i = 0; i < 3; ++i) x[i] = std::clamp(c[i] + step[i], -halfSize, halfSize);
  return x;
}

constexpr std::size_t kLanes = 8;

// Several problems, one array for each number.
struct Lanes {
  std::array<std::array<float, kLanes>, 6> a;
  std::array<std::array<float, kLanes>, 3> b, points, normals, origins;
  std::array<float, kLanes> count;

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
  return solveTruncated<1>(&qef, halfSize)[0];
}

Vector solve(const Qef& qef, float halfSize) {
  const auto inside = solveInside(qef, halfSize);
  return inside ? *inside : solveBounded(qef, halfSize);
}

void solveAll(const Qef* qefs, const Vector* origins, std::size_t count, float halfSize,
              Vector* solutions) {
  // Those that have several normal directions, to be solved together.
  std::array<Qef, kLanes> open;
  std::array<std::size_t, kLanes> places{};
  std::size_t opened = 0;
  const auto solveOpen = [&] {
    for (std::size_t k = opened; k < kLanes; ++k) open[k] = open[0];
    const auto inside = solveTruncated<kLanes>(open.data(), halfSize);
    for (std::size_t k = 0; k < opened; ++k) {
      solutions[places[k]] = inside[k] ? *inside[k] : solveBounded(open[k], halfSize);
    }
    opened = 0;
  };
  for (std::size_t first = 0; first < count; first += kLanes) {
    Lanes lanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      // The last problem also fills the unused lanes.
      const std::size_t i = std::min(first + lane, count - 1);
      lanes.load(lane, qefs[i], origins[i]);
    }
    std::array<std::array<float, kLanes>, 3> points;
    std::array<int, kLanes> oneDirection, inside;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Solution solution = solveOneDirection(lanes.seenFromOrigin(lane), halfSize);
      points[0][lane] = solution.x;
      points[1][lane] = solution.y;
      points[2][lane] = solution.z;
      oneDirection[lane] = solution.oneDirection;
      inside[lane] = solution.inside;
    }
    for (std::size_t lane = 0; lane < std::min(kLanes, count - first); ++lane) {
      if (oneDirection[lane] == 0) {
        open[opened] = lanes.seenFromOrigin(lane);
        places[opened++] = first + lane;
        if (opened == kLanes) solveOpen();
      } else if (inside[lane] != 0) {
        solutions[first + lane] = {points[0][lane], points[1][lane], points[2][lane]};
      } else {
        solutions[first + lane] = solveBounded(lanes.seenFromOrigin(lane), halfSize);
      }
    }
  }
  if (opened > 0) solveOpen();
}

}  // namespace tufa::uniform
