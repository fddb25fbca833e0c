#include "extract/merged_leaves.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "grid/samples.h"

namespace tufa::extraction {

using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

constexpr int kAround = kBlockSize / 2;  ///< samples around a block that leaves look at
constexpr int kSide = kBlockSize + 2 * kAround;

/// An affine field around a centre.
struct Affine {
  double value = 0;
  Vec3 gradient{0.0};
};

/// Sums for the affine field with the least squares.
class AffineFit {
 public:
  void add(const Vec3& away, double value) {
    const std::array<double, 4> row = {1, away[0], away[1], away[2]};
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 4; ++k) rows_[i][k] += row[i] * row[k];
      rows_[i][4] += row[i] * value;
    }
  }

  /// By elimination with the largest pivots; nothing if the points lie in a plane.
  [[nodiscard]] std::optional<Affine> solve() {
    constexpr double kLeastPivot = 1e-6;
    for (int i = 0; i < 4; ++i) {
      int pivot = i;
      for (int k = i + 1; k < 4; ++k) {
        if (std::abs(rows_[k][i]) > std::abs(rows_[pivot][i])) pivot = k;
      }
      std::swap(rows_[i], rows_[pivot]);
      if (!(std::abs(rows_[i][i]) > kLeastPivot)) return std::nullopt;
      for (int k = 0; k < 4; ++k) {
        if (k == i) continue;
        const double factor = rows_[k][i] / rows_[i][i];
        for (int n = i; n < 5; ++n) rows_[k][n] -= factor * rows_[i][n];
      }
    }
    const auto root = [&](int i) { return rows_[i][4] / rows_[i][i]; };
    return Affine{root(0), Vec3(root(1), root(2), root(3))};
  }

 private:
  std::array<std::array<double, 5>, 4> rows_{};
};

/// Merges the samples of blocks. For one thread.
class Merger {
 public:
  Merger(const grid::Volume& volume, const uniform::CellTopology& topology, double tolerance)
      : volume_(volume),
        topology_(topology),
        tolerance_(tolerance),
        accessor_(volume.blocks.accessor()) {}

  void merge(const SurfaceBlock& block, BlockLeaves& leaves) {
    block_ = &block;
    leaves_ = &leaves;
    leaves.inside = volume_.blocks.inside(block.block);
    if (!(tolerance_ > 0) || topology_.isOpenAt(block)) return;
    gather(block);
    mergeFrom({0, 0, 0}, kMostLevel);
  }

 private:
  static constexpr int kMostLevel = 3;

  using Place = std::array<int, 3>;

  void gather(const SurfaceBlock& block) {
    const grid::SampleReader reader(volume_.blocks, volume_.scale, block.block, block.neighbours,
                                    *accessor_);
    float* to = samples_.data();
    for (int x = -kAround; x < kBlockSize + kAround; ++x) {
      for (int y = -kAround; y < kBlockSize + kAround; ++y) {
        for (int z = -kAround; z < kBlockSize + kAround; ++z) {
          *to++ = static_cast<float>(reader.at(x, y, z));
        }
      }
    }
  }

  /// Calls body(away from the centre, sample) for the samples in and around a leaf until it
  /// returns false; returns whether it never did.
  template <class Body>
  bool forSamples(const Place& at, int level, const Body& body) const {
    const int size = 1 << level, half = size / 2;
    const double centre = 0.5 * (size - 1);
    for (int x = -half; x < size + half; ++x) {
      for (int y = -half; y < size + half; ++y) {
        const float* row = samples_.data() +
                           ((at[0] + x + kAround) * kSide + at[1] + y + kAround) * kSide + at[2] +
                           kAround;
        for (int z = -half; z < size + half; ++z) {
          if (!body(Vec3(x - centre, y - centre, z - centre), row[z])) return false;
        }
      }
    }
    return true;
  }

  [[nodiscard]] bool isDistance(float sample) const {
    const grid::FieldScale& scale = volume_.scale;
    return sample > scale.bandInside && sample < scale.bandOutside;
  }

  /// The affine field of a leaf, if it may be one.
  [[nodiscard]] std::optional<Affine> affineAt(const Place& at, int level) const {
    AffineFit fit;
    forSamples(at, level, [&](const Vec3& away, float sample) {
      if (isDistance(sample)) fit.add(away, static_cast<double>(sample));
      return true;
    });
    const auto affine = fit.solve();
    if (!affine) return std::nullopt;
    const Vec3& g = affine->gradient;
    const auto single = [&](int axis) { return static_cast<float>(g[axis]); };
    const double slope = std::sqrt(
        static_cast<double>(volume_.scale.squaredLength(single(0), single(1), single(2))));
    const double most = slope * tolerance_ / 2;
    const double reach = slope * (1 << level);
    const bool holds = forSamples(at, level, [&](const Vec3& away, float sample) {
      const double is = static_cast<double>(sample);
      const double should = affine->value + g.dot(away);
      if (!isDistance(sample)) return (is < 0 ? is - should : should - is) > -most;
      if (std::abs(should) > reach && std::abs(is) > reach) return (is < 0) == (should < 0);
      return std::abs(is - should) <= most;
    });
    return holds ? affine : std::nullopt;
  }

  void mergeFrom(const Place& at, int level) {
    const int size = 1 << level;
    if (const auto affine = affineAt(at, level)) {
      if (add(at, level, *affine)) return;
    }
    if (level == 1) return;
    for (int part = 0; part < 8; ++part) {
      const int half = size / 2;
      mergeFrom(
          {at[0] + (part >> 2) * half, at[1] + ((part >> 1) & 1) * half, at[2] + (part & 1) * half},
          level - 1);
    }
  }

  /// Adds a leaf, unless samples at a block without surface would change their side.
  bool add(const Place& at, int level, const Affine& affine) {
    const int size = 1 << level;
    const auto value = static_cast<float>(affine.value);
    const bool inside = value < 0;
    grid::BlockBits changed = leaves_->inside;
    for (int x = at[0]; x < at[0] + size; ++x) {
      for (int y = at[1]; y < at[1] + size; ++y) {
        for (int z = at[2]; z < at[2] + size; ++z) {
          const int cell = grid::cellIndex(x, y, z);
          if (changed.get(cell) == inside) continue;
          if (touchesOther(x, y, z)) return false;
          changed.flip(cell);
        }
      }
    }
    leaves_->inside = changed;
    for (int x = at[0]; x < at[0] + size; x += 2) {
      for (int y = at[1]; y < at[1] + size; y += 2) {
        for (int z = at[2]; z < at[2] + size; z += 2) {
          leaves_->slot[(x >> 1) * 16 + (y >> 1) * 4 + (z >> 1)] =
              static_cast<std::int8_t>(leaves_->merged.size());
        }
      }
    }
    MergedLeaf leaf;
    leaf.level = static_cast<std::uint8_t>(level);
    leaf.value = value;
    for (int i = 0; i < 3; ++i) {
      leaf.at[i] = static_cast<std::uint8_t>(at[i]);
      leaf.gradient[i] = static_cast<float>(affine.gradient[i]);
    }
    leaves_->merged.push_back(leaf);
    return true;
  }

  /// Whether a sample is next to one of a block that the surface does not pass.
  [[nodiscard]] bool touchesOther(int x, int y, int z) const {
    for (int n = 0; n < 27; ++n) {
      const int dx = (x + n / 9 - 1) >> 3, dy = (y + n / 3 % 3 - 1) >> 3, dz = (z + n % 3 - 1) >> 3;
      if (topology_.neighbour(*block_, dx, dy, dz) == uniform::kNoSurfaceBlock) return true;
    }
    return false;
  }

  const grid::Volume& volume_;
  const uniform::CellTopology& topology_;
  double tolerance_;
  std::unique_ptr<grid::Accessor> accessor_;
  const SurfaceBlock* block_ = nullptr;
  BlockLeaves* leaves_ = nullptr;
  std::array<float, kSide * kSide * kSide> samples_;
};

}  // namespace

std::vector<BlockLeaves> mergeSamples(const grid::Volume& volume,
                                      const uniform::CellTopology& topology, double tolerance,
                                      base::Job& job) {
  std::vector<BlockLeaves> leaves(topology.blocks.size());
  job.forRanges(leaves.size(), 8, [&](std::size_t begin, std::size_t end) {
    Merger merger(volume, topology, tolerance);
    for (std::size_t i = begin; i < end; ++i) merger.merge(topology.blocks[i], leaves[i]);
  });
  return leaves;
}

}  // namespace tufa::extraction
