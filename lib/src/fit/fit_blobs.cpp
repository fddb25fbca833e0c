#include <tufa/error.h>
#include <tufa/fit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/job.h"
#include "base/require_mesh.h"
#include "fit/blob_field.h"
#include "fit/sample_mesh.h"
#include "fit/solve_blobs.h"

namespace tufa {
namespace {

using fit::BlobField;
using fit::Frame;
using fit::Sample;
using fit::Sum;
using fit::UnitBlob;

// Steps of the solver: for a split that is tried, for one that is made, for a blob in its turn.
constexpr int kTrialSteps = 25, kSplitSteps = 50, kTurnSteps = 10;
// Blobs whose centres are nearer than this share of their radii's sum matter to each other.
constexpr double kTouching = 0.9;
// All blobs get their turn whenever there are so many times as many as the last time.
constexpr double kSweepGrowth = 1.5;
// A step that gains less is none.
constexpr double kLeastGain = 1e-9;

void requireOptions(const FitOptions& options) {
  const auto refuse = [](const std::string& what, const std::string& range) {
    throw Error(ErrorCode::InvalidArgument, what + " must be " + range);
  };
  if (options.blobs < 1 || options.blobs > 10000) {
    refuse("the number of blobs, " + std::to_string(options.blobs) + ",", "1 to 10000");
  }
  if (!(options.error >= 0 && options.error <= 1)) {
    refuse("the error to stop at, a share of the mesh's diagonal,", "0 to 1");
  }
  constexpr int kMostSamples = 10'000'000;
  if (options.samples < 0 || options.samples > kMostSamples) {
    refuse("the number of samples, " + std::to_string(options.samples) + ",", "0 to 10000000");
  }
  constexpr double kMostWeight = 1e6;
  const auto isWeight = [&](double weight) { return weight >= 0 && weight <= kMostWeight; };
  if (!isWeight(options.valueWeight) || !(options.valueWeight > 0)) {
    refuse("the weight of values", "above 0 and at most 1000000");
  }
  if (!isWeight(options.normalWeight) || !isWeight(options.shrinkWeight)) {
    refuse("the weights of normals and of volumes", "0 to 1000000");
  }
}

class Fitter {
 public:
  /// `volume`: of the mesh, in cubes of the diagonal.
  Fitter(std::vector<Sample> samples, double volume, const FitOptions& options, base::Job& job)
      : field_(std::move(samples), {options.valueWeight, options.normalWeight,
                                    options.shrinkWeight / (volume * volume)}),
        options_(options),
        job_(job) {}

  /// `diagonal`: of the mesh, world units. The blobs stay in diagonals.
  void run(double diagonal, std::vector<FitStep>& steps) {
    field_.replace(0, std::array{firstBlob()});
    trials_.resize(1);
    sweep();
    double swept = 1;
    steps.push_back(stepNow(diagonal));
    const auto most = static_cast<std::size_t>(options_.blobs);
    while (field_.blobs().size() < most && steps.back().rmsDistance > options_.error * diagonal) {
      job_.checkCancelled(field_.blobs().size(), most);
      if (!splitBest() && !splitAhead(most)) break;
      if (static_cast<double>(field_.blobs().size()) >= kSweepGrowth * swept) {
        sweep();
        swept = static_cast<double>(field_.blobs().size());
      }
      steps.push_back(stepNow(diagonal));
    }
    sweep();
    steps.back() = stepNow(diagonal);
  }

  [[nodiscard]] const std::vector<UnitBlob>& blobs() const { return field_.blobs(); }

  /// The distance of a sample from the surface along the gradient: three of Newton's steps.
  [[nodiscard]] double distance(const Sample& sample) const {
    constexpr int kSteps = 3;
    Vec3 p = sample.point;
    for (int i = 0; i < kSteps; ++i) {
      Sum sum;
      for (const UnitBlob& blob : field_.blobs()) sum += fit::densityOf(blob, p);
      const double slope2 = sum.gradient.squaredLength();
      if (!(slope2 > 0)) return 1;
      Vec3 step = sum.gradient * ((fit::kThreshold - sum.value) / slope2);
      if (step.length() > kMostStep) step *= kMostStep / step.length();
      p += step;
    }
    return (p - sample.point).length();
  }
  [[nodiscard]] const std::vector<Sample>& samples() const { return field_.samples(); }

 private:
  static constexpr double kMostStep = 0.1;

  /// What splitting a blob would give.
  struct Trial {
    std::array<UnitBlob, 2> parts;
    double energy = std::numeric_limits<double>::infinity();
    bool isFresh = false;
  };

  // About the samples' centre, its surface at their distance from there.
  [[nodiscard]] UnitBlob firstBlob() const {
    Vec3 centre(0.0);
    const double count = static_cast<double>(field_.samples().size());
    for (const Sample& sample : field_.samples()) centre += sample.point / count;
    double squared = 0;
    for (const Sample& sample : field_.samples()) {
      squared += (sample.point - centre).squaredLength() / count;
    }
    const double radius = std::sqrt(squared * fit::kBlobbiness / -std::log(fit::kThreshold));
    return {centre, std::max(radius, 0.01), 1};
  }

  // Two half as strong, a little apart along the longest axis of the samples near the blob.
  [[nodiscard]] std::array<UnitBlob, 2> halvesOf(std::size_t index) const {
    constexpr double kApart = 0.2, kSmaller = 0.85, kWeaker = 0.62;
    const UnitBlob& blob = field_.blobs()[index];
    Vec3 axis(1, 0.7, 0.4);
    for (int round = 0; round < 8; ++round) {  // power iteration
      Vec3 next(0.0);
      for (std::size_t i = 0; i < field_.samples().size(); ++i) {
        const Sample& sample = field_.samples()[i];
        const Vec3 offset = sample.point - blob.centre;
        const double near =
            std::exp(-fit::kBlobbiness * offset.squaredLength() / (blob.radius * blob.radius));
        next += offset * (near * offset.dot(axis));
      }
      if (next.normalize(0)) axis = next;
    }
    const Vec3 apart = axis.unitOrX() * (kApart * blob.radius);
    const UnitBlob half{blob.centre, kSmaller * blob.radius, kWeaker * blob.weight};
    std::array<UnitBlob, 2> halves{half, half};
    halves[0].centre += apart;
    halves[1].centre -= apart;
    return halves;
  }

  void refreshTrials() {
    std::vector<std::size_t> stale;
    for (std::size_t i = 0; i < trials_.size(); ++i) {
      if (!trials_[i].isFresh) stale.push_back(i);
    }
    job_.forParts(stale.size(), [&](base::Job& part, std::size_t i) {
      Trial& trial = trials_[stale[i]];
      trial.parts = fit::solveBlobs(field_, stale[i], halvesOf(stale[i]), kTrialSteps, part);
      trial.energy = field_.energyWith(stale[i], trial.parts) - field_.energy();
      trial.isFresh = true;
    });
  }

  // Makes the split that lowers the energy most. Whether there is one.
  bool splitBest() {
    const double energy = field_.energy();
    std::size_t index = 0;
    std::array<UnitBlob, 2> parts;
    while (true) {
      refreshTrials();
      const auto best =
          std::min_element(trials_.begin(), trials_.end(),
                           [](const Trial& a, const Trial& b) { return a.energy < b.energy; });
      if (!(best->energy < -kLeastGain * energy)) return false;
      index = static_cast<std::size_t>(best - trials_.begin());
      parts = best->parts;
      // Blobs farther off may have changed a little since the trial.
      if (field_.energyWith(index, parts) < energy) break;
      best->isFresh = false;
    }
    split(index, parts);
    return true;
  }

  // Two blobs are no better than one in a ring, but four are. So that symmetric solids do not end
  // there, makes some of the best splits whatever they cost. Whether the energy is lower then; if
  // not, all is as it was.
  bool splitAhead(std::size_t most) {
    constexpr std::size_t kAhead = 8;
    const double energy = field_.energy();
    const BlobField fieldBefore = field_;
    const std::vector<Trial> trialsBefore = trials_;
    const std::size_t last = std::min(most, trials_.size() + kAhead);
    while (trials_.size() < last) {
      refreshTrials();
      const auto best =
          std::min_element(trials_.begin(), trials_.end(),
                           [](const Trial& a, const Trial& b) { return a.energy < b.energy; });
      split(static_cast<std::size_t>(best - trials_.begin()), best->parts);
      sweep();
      if (field_.energy() < energy * (1 - kLeastGain)) return true;
    }
    field_ = fieldBefore;
    trials_ = trialsBefore;
    return false;
  }

  // Puts the parts in the place of a blob, and fits them and those around.
  void split(std::size_t index, std::array<UnitBlob, 2> parts) {
    const std::array<UnitBlob, 2> better = fit::solveBlobs(field_, index, parts, kSplitSteps, job_);
    if (field_.energyWith(index, better) < field_.energyWith(index, parts)) parts = better;
    field_.replace(index, parts);
    trials_.emplace_back();
    markAround(index);
    markAround(trials_.size() - 1);
    // Those around in turn.
    std::vector<std::size_t> around;
    for (std::size_t i = 0; i < trials_.size(); ++i) {
      if (!trials_[i].isFresh) around.push_back(i);
    }
    for (const std::size_t i : around) optimize(i);
  }

  // Trials of the blobs around one that has changed tell nothing any more.
  void markAround(std::size_t index) {
    const UnitBlob& blob = field_.blobs()[index];
    for (std::size_t i = 0; i < trials_.size(); ++i) {
      const UnitBlob& other = field_.blobs()[i];
      if ((other.centre - blob.centre).length() < kTouching * (other.radius + blob.radius)) {
        trials_[i].isFresh = false;
      }
    }
    trials_[index].isFresh = false;
  }

  void optimize(std::size_t index) {
    const double energy = field_.energy();
    const std::array<UnitBlob, 1> better{fit::solveBlob(field_, index, kTurnSteps, job_)};
    if (!(field_.energyWith(index, better) < energy * (1 - kLeastGain))) return;
    field_.replace(index, better);
    trials_[index].isFresh = false;
  }

  // Each blob in turn.
  void sweep() {
    field_.sumUp();
    for (std::size_t i = 0; i < field_.blobs().size(); ++i) optimize(i);
    for (Trial& trial : trials_) trial.isFresh = false;
  }

  [[nodiscard]] FitStep stepNow(double diagonal) const {
    double squared = 0;
    for (std::size_t i = 0; i < field_.samples().size(); ++i) {
      const Sum& sum = field_.sums()[i];
      const double slope = sum.gradient.length();
      const double off = std::abs(sum.value - fit::kThreshold);
      const double distance = off < kMostStep * slope ? off / slope : kMostStep;
      squared += distance * distance;
    }
    const double count = static_cast<double>(field_.samples().size());
    return {field_.blobs().size(), field_.energy(), std::sqrt(squared / count) * diagonal};
  }

  BlobField field_;
  const FitOptions& options_;
  base::Job& job_;
  std::vector<Trial> trials_;  ///< for each blob
};

BlobFit fitIn(const Mesh& mesh, const FitOptions& options, base::Job& job) {
  base::requireFaces(mesh);
  const std::vector<Triangle> triangles = triangulate(mesh);
  const Frame frame = fit::frameOf(mesh, triangles);
  const auto count =
      static_cast<std::size_t>(options.samples > 0 ? options.samples : 2000 + 20 * options.blobs);
  BlobFit result;
  result.threshold = fit::kThreshold;
  result.blobbiness = fit::kBlobbiness;
  result.diagonal = frame.diagonal;
  job.beginStage("fit", 0.99);
  Fitter fitter(fit::sampleMesh(mesh, triangles, frame, count),
                fit::volumeOf(mesh, triangles, frame), options, job);
  fitter.run(frame.diagonal, result.steps);
  job.beginStage("distances", 1.0);
  std::vector<double> distances(fitter.samples().size());
  job.forRanges(distances.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) distances[i] = fitter.distance(fitter.samples()[i]);
  });
  double squared = 0;
  for (const double distance : distances) {
    squared += distance * distance;
    result.largestDistance = std::max(result.largestDistance, distance * frame.diagonal);
  }
  result.rmsDistance = std::sqrt(squared / static_cast<double>(distances.size())) * frame.diagonal;
  for (const UnitBlob& blob : fitter.blobs()) {
    result.blobs.push_back(
        {frame.middle + blob.centre * frame.diagonal, blob.radius * frame.diagonal, blob.weight});
  }
  return result;
}

}  // namespace

bool canFitBlobs() { return true; }

BlobFit fitBlobs(const Mesh& mesh, const FitOptions& options) {
  requireOptions(options);
  base::Job job(options.threads, options.progress);
  BlobFit result;
  job.run([&] {
    result = fitIn(mesh, options, job);
    (void)job.finish();
  });
  return result;
}

}  // namespace tufa
