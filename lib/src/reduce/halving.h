#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "reduce/corners.h"
#include "reduce/triangles.h"

namespace tufa::reduce {

struct Sphere {
  Vec3f middle;
  float radius;
};

/// A radius whose square is finite.
inline constexpr float kEverywhere = 1e15f;
/// Voxels: pieces so far outside a sphere count as in it.
inline constexpr float kBeyond = 0.5f;

using Corners = std::array<Vec3f, 3>;

/// A bound of the distance from the part of a triangle inside a sphere to the nearest of some
/// triangles, by halving: no point of a piece is farther from one of them than the farthest of the
/// piece's corners. Pieces no farther than what is expected, or than a point seen before, are done.
/// Distance: d(point, candidate).
template <class Distance>
class Halving {
 public:
  Halving(Distance distance, const Sphere& about, float expected)
      : distance_(std::move(distance)), about_(about), enough_(expected) {}

  float bound(const Corners& p, const std::vector<Index>& candidates) {
    stack_.clear();
    for (const Index candidate : candidates) stack_.push_back({candidate, 0});
    return bound(p, 0, 0);
  }

 private:
  struct Candidate {
    Index index;
    float away;  // from the middle of the piece
  };
  static constexpr float kFar = 1e30f;
  static constexpr int kDepth = 12;
  // Bounds are tight within this factor and distance.
  static constexpr float kTight = 1.002f;
  static constexpr float kTightVoxels = 1e-4f;

  // With the candidates on the stack from `first` on.
  float bound(const Corners& p, std::size_t first, int depth) {
    const Vec3f m = (p[0] + p[1] + p[2]) * (1.0f / 3);
    const float size = std::sqrt(
        std::max({squaredLength(p[0] - m), squaredLength(p[1] - m), squaredLength(p[2] - m)}));
    if (length(m - about_.middle) > size + about_.radius) return 0;
    const std::size_t end = stack_.size();
    std::size_t nearest = first;
    for (std::size_t k = first; k < end; ++k) {
      stack_[k].away = distance_(m, stack_[k].index);
      if (stack_[k].away < stack_[nearest].away) nearest = k;
    }
    const float least = stack_[nearest].away;
    if (least + size <= enough_) return least + size;  // no distance grows faster
    stack_.push_back(stack_[nearest]);
    for (std::size_t k = first; k < end; ++k) {  // others are nowhere the nearest
      if (k != nearest && stack_[k].away <= least + 2 * size) stack_.push_back(stack_[k]);
    }
    const float found = boundByClose(p, end, depth);
    stack_.resize(end);
    return found;
  }

  float boundByClose(const Corners& p, std::size_t first, int depth) {
    float best = kFar, low[3] = {kFar, kFar, kFar};
    for (std::size_t k = first; k < stack_.size(); ++k) {
      float most = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const float at = distance_(p[i], stack_[k].index);
        most = std::max(most, at);
        low[i] = std::min(low[i], at);
      }
      best = std::min(best, most);
      if (best <= enough_) return best;
    }
    if (depth >= kDepth) return best;
    const float lowest = std::max({low[0], low[1], low[2]});
    const bool isInside = std::all_of(p.begin(), p.end(), [&](Vec3f q) {
      return length(q - about_.middle) <= about_.radius + kBeyond;
    });
    if (isInside) enough_ = std::max(enough_, lowest);
    if (isInside && best <= kTight * lowest + kTightVoxels) return best;
    return std::min(best, worstOfQuarters(p, first, depth + 1));
  }

  float worstOfQuarters(const Corners& p, std::size_t first, int depth) {
    const Vec3f a = (p[0] + p[1]) * 0.5f, b = (p[1] + p[2]) * 0.5f, c = (p[2] + p[0]) * 0.5f;
    const Corners quarters[4] = {{p[0], a, c}, {a, p[1], b}, {c, b, p[2]}, {a, b, c}};
    float worst = 0;
    for (const Corners& q : quarters) worst = std::max(worst, bound(q, first, depth));
    return worst;
  }

  Distance distance_;
  Sphere about_;
  float enough_;
  std::vector<Candidate> stack_;
};

}  // namespace tufa::reduce
