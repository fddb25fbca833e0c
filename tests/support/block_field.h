#pragma once

#include <openvdb/openvdb.h>

#include "base/job.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "grid/samples.h"
#include "support/fields.h"

namespace tufa::test {

/// A field with all that the stages after blocks ask for, and the samples of its block at the
/// origin.
template <class GridT = openvdb::FloatGrid>
class BlockField {
 public:
  using Tree = typename GridT::TreeType;

  explicit BlockField(typename GridT::Ptr grid, grid::IsoChoice iso = {})
      : grid_(std::move(grid)),
        job_(1, {}),
        blocks_(grid_->tree(), iso, NonFinite::Refuse, job_),
        scale_(grid::readFieldScale(*grid_, iso)) {
    typename grid::Blocks<Tree>::Accessor accessor(grid_->tree());
    const grid::BlockRef block = blocks_.find(openvdb::Coord(0), accessor);
    samples_.gather(blocks_, scale_, block, blocks_.neighbours(block, accessor), accessor);
  }

  [[nodiscard]] const GridT& grid() const { return *grid_; }
  [[nodiscard]] const grid::Blocks<Tree>& blocks() const { return blocks_; }
  [[nodiscard]] const grid::FieldScale& scale() const { return scale_; }
  [[nodiscard]] const grid::BlockSamples& samples() const { return samples_; }
  [[nodiscard]] base::Job& job() { return job_; }

 private:
  typename GridT::Ptr grid_;
  base::Job job_;
  grid::Blocks<Tree> blocks_;
  grid::FieldScale scale_;
  grid::BlockSamples samples_;
};

/// A level set around the block at the origin, of a distance given in index space.
template <class Function>
BlockField<> distanceAroundBlock(const Function& distance, double halfWidth = 4) {
  const openvdb::CoordBBox box(openvdb::Coord(-8), openvdb::Coord(16));
  return BlockField<>(levelSet<openvdb::FloatGrid>(
      box, halfWidth, [&](const openvdb::Coord& at) { return distance(at.asVec3d()); }));
}

/// Distance to a plane.
struct PlaneDistance {
  openvdb::Vec3d normal;  ///< of length 1
  double offset;
  double operator()(const openvdb::Vec3d& p) const { return normal.dot(p) - offset; }
};

/// Distance to a box turned against the lattice, exact outside its edges and corners too.
struct TurnedBoxDistance {
  openvdb::Mat3d turn;  ///< columns: the box's axes
  openvdb::Vec3d center;
  openvdb::Vec3d half;
  double operator()(const openvdb::Vec3d& p) const {
    const openvdb::Vec3d local = turn.transpose() * (p - center);
    openvdb::Vec3d beyond;
    double deepest = -1e30;
    for (int axis = 0; axis < 3; ++axis) {
      const double q = std::abs(local[axis]) - half[axis];
      beyond[axis] = std::max(q, 0.0);
      deepest = std::max(deepest, q);
    }
    return beyond.length() + std::min(deepest, 0.0);
  }
};

/// A large box one corner of which lies in the block at the origin, at (3.3, 4.1, 3.7).
inline TurnedBoxDistance boxWithCornerInBlock() {
  TurnedBoxDistance box;
  box.turn = openvdb::math::rotation<openvdb::Mat3d>(openvdb::Vec3d(0.36, 0.48, 0.8), 0.6);
  box.half = openvdb::Vec3d(20);
  box.center = openvdb::Vec3d(3.3, 4.1, 3.7) - box.turn * box.half;
  return box;
}

}  // namespace tufa::test
