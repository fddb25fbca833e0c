#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "grid/field.h"
#include "grid/samples.h"
#include "uniform/qef.h"

namespace tufa::uniform {

/// A tangent plane of the surface, read off one cube of eight samples of a distance field.
struct CubePlane {
  Vector normal{};     ///< outward unit normal in index space
  Vector foot{};       ///< the point of the surface nearest to the cube's middle
  float residual = 0;  ///< how far the samples are from linear, in voxels
};

/// Tangent planes from the cubes of a block.
///
/// Where a distance field is smooth, one cube tells the surface point nearest to it and the normal
/// there exactly up to curvature, however far the cube is from a crossing. Near a crease the field
/// is smooth on either side of a bisector; cubes that the bisector passes show it by a residual or
/// by a gradient that is not of unit length, and give no plane.
class CubePlanes {
 public:
  CubePlanes(const grid::BlockSamples& samples, const grid::FieldScale& scale)
      : samples_(samples), scale_(scale) {}

  /// Discards the planes of the block before.
  void reset() { states_.fill(State::Unknown); }

  /// The plane of the cube whose lowest sample is lattice point (x, y, z), each -1..8; null if the
  /// field is not smooth there. Points are in voxels from the block's first lattice point.
  [[nodiscard]] const CubePlane* at(int x, int y, int z);

 private:
  enum class State : std::uint8_t { Unknown, None, Plane };
  static constexpr int kSize = grid::kBlockSize + 2;

  [[nodiscard]] std::optional<CubePlane> fit(int x, int y, int z) const;

  const grid::BlockSamples& samples_;
  const grid::FieldScale& scale_;
  std::array<State, kSize * kSize * kSize> states_{};
  std::array<CubePlane, kSize * kSize * kSize> planes_;
};

}  // namespace tufa::uniform
