#pragma once

// OpenVDB's vectors alone: its grids would cost seconds in each file.
#include <openvdb/Types.h>

#include <array>

namespace tufa::shapes {

using Vec3 = openvdb::Vec3d;

/// The lattice of one block: 8^3 sample points, z running fastest, as OpenVDB's leaves store them.
struct BlockLattice {
  static constexpr int kSide = 8;
  static constexpr int kSamples = kSide * kSide * kSide;
  openvdb::Coord origin;
  double voxelSize = 1;

  [[nodiscard]] Vec3 point(int x, int y, int z) const {
    return {(origin.x() + x) * voxelSize, (origin.y() + y) * voxelSize,
            (origin.z() + z) * voxelSize};
  }
};

/// The least and the greatest value that a field may take somewhere.
struct ValueRange {
  double least = 0;
  double greatest = 0;
};

/// A scalar field over world space, negative inside a solid that lies around the origin.
class DistanceField {
 public:
  virtual ~DistanceField() = default;

  /// Half the side of a cube around the origin that holds the solid.
  [[nodiscard]] virtual double halfExtent() const = 0;

  [[nodiscard]] virtual double distance(const Vec3& point) const = 0;

  /// Bounds of the field over a ball. They need not be tight but must be valid: whole blocks are
  /// skipped because of them. The default holds for fields with a Lipschitz constant of 1.
  [[nodiscard]] virtual ValueRange range(const Vec3& center, double radius) const {
    const double d = distance(center);
    return {d - radius, d + radius};
  }

  /// The field at all samples of a block. Where it is known to be `band` or more away from zero,
  /// any value of the right sign and at least that large will do.
  virtual void sample(const BlockLattice& lattice, double band,
                      std::array<double, BlockLattice::kSamples>& values) const;
};

}  // namespace tufa::shapes
