#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "reduce/reduction.h"

// Reduction to a number of triangles.

namespace tufa::reduce {
namespace {

// The least tolerance that reaches the number may be smaller by so much than one at which two
// phases do not. It is found to this factor.
constexpr float kReserve = 1.5f;
constexpr float kFound = 1.03f;
// A mesh above the number by less than one triangle in so many gets more phases: in other parts
// they may find what is missing.
constexpr Index kNearly = 8;
// A certificate up to so many times the tolerance that was found is left at that.
constexpr float kNearTolerance = 1.02f;
// So many halvings without a failure, and the lower bound itself is tried.
constexpr int kHalvings = 2;
// Where tolerances remove nothing so often in turn, the topology is in the way.
constexpr int kMostStuck = 2;

}  // namespace

Reduction::State Reduction::state() const {
  return {surface_, tolerance_, phaseNumber_, isReference_};
}

void Reduction::restore(const State& state) {
  surface_ = state.surface;
  tolerance_ = state.tolerance;
  phaseNumber_ = state.phaseNumber;
  isReference_ = state.isReference;
}

float Reduction::toCount(Index count, float mostTolerance) {
  const float most = mostTolerance * largestScale_ - proxyError();
  return (toCountWithin(count, most) + proxyError()) / largestScale_;
}

// Where the certificate is beyond the tolerance that was found, or the mesh has new folds, it is
// left as it was around there, and the search begins again, as in toTolerance(). Of all meshes one
// of the fewest folds is taken, and of these that of the least error.
float Reduction::toCountWithin(Index count, float mostTolerance) {
  if (triangleCount() <= count) {
    measureWithin(tolerance_);
    return tolerance_;
  }
  const State start = state();
  std::optional<State> best;
  std::size_t leastFolds = 0;
  Certificate certificate;
  for (attempt_ = 0;; ++attempt_) {
    const bool isReached = findCount(count, mostTolerance);
    if (best && !isReached) break;
    measureWithin(tolerance_);
    const std::vector<Index> folds = newFolds();
    if (!best || std::pair(folds.size(), certificate_.largest) <
                     std::pair(leastFolds, certificate.largest)) {
      best = state(), certificate = certificate_, leastFolds = folds.size();
    }
    std::vector<Index> held;
    if (certificate_.mostOver > kNearTolerance) held = certificate_.beyond;
    if (attempt_ < kFoldAttempts) held.insert(held.end(), folds.begin(), folds.end());
    if (!isReached || held.empty() || attempt_ == options_.attempts) break;
    hold(held, tolerance_);
    restore(start);
  }
  restore(*best);
  certificate_ = std::move(certificate);
  reference_.releaseAll();
  return triangleCount() <= count ? tolerance_ : mostTolerance;
}

// Growing tolerances to the first that reaches the count, and between that one and the one before
// by halves, each from the mesh of two tolerances ago: the way that toTolerance() goes, step for
// step. So the error at the count is about that of the tolerance that gives as many triangles,
// but where the count rises with the tolerance. Whether the count is reached.
//
// On the way up each tolerance has few phases. Where counts hardly fall from one to the next, what
// they leave costs many times the tolerance: one that is nearly there gets all phases, and where
// halving does not fail, smaller tolerances are tried too, from the beginning.
bool Reduction::findCount(Index count, float mostTolerance) {
  keepsShape_ = true;
  const auto isReached = [&] { return triangleCount() <= count; };
  const auto isNear = [&] { return triangleCount() <= count + count / kNearly; };
  const auto reduceTo = [&](float tolerance, int phases) {
    trees_.clear(), nextTree_ = 0;
    reduce(tolerance, count, phases);
  };
  const State first = state();
  State start = first, last = first;
  float low = tolerance_, high = kFirstStep;
  while (high <= kRampStep * tolerance_) high *= kStep;
  high = std::min(high, mostTolerance);
  for (int stuck = 0;;) {
    const Index before = triangleCount();
    State next = state();
    reduceTo(high, kRampPhases);
    stuck = triangleCount() == before ? stuck + 1 : 0;
    if (keepsShape_ && high > kStuckTolerance && hasRemovedLittle(before)) {
      keepsShape_ = false, stuck = 0;
    }
    const bool isLast = high >= mostTolerance || (stuck == kMostStuck && high > kStuckTolerance);
    if (isLast) {
      reduceTo(high, kPhases);
    } else if (!isReached() && isNear()) {
      const State ramp = state();
      reduceTo(high, kPhases);
      if (!isReached()) restore(ramp);
    }
    start = std::move(last), last = std::move(next);
    if (isReached()) break;
    if (isLast) return false;
    low = high / kReserve, high = std::min(high * kStep, mostTolerance);
  }
  const float least = high > kFirstStep ? high / (kStep * kReserve) : kLeastTolerance;
  low = std::max({low, start.tolerance, least});
  const float floor = std::max(first.tolerance, kLeastTolerance);
  State best = state();
  bool hasFailed = false;
  for (int tried = 0; hasFailed ? kFound * low < high : floor < high; ++tried) {
    float next = std::sqrt(low * high);
    if (!hasFailed && (tried >= kHalvings || !(kFound * low < high))) {
      if (!(low < high)) low = std::max(low / kStep, floor), start = first;
      next = low;
    }
    restore(start);
    trees_.clear(), nextTree_ = 0;
    descendTo(next, count);
    if (!isReached() && isNear()) reduceTo(next, kPhases);
    if (isReached()) {
      best = state(), high = next;
    } else {
      low = next, hasFailed = true;
    }
  }
  restore(best);
  return true;
}

// The collapses that a phase may still make, shared among parts by their inner vertices.
std::vector<Index> Reduction::quotas(Index count) const {
  std::vector<Index> quota(partition_.size(), kNone);
  if (count == 0) return quota;
  std::vector<double> inner(partition_.size(), 0);
  double all = 0;
  for (Index p = 0; p < quota.size(); ++p) {
    for (const Index v : partition_.vertices(p)) inner[p] += partition_.isInner(v) ? 1 : 0;
    all += inner[p];
  }
  const double allowed = static_cast<double>((triangleCount() - count + 1) / 2);
  double sum = 0;
  for (Index p = 0; p < quota.size(); ++p) {
    const double before = std::floor(sum);
    sum += all > 0 ? allowed * inner[p] / all : 0;
    quota[p] = static_cast<Index>(std::floor(sum + 1e-6) - before);
  }
  return quota;
}

}  // namespace tufa::reduce
