// The only file that includes Eigen and Ceres, which take seconds.
#include "fit/solve_balls.h"

#include <ceres/tiny_solver.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tufa::fit {
namespace {

constexpr int kPerBall = 5;

// A parameter of the solver is any number; what it stands for stays between two bounds.
struct Range {
  double least, greatest;

  [[nodiscard]] double at(double u) const {
    return least + (greatest - least) / (1 + std::exp(-u));
  }
  [[nodiscard]] double slopeAt(double x) const {
    return (x - least) * (greatest - x) / (greatest - least);
  }
  [[nodiscard]] double parameterAt(double x) const {
    const double share = std::clamp((x - least) / (greatest - least), 1e-6, 1 - 1e-6);
    return std::log(share / (1 - share));
  }
};

// In diagonals of the mesh; the radius by its logarithm.
constexpr Range kCentres{-0.75, 0.75};
const Range kRadii{std::log(0.004), std::log(3.0)};
constexpr Range kWeights{-2, 4};

// Balls from parameters, and how each of a ball's five numbers changes with its parameter.
struct Bounded {
  Ball ball;
  double slopes[kPerBall];

  explicit Bounded(const double* u) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ball.centre[axis] = kCentres.at(u[axis]);
      slopes[axis] = kCentres.slopeAt(ball.centre[axis]);
    }
    const double logarithm = kRadii.at(u[3]);
    ball.radius = std::exp(logarithm);
    slopes[3] = kRadii.slopeAt(logarithm);
    ball.weight = kWeights.at(u[4]);
    slopes[4] = kWeights.slopeAt(ball.weight);
  }
  static void parametersOf(const Ball& ball, double* u) {
    for (std::size_t axis = 0; axis < 3; ++axis) u[axis] = kCentres.parameterAt(ball.centre[axis]);
    u[3] = kRadii.parameterAt(std::log(ball.radius));
    u[4] = kWeights.parameterAt(ball.weight);
  }
};

// The square roots of the energy's parts near some balls, as the solver wants them: of each sample
// the value and the three components of the normal, and one for the volumes.
template <int Balls>
class NearEnergy {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kPerBall * Balls };

  NearEnergy(const BlobField& field, std::size_t index, std::span<const Ball> start) {
    // The balls may go and grow about so far while they are optimized.
    constexpr double kRoom = 1.3;
    const Ball& own = field.balls()[index];
    const double count = static_cast<double>(field.samples().size());
    value_ = std::sqrt(field.weights().value / count);
    normal_ = std::sqrt(field.weights().normal / count);
    shrink_ = std::sqrt(field.weights().shrink);
    volume_ = field.volume() - volumeOf(own);
    for (std::size_t i = 0; i < field.samples().size(); ++i) {
      const Sample& sample = field.samples()[i];
      const auto reaches = [&](const Ball& ball) {
        return (sample.point - ball.centre).length() < kRoom * kReach * ball.radius;
      };
      if (!reaches(own) && std::none_of(start.begin(), start.end(), reaches)) continue;
      Sum rest = field.sums()[i];
      rest -= densityOf(own, sample.point);
      near_.push_back({sample, rest});
    }
  }

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(4 * near_.size()) + 1; }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    Eigen::Map<Eigen::VectorXd> r(residuals, NumResiduals());
    Eigen::Map<Eigen::MatrixXd> j(jacobian, jacobian != nullptr ? NumResiduals() : 0,
                                  NUM_PARAMETERS);
    std::vector<Bounded> balls;
    for (int b = 0; b < Balls; ++b) balls.emplace_back(parameters + kPerBall * b);
    for (std::size_t i = 0; i < near_.size(); ++i) {
      const int row = static_cast<int>(4 * i);
      const Sample& sample = near_[i].sample;
      Sum sum = near_[i].rest;
      for (const Bounded& b : balls) sum += densityOf(b.ball, sample.point);
      const double length = sum.gradient.length();
      const Vec3 unit = length > 0 ? sum.gradient / length : Vec3(0.0);
      r[row] = value_ * (sum.value - kThreshold);
      for (int axis = 0; axis < 3; ++axis) {
        r[row + 1 + axis] = normal_ * (sample.normal[axis] + unit[axis]);
      }
      if (jacobian == nullptr) continue;
      for (int b = 0; b < Balls; ++b) {
        fillRow(balls[b], sample.point, unit, length, j.block(row, kPerBall * b, 4, kPerBall));
      }
    }
    const int last = NumResiduals() - 1;
    r[last] = volume_;
    for (const Bounded& b : balls) r[last] += volumeOf(b.ball);
    r[last] *= shrink_;
    if (jacobian == nullptr) return true;
    for (int b = 0; b < Balls; ++b) {
      const Ball& ball = balls[b].ball;
      const double cube = ball.radius * ball.radius * ball.radius;
      j.block(last, kPerBall * b, 1, kPerBall) << 0, 0, 0,
          shrink_ * 3 * volumeOf(ball) * balls[b].slopes[3],
          shrink_ * (ball.weight < 0 ? -cube : cube) * balls[b].slopes[4];
    }
    return true;
  }

 private:
  struct Near {
    Sample sample;
    Sum rest;  ///< of the balls that stay
  };

  // By one ball's parameters: of the value, and of the unit gradient at a sample.
  template <class Block>
  void fillRow(const Bounded& bounded, const Vec3& point, const Vec3& unit, double length,
               Block&& block) const {
    block.setZero();
    const Ball& ball = bounded.ball;
    const Vec3 offset = point - ball.centre;
    const double squared = ball.radius * ball.radius;
    const double q = offset.squaredLength() / squared;
    if (!(q < kReach * kReach)) return;
    const double shape = std::exp(-kBlobbiness * q), density = ball.weight * shape;
    const double k = 2 * kBlobbiness / squared;
    // Of the gradient, -k density offset, by each parameter.
    Vec3 gradients[kPerBall];
    double values[kPerBall];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      values[axis] = k * density * offset[axis];
      gradients[axis] = offset * (-k * values[axis]);
      gradients[axis][axis] += k * density;
    }
    values[3] = 2 * kBlobbiness * q * density;
    gradients[3] = offset * (k * density * (2 - 2 * kBlobbiness * q));
    values[4] = shape;
    gradients[4] = offset * (-k * shape);
    for (int p = 0; p < kPerBall; ++p) {
      const double slope = bounded.slopes[p];
      block(0, p) = value_ * values[p] * slope;
      if (!(length > 0)) continue;
      const Vec3 turn = (gradients[p] - unit * unit.dot(gradients[p])) / length;
      for (int axis = 0; axis < 3; ++axis) block(1 + axis, p) = normal_ * turn[axis] * slope;
    }
  }

  double value_, normal_, shrink_, volume_;
  std::vector<Near> near_;
};

template <int Balls>
std::array<Ball, Balls> solve(const BlobField& field, std::size_t index,
                              const std::array<Ball, Balls>& start, int iterations) {
  using Energy = NearEnergy<Balls>;
  const Energy energy(field, index, start);
  typename ceres::TinySolver<Energy>::Parameters u;
  for (int b = 0; b < Balls; ++b) Bounded::parametersOf(start[b], u.data() + kPerBall * b);
  ceres::TinySolver<Energy> solver;
  solver.options.max_num_iterations = iterations;
  solver.options.function_tolerance = 1e-6;
  solver.Solve(energy, &u);
  std::array<Ball, Balls> balls;
  for (int b = 0; b < Balls; ++b) balls[b] = Bounded(u.data() + kPerBall * b).ball;
  return balls;
}

}  // namespace

Ball solveBall(const BlobField& field, std::size_t index, int iterations) {
  return solve<1>(field, index, {field.balls()[index]}, iterations)[0];
}

std::array<Ball, 2> solveBalls(const BlobField& field, std::size_t index,
                               const std::array<Ball, 2>& start, int iterations) {
  return solve<2>(field, index, start, iterations);
}

}  // namespace tufa::fit
