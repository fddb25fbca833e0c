#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "blocks/isovalue.h"
#include "check/frame.h"

namespace tufa::checks {

/// The samples of a grid around one cell. Corner n is at (n & 1, n >> 1 & 1, n >> 2) from the cell.
struct CellSamples {
  openvdb::Coord cell;
  std::array<double, 8> values{};  ///< less the isovalue
  unsigned insideMask = 0;         ///< bit n: corner n is inside
  /// The corners hold a surface: all finite and, in a level set, all active. Outside its band a
  /// level set holds no distances, and contour() leaves the surface open there.
  bool isData = false;
};

/// The trilinear interpolant of a grid less the isovalue, in voxel space. For one thread.
template <class GridT>
class TrilinearField {
 public:
  TrilinearField(const GridT& grid, const Frame& frame, const blocks::IsoChoice& iso)
      : frame_(frame),
        iso_(iso),
        narrowBand_(grid.getGridClass() == openvdb::GRID_LEVEL_SET),
        accessor_(grid.getConstAccessor()) {}

  [[nodiscard]] const CellSamples& load(const openvdb::Coord& cell) {
    if (isLoaded_ && cell == samples_.cell) return samples_;
    isLoaded_ = true;
    samples_.cell = cell;
    samples_.insideMask = 0;
    samples_.isData = true;
    for (int n = 0; n < 8; ++n) {
      typename GridT::ValueType value;
      const bool active = accessor_.probeValue(cell.offsetBy(n & 1, (n >> 1) & 1, n >> 2), value);
      if ((narrowBand_ && !active) || !std::isfinite(value)) samples_.isData = false;
      samples_.values[n] = static_cast<double>(value) - iso_.isovalue;
      if (blocks::isInside(static_cast<double>(value), iso_)) samples_.insideMask |= 1U << n;
    }
    return samples_;
  }

  /// Value and gradient at a point.
  struct Sample {
    double value;
    openvdb::Vec3d gradient;
    [[nodiscard]] double slope() const { return gradient.length(); }
  };
  [[nodiscard]] Sample at(const openvdb::Vec3d& point) {
    const openvdb::Vec3d index = frame_.toIndex(point);
    const openvdb::Coord cell = openvdb::Coord::floor(index);
    const std::array<double, 8>& v = load(cell).values;
    const double x = index[0] - cell[0];
    const double y = index[1] - cell[1];
    const double z = index[2] - cell[2];
    const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
    const double y0z0 = mix(v[0], v[1], x);
    const double y1z0 = mix(v[2], v[3], x);
    const double y0z1 = mix(v[4], v[5], x);
    const double y1z1 = mix(v[6], v[7], x);
    const double z0 = mix(y0z0, y1z0, y);
    const double z1 = mix(y0z1, y1z1, y);
    const openvdb::Vec3d gradient(
        mix(mix(v[1] - v[0], v[3] - v[2], y), mix(v[5] - v[4], v[7] - v[6], y), z),
        mix(y1z0 - y0z0, y1z1 - y0z1, z), z1 - z0);
    return {mix(z0, z1, z), frame_.gradientFromIndex(gradient)};
  }

  /// A zero of the field near `start`, by Newton steps along the gradient. Nothing if they leave
  /// the data, stray further than kReach, or do not settle.
  [[nodiscard]] std::optional<openvdb::Vec3d> project(const openvdb::Vec3d& start) {
    if (!isWithinLattice(start)) return std::nullopt;
    openvdb::Vec3d point = start;
    Sample sample = at(point);
    for (int step = 0; step < kMostSteps; ++step) {
      if (!samples_.isData) return std::nullopt;
      const double slope = sample.slope();
      if (std::abs(sample.value) <= kTolerance * slope) {
        // On a plateau at the isovalue every point is a zero and none is the surface.
        if (slope == 0) return std::nullopt;
        return point;
      }
      const double length = std::min(std::abs(sample.value) / slope, 1.0);
      if (!(length > 0)) return std::nullopt;
      const openvdb::Vec3d next =
          point - sample.gradient * (std::copysign(length, sample.value) / slope);
      if ((next - start).length() > kReach) return std::nullopt;
      const Sample ahead = at(next);
      if (std::signbit(ahead.value) != std::signbit(sample.value)) {
        return rootBetween(point, sample.value, next, ahead.value);
      }
      point = next;
      sample = ahead;
    }
    return std::nullopt;
  }

  /// The field's gradient at a point, as a unit vector; 0 where there is none.
  [[nodiscard]] openvdb::Vec3d direction(const openvdb::Vec3d& point) {
    const Sample sample = at(point);
    const double slope = sample.slope();
    return slope > 0 ? sample.gradient / slope : openvdb::Vec3d(0);
  }

 private:
  /// Lattice coordinates are 32-bit integers; a mesh may lie anywhere.
  [[nodiscard]] bool isWithinLattice(const openvdb::Vec3d& point) const {
    const openvdb::Vec3d index = frame_.toIndex(point);
    return std::abs(index[0]) < 1e9 && std::abs(index[1]) < 1e9 && std::abs(index[2]) < 1e9;
  }

  static constexpr int kMostSteps = 20;
  static constexpr double kReach = 4;  ///< voxels; further off the search over samples is better
  static constexpr double kTolerance = 1e-8;  ///< voxels; float samples carry less

  /// A zero on a segment whose ends have different signs: the field is continuous, so the Illinois
  /// variant of false position cannot miss, even where the gradient jumps between cells.
  std::optional<openvdb::Vec3d> rootBetween(openvdb::Vec3d a, double valueA, openvdb::Vec3d b,
                                            double valueB) {
    for (int step = 0; step < 60; ++step) {
      const openvdb::Vec3d middle = a + (b - a) * (valueA / (valueA - valueB));
      const Sample sample = at(middle);
      if (!samples_.isData || !std::isfinite(sample.value)) return std::nullopt;
      if (std::abs(sample.value) <= kTolerance * sample.slope() ||
          (b - a).lengthSqr() < kTolerance * kTolerance) {
        return middle;
      }
      if (std::signbit(sample.value) == std::signbit(valueB)) {
        valueA /= 2;
      } else {
        a = b;
        valueA = valueB;
      }
      b = middle;
      valueB = sample.value;
    }
    return std::nullopt;
  }

  const Frame& frame_;
  blocks::IsoChoice iso_;
  bool narrowBand_;
  typename GridT::ConstAccessor accessor_;
  CellSamples samples_;
  bool isLoaded_ = false;
};

}  // namespace tufa::checks
