#pragma once

#include <array>
#include <memory>

#include "base/vec3.h"
#include "grid/volume.h"

namespace tufa::grid {

/// The trilinear interpolant of a volume: values in voxels, negative inside. Points are in lattice
/// coordinates counted from the volume's affine.origin(). For one thread.
class TrilinearReader {
 public:
  explicit TrilinearReader(const Volume& volume)
      : volume_(volume), accessor_(volume.blocks.accessor()) {}

  [[nodiscard]] double value(const Vec3& point);
  /// Its derivatives, for each step of the lattice.
  [[nodiscard]] Vec3 gradient(const Vec3& point);
  /// The length of a gradient, in values for each voxel.
  [[nodiscard]] double slope(const Vec3& gradient) const;

 private:
  void load(const Coord& cell);

  const Volume& volume_;
  std::unique_ptr<Accessor> accessor_;
  Coord cell_{0};
  bool isLoaded_ = false;
  std::array<double, 8> corners_{};
};

}  // namespace tufa::grid
