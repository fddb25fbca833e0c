#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>
#include <vector>

#include "reduce/corners.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"

// What the stages of certify() gather.

namespace tufa::reduce {

/// A triangle that the way along an edge of a halved face of the reference passes: what of it lies
/// near that face, none may go to.
struct Gap {
  Index triangle;
  Index face;
};

/// What one range of vertices or faces gives.
struct Measured {
  float largest = 0;
  float mostOver = 1;  ///< the largest distance in what is expected there
  double sum = 0;
  Index worst = kNone;
  std::vector<Index> open;  ///< faces without a way within what is expected
  std::vector<Index> beyond;

  void see(float value, Index face, float limit) {
    if (value > largest) largest = value, worst = face;
    if (value > limit) beyond.push_back(face), mostOver = std::max(mostOver, value / limit);
  }
};

/// What is expected, in voxels.
class Limits {
 public:
  Limits(const ReferenceMesh& reference, float expected)
      : reference_(reference), expected_(expected) {}

  /// The most anywhere.
  [[nodiscard]] float most() const { return expected_; }
  [[nodiscard]] float atVertex(Index r) const {
    if (!reference_.hasScales()) return expected_;
    return std::max(expected_ * reference_.promisedScaleAt(r), kRounding);
  }
  /// The most at a vertex of the face, as a guard may see that one alone.
  [[nodiscard]] float ofFace(Index f) const {
    const auto& v = reference_.vertices(f);
    return std::max({atVertex(v[0]), atVertex(v[1]), atVertex(v[2])});
  }

 private:
  /// Where less is expected, rounding may take as much.
  static constexpr float kRounding = 1e-4f;
  const ReferenceMesh& reference_;
  float expected_;
};

/// The largest values of regions, from several threads.
class RegionMaxima {
 public:
  explicit RegionMaxima(const Surface& s)
      : s_(s),
        largest_(s.region.empty() ? 0 : 1 + *std::max_element(s.region.begin(), s.region.end())),
        atVertex_(largest_.empty() ? 0 : s.position.size()) {}

  void see(Index triangle, float value) {
    if (!largest_.empty()) raise(largest_[s_.region[triangle]], value);
  }

  [[nodiscard]] bool isEmpty() const { return largest_.empty(); }

  /// All triangles at a vertex.
  void seeVertex(Index v, float value) { raise(atVertex_[v], value); }

  /// A way over the triangles around some owners: at lines those of other regions are among them.
  void seeAround(const std::array<Index, 3>& owners, float value) {
    if (largest_.empty()) return;
    for (const Index owner : owners) {
      see(owner, value);
      for (const Index v : s_.triangles[owner].vertices) {
        if (s_.isOnLine(v)) raise(atVertex_[v], value);
      }
    }
  }

  std::vector<float> take(const CornersOfVertices& corners) {
    for (Index v = 0; v < atVertex_.size(); ++v) {
      if (atVertex_[v] == 0) continue;
      for (const Index c : corners.of(v)) see(c / 3, atVertex_[v]);
    }
    return std::move(largest_);
  }

 private:
  static void raise(float& largest, float value) {
    const std::atomic_ref<float> shared(largest);
    float was = shared.load(std::memory_order_relaxed);
    while (value > was && !shared.compare_exchange_weak(was, value, std::memory_order_relaxed)) {
    }
  }

  const Surface& s_;
  std::vector<float> largest_;
  std::vector<float> atVertex_;  // of lines
};

}  // namespace tufa::reduce
