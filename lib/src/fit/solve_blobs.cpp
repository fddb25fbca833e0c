// The only file that includes Eigen and Ceres, which take seconds.
#include "fit/solve_blobs.h"

#include <ceres/tiny_solver.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tufa::fit {
namespace {

constexpr int kPerBlob = 5;

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

// Blobs from parameters, and how each of a blob's five numbers changes with its parameter.
struct Bounded {
  UnitBlob blob;
  double slopes[kPerBlob];

  explicit Bounded(const double* u) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      blob.centre[axis] = kCentres.at(u[axis]);
      slopes[axis] = kCentres.slopeAt(blob.centre[axis]);
    }
    const double logarithm = kRadii.at(u[3]);
    blob.radius = std::exp(logarithm);
    slopes[3] = kRadii.slopeAt(logarithm);
    blob.weight = kWeights.at(u[4]);
    slopes[4] = kWeights.slopeAt(blob.weight);
  }
  static void parametersOf(const UnitBlob& blob, double* u) {
    for (std::size_t axis = 0; axis < 3; ++axis) u[axis] = kCentres.parameterAt(blob.centre[axis]);
    u[3] = kRadii.parameterAt(std::log(blob.radius));
    u[4] = kWeights.parameterAt(blob.weight);
  }
};

// The square roots of the energy's parts near some blobs, as the solver wants them: of each sample
// the value and the three components of the normal, and one for the volumes.
template <int Blobs>
class NearEnergy {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kPerBlob * Blobs };

  NearEnergy(const BlobField& field, std::size_t index, std::span<const UnitBlob> start,
             base::Job& job)
      : job_(job) {
    // The blobs may go and grow about so far while they are optimized.
    constexpr double kRoom = 1.3;
    const UnitBlob& own = field.blobs()[index];
    const double count = static_cast<double>(field.samples().size());
    value_ = std::sqrt(field.weights().value / count);
    normal_ = std::sqrt(field.weights().normal / count);
    shrink_ = std::sqrt(field.weights().shrink);
    volume_ = field.volume() - volumeOf(own);
    for (std::size_t i = 0; i < field.samples().size(); ++i) {
      const Sample& sample = field.samples()[i];
      const auto reaches = [&](const UnitBlob& blob) {
        return (sample.point - blob.centre).length() < kRoom * kReach * blob.radius;
      };
      if (!reaches(own) && std::none_of(start.begin(), start.end(), reaches)) continue;
      Sum rest = field.sums()[i];
      rest -= densityOf(own, sample.point);
      near_.push_back({sample, rest});
    }
  }

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(4 * near_.size()) + 1; }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    job_.checkCancelled(0, 1);
    Eigen::Map<Eigen::VectorXd> r(residuals, NumResiduals());
    Eigen::Map<Eigen::MatrixXd> j(jacobian, jacobian != nullptr ? NumResiduals() : 0,
                                  NUM_PARAMETERS);
    std::vector<Bounded> blobs;
    for (int b = 0; b < Blobs; ++b) blobs.emplace_back(parameters + kPerBlob * b);
    for (std::size_t i = 0; i < near_.size(); ++i) {
      const int row = static_cast<int>(4 * i);
      const Sample& sample = near_[i].sample;
      Sum sum = near_[i].rest;
      for (const Bounded& b : blobs) sum += densityOf(b.blob, sample.point);
      const double length = sum.gradient.length();
      const Vec3 unit = length > 0 ? sum.gradient / length : Vec3(0.0);
      r[row] = value_ * (sum.value - kThreshold);
      for (int axis = 0; axis < 3; ++axis) {
        r[row + 1 + axis] = normal_ * (sample.normal[axis] + unit[axis]);
      }
      if (jacobian == nullptr) continue;
      for (int b = 0; b < Blobs; ++b) {
        fillRow(blobs[b], sample.point, unit, length, j.block(row, kPerBlob * b, 4, kPerBlob));
      }
    }
    const int last = NumResiduals() - 1;
    r[last] = volume_;
    for (const Bounded& b : blobs) r[last] += volumeOf(b.blob);
    r[last] *= shrink_;
    if (jacobian == nullptr) return true;
    for (int b = 0; b < Blobs; ++b) {
      const UnitBlob& blob = blobs[b].blob;
      const double cube = blob.radius * blob.radius * blob.radius;
      j.block(last, kPerBlob * b, 1, kPerBlob) << 0, 0, 0,
          shrink_ * 3 * volumeOf(blob) * blobs[b].slopes[3],
          shrink_ * (blob.weight < 0 ? -cube : cube) * blobs[b].slopes[4];
    }
    return true;
  }

 private:
  struct Near {
    Sample sample;
    Sum rest;  ///< of the blobs that stay
  };

  // By one blob's parameters: of the value, and of the unit gradient at a sample.
  template <class Block>
  void fillRow(const Bounded& bounded, const Vec3& point, const Vec3& unit, double length,
               Block&& block) const {
    block.setZero();
    const UnitBlob& blob = bounded.blob;
    const Vec3 offset = point - blob.centre;
    const double squared = blob.radius * blob.radius;
    const double q = offset.squaredLength() / squared;
    if (!(q < kReach * kReach)) return;
    const double shape = std::exp(-kBlobbiness * q), density = blob.weight * shape;
    const double k = 2 * kBlobbiness / squared;
    // Of the gradient, -k density offset, by each parameter.
    Vec3 gradients[kPerBlob];
    double values[kPerBlob];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      values[axis] = k * density * offset[axis];
      gradients[axis] = offset * (-k * values[axis]);
      gradients[axis][axis] += k * density;
    }
    values[3] = 2 * kBlobbiness * q * density;
    gradients[3] = offset * (k * density * (2 - 2 * kBlobbiness * q));
    values[4] = shape;
    gradients[4] = offset * (-k * shape);
    for (int p = 0; p < kPerBlob; ++p) {
      const double slope = bounded.slopes[p];
      block(0, p) = value_ * values[p] * slope;
      if (!(length > 0)) continue;
      const Vec3 turn = (gradients[p] - unit * unit.dot(gradients[p])) / length;
      for (int axis = 0; axis < 3; ++axis) block(1 + axis, p) = normal_ * turn[axis] * slope;
    }
  }

  base::Job& job_;
  double value_, normal_, shrink_, volume_;
  std::vector<Near> near_;
};

template <int Blobs>
std::array<UnitBlob, Blobs> solve(const BlobField& field, std::size_t index,
                                  const std::array<UnitBlob, Blobs>& start, int iterations,
                                  base::Job& job) {
  using Energy = NearEnergy<Blobs>;
  const Energy energy(field, index, start, job);
  typename ceres::TinySolver<Energy>::Parameters u;
  for (int b = 0; b < Blobs; ++b) Bounded::parametersOf(start[b], u.data() + kPerBlob * b);
  ceres::TinySolver<Energy> solver;
  solver.options.max_num_iterations = iterations;
  solver.options.function_tolerance = 1e-6;
  solver.Solve(energy, &u);
  std::array<UnitBlob, Blobs> blobs;
  for (int b = 0; b < Blobs; ++b) blobs[b] = Bounded(u.data() + kPerBlob * b).blob;
  return blobs;
}

}  // namespace

UnitBlob solveBlob(const BlobField& field, std::size_t index, int iterations, base::Job& job) {
  return solve<1>(field, index, {field.blobs()[index]}, iterations, job)[0];
}

std::array<UnitBlob, 2> solveBlobs(const BlobField& field, std::size_t index,
                                   const std::array<UnitBlob, 2>& start, int iterations,
                                   base::Job& job) {
  return solve<2>(field, index, start, iterations, job);
}

}  // namespace tufa::fit
