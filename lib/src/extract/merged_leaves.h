#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "grid/volume.h"
#include "uniform/cell_topology.h"

namespace tufa::extraction {

/// A leaf of the octree over the samples: a cube of 2, 4 or 8 samples along each edge in one block,
/// around which the field is affine to the tolerance. Samples in none are leaves of their own.
struct MergedLeaf {
  std::uint8_t level = 1;           ///< 2^level samples along an edge
  std::array<std::uint8_t, 3> at;   ///< its first sample, in its block
  float value = 0;                  ///< of the affine field at its centre, voxels, negative inside
  std::array<float, 3> gradient{};  ///< of that field, for each step of the lattice

  /// Its centre, in lattice coordinates of its block.
  [[nodiscard]] Vec3 centre() const {
    const double half = 0.5 * ((1 << level) - 1);
    return {at[0] + half, at[1] + half, at[2] + half};
  }
  /// The affine field at a point of the block's lattice.
  [[nodiscard]] double valueAt(const Vec3& point) const {
    const Vec3 away = point - centre();
    return static_cast<double>(value) + away.dot({gradient[0], gradient[1], gradient[2]});
  }
};

/// The leaves of one surface block.
struct BlockLeaves {
  static constexpr std::int8_t kSingle = -1;

  std::vector<MergedLeaf> merged;
  /// For each two samples along each axis the leaf they are in, or kSingle.
  std::array<std::int8_t, 64> slot = [] {
    std::array<std::int8_t, 64> none{};
    none.fill(kSingle);
    return none;
  }();
  grid::BlockBits inside;  ///< of each sample the side of the centre of its leaf

  [[nodiscard]] const MergedLeaf* leafAt(int x, int y, int z) const {
    const std::int8_t leaf = slot[(x >> 1) * 16 + (y >> 1) * 4 + (z >> 1)];
    return leaf == kSingle ? nullptr : &merged[leaf];
  }
};

/// Merges the samples of each block of `topology` into leaves as large as the tolerance, in voxels,
/// allows.
///
/// A leaf of s samples along its edge may stand for them if the samples around it, as far as s / 2
/// beyond it, are those of an affine field to half of the tolerance, wherever that field is less
/// than s voxels from the surface, and have its sign elsewhere. A dual cell lies in that
/// neighbourhood of its largest leaf, whatever the others are. Its vertices are off that leaf's
/// plane by no more than the tolerance, the trilinear surface by half of it; on curved surfaces
/// both are off to the same side. Nothing is merged where the data ends.
[[nodiscard]] std::vector<BlockLeaves> mergeSamples(const grid::Volume& volume,
                                                    const uniform::CellTopology& topology,
                                                    double tolerance, base::Job& job);

}  // namespace tufa::extraction
