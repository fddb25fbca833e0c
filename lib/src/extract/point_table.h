#pragma once

#include <array>
#include <cstdint>

#include "extract/derive_tetrahedra.h"
#include "grid/samples.h"
#include "uniform/cell_topology.h"
#include "uniform/qef.h"

namespace tufa::extraction {

/// The lattice points around a half place: one for each even coordinate, two for each odd one.
struct PointsAround {
  std::array<int, 8> steps{};  ///< to be added to the BlockSamples index of the cell
  int count = 1;
  std::array<int, 3> upperBit{};  ///< of the index of a step, set where it is up on that axis

  constexpr PointsAround() = default;
  constexpr explicit PointsAround(const HalfPlace& place) {
    for (int axis = 0; axis < 3; ++axis) {
      const int stride = grid::BlockSamples::stride(axis);
      const bool between = (place[axis] & 1) != 0;
      const int lower = (place[axis] - (between ? 1 : 0)) / 2;
      for (int i = 0; i < count; ++i) steps[i] += lower * stride;
      if (!between) continue;
      upperBit[axis] = count;
      for (int i = 0; i < count; ++i) steps[count + i] = steps[i] + stride;
      count *= 2;
    }
  }
};

/// The mean of the samples around a half place of a cell, always summed in the same order.
template <PointsAround kAround>
float valueAt(const grid::BlockSamples& samples, int cell) {
  constexpr float kShare = 1 / static_cast<float>(kAround.count);
  float sum = 0;
  for (int i = 0; i < kAround.count; ++i) sum += kShare * samples[cell + kAround.steps[i]];
  return sum;
}

/// Values and gradients at the points of the cells of one block, which many edges share. Whole rows
/// along z are computed at a time, those that surface cells have points in.
///
/// A gradient is the mean of differences across its point on the axes where that is between lattice
/// points, of central differences on the others.
template <class Lattice>
class PointTable {
 public:
  /// The index of a point of a cell, to be added to the BlockSamples index of that cell.
  static constexpr int offsetOf(const HalfPlace& place) {
    const std::array<int, 3> odd = {place[0] & 1, place[1] & 1, place[2] & 1};
    int offset = kSlots[odd[0] * 4 + odd[1] * 2 + odd[2]] * kSamples;
    for (int axis = 0; axis < 3; ++axis) {
      offset += (place[axis] - odd[axis]) / 2 * grid::BlockSamples::stride(axis);
    }
    return offset;
  }

  void fill(const grid::BlockSamples& samples, const grid::BlockBits& cells) {
    Rows rows{};
    for (int x = 0; x < grid::kBlockSize; ++x) {
      for (int y = 0; y < grid::kBlockSize; ++y) {
        if ((cells.slabs[x] >> (8 * y) & 0xff) != 0) rows[x + 1] |= std::uint32_t{2} << y;
      }
    }
    fillKind<0>(samples, rows);
    if constexpr (Lattice::kFaceCentres) {
      fillKind<3>(samples, rows);
      fillKind<5>(samples, rows);
      fillKind<6>(samples, rows);
    }
    if constexpr (Lattice::kCentres) fillKind<7>(samples, rows);
  }

  [[nodiscard]] float value(int point) const { return values_[point]; }
  [[nodiscard]] float gradient(int axis, int point) const { return gradients_[axis][point]; }

 private:
  static constexpr int kSamples = grid::BlockSamples::index(9, 9, 9) + 1;
  // Kinds of points are numbered by the axes on which they are between lattice points, 4, 2, 1.
  static constexpr std::array<int, 8> kSlots = [] {
    std::array<int, 8> slots{};
    int next = 1;
    for (const int kind : {3, 5, 6}) slots[kind] = Lattice::kFaceCentres ? next++ : 0;
    slots[7] = Lattice::kCentres ? next : 0;
    return slots;
  }();
  static constexpr int kSlotCount =
      1 + (Lattice::kFaceCentres ? 3 : 0) + (Lattice::kCentres ? 1 : 0);

  // For each x, -1..9, a bit for each y, from -1.
  using Rows = std::array<std::uint32_t, grid::BlockSamples::kSize>;

  template <int kKind>
  void fillKind(const grid::BlockSamples& samples, const Rows& ofCells) {
    constexpr PointsAround kAround{HalfPlace{kKind >> 2, kKind >> 1 & 1, kKind & 1}};
    constexpr bool kIsBeyond = kKind == 7 && Lattice::kCentresBeyond;
    constexpr int kFirstZ = kIsBeyond ? -1 : 0;
    constexpr int kLanes = grid::kBlockSize + (kIsBeyond ? 2 : (kKind & 1) != 0 ? 0 : 1);
    for (int x = -1; x <= grid::kBlockSize; ++x) {
      const auto rowsAt = [&](int at) {
        return at < -1 || at > grid::kBlockSize ? 0 : ofCells[at + 1];
      };
      std::uint32_t rows = rowsAt(x);
      if (kIsBeyond) rows |= rows << 1 | rows >> 1 | rowsAt(x - 1) | rowsAt(x + 1);
      if ((kKind & 4) == 0) rows |= rowsAt(x - 1);
      if ((kKind & 2) == 0) rows |= rows << 1;
      for (int y = -1; y <= grid::kBlockSize; ++y) {
        if ((rows >> (y + 1) & 1) == 0) continue;
        fillRow<kAround, kLanes>(samples.data(), grid::BlockSamples::index(x, y, kFirstZ),
                                 kSlots[kKind] * kSamples);
      }
    }
  }

  template <PointsAround kAround, int kLanes>
  void fillRow(const float* samples, int first, int slot) {
    constexpr float kShare = 1 / static_cast<float>(kAround.count);
    std::array<float, kLanes> sum{};
    for (int i = 0; i < kAround.count; ++i) {
      const float* const from = samples + first + kAround.steps[i];
      for (int lane = 0; lane < kLanes; ++lane) sum[lane] += kShare * from[lane];
    }
    for (int lane = 0; lane < kLanes; ++lane) values_[slot + first + lane] = sum[lane];
    fillGradient<kAround, kLanes, 0>(samples, first, slot);
    fillGradient<kAround, kLanes, 1>(samples, first, slot);
    fillGradient<kAround, kLanes, 2>(samples, first, slot);
  }

  template <PointsAround kAround, int kLanes, int kAxis>
  void fillGradient(const float* samples, int first, int slot) {
    constexpr int kStride = grid::BlockSamples::stride(kAxis), kUpper = kAround.upperBit[kAxis];
    std::array<float, kLanes> sum{};
    for (int i = 0; i < kAround.count; ++i) {
      const float* const from = samples + first + kAround.steps[i];
      for (int lane = 0; lane < kLanes; ++lane) {
        if constexpr (kUpper == 0) {
          sum[lane] += from[lane + kStride] - from[lane - kStride];
        } else {
          sum[lane] += (i & kUpper) != 0 ? 2 * from[lane] : -2 * from[lane];
        }
      }
    }
    constexpr float kMean = (kUpper != 0 ? 2.0F : 1.0F) / static_cast<float>(2 * kAround.count);
    float* const to = gradients_[kAxis].data() + slot + first;
    for (int lane = 0; lane < kLanes; ++lane) to[lane] = kMean * sum[lane];
  }

  std::array<float, kSlotCount * kSamples> values_;
  std::array<std::array<float, kSlotCount * kSamples>, 3> gradients_;
};

}  // namespace tufa::extraction
