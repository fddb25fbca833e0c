#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/job.h"
#include "base/vec3.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "grid/samples.h"
#include "grid/tree.h"
#include "grid/vdb_coord.h"
#include "support/fields.h"

namespace tufa::test {

/// A field with all that the stages after blocks ask for, and the samples of its block at the
/// origin.
class BlockField {
 public:
  explicit BlockField(openvdb::GridBase::ConstPtr grid, grid::IsoChoice iso = {})
      : grid_(std::move(grid)),
        job_(1, {}),
        blocks_(grid::treeOf(*grid_, job_), iso, NonFinite::Refuse, job_),
        scale_(grid::readFieldScale(*grid_, iso)) {
    const auto accessor = blocks_.accessor();
    const grid::BlockRef block = blocks_.find(Coord(0), *accessor);
    samples_.gather(blocks_, scale_, block, blocks_.neighbours(block, *accessor), *accessor);
  }

  [[nodiscard]] const openvdb::GridBase& grid() const { return *grid_; }
  [[nodiscard]] const grid::Blocks& blocks() const { return blocks_; }
  [[nodiscard]] const grid::FieldScale& scale() const { return scale_; }
  [[nodiscard]] const grid::BlockSamples& samples() const { return samples_; }
  [[nodiscard]] base::Job& job() { return job_; }

 private:
  openvdb::GridBase::ConstPtr grid_;
  base::Job job_;
  grid::Blocks blocks_;
  grid::FieldScale scale_;
  grid::BlockSamples samples_;
};

/// The samples around the block at the origin.
inline openvdb::CoordBBox boxAroundBlock() { return {openvdb::Coord(-8), openvdb::Coord(16)}; }

/// A level set around the block at the origin, of a distance given in index space.
template <class Function>
BlockField distanceAroundBlock(const Function& distance, double halfWidth = 4) {
  return BlockField(levelSet<openvdb::FloatGrid>(
      boxAroundBlock(), halfWidth,
      [&](const openvdb::Coord& at) { return distance(Vec3(grid::fromVdb(at))); }));
}

/// Distance to a plane.
struct PlaneDistance {
  Vec3 normal;  ///< of length 1
  double offset;
  double operator()(const Vec3& p) const { return normal.dot(p) - offset; }
};

/// Distance to a box turned against the lattice, exact outside its edges and corners too.
struct TurnedBoxDistance {
  std::array<Vec3, 3> axes;  ///< of length 1
  Vec3 center;
  Vec3 half;

  /// A point along the box's own axes, counted from its corner at half the size along all three.
  [[nodiscard]] Vec3 fromCorner(const Vec3& p) const {
    Vec3 local;
    for (int i = 0; i < 3; ++i) local[i] = axes[i].dot(p - center) - half[i];
    return local;
  }
  /// The cosine of the angle between a direction and the nearest of the axes.
  [[nodiscard]] double cosineToAxis(const Vec3& direction) const {
    return std::max({direction.dot(axes[0]), direction.dot(axes[1]), direction.dot(axes[2])});
  }
  double operator()(const Vec3& p) const {
    Vec3 beyond;
    double deepest = -1e30;
    for (int i = 0; i < 3; ++i) {
      const double q = std::abs(axes[i].dot(p - center)) - half[i];
      beyond[i] = std::max(q, 0.0);
      deepest = std::max(deepest, q);
    }
    return beyond.length() + std::min(deepest, 0.0);
  }
};

/// A large box one corner of which lies in the block at the origin, at (3.3, 4.1, 3.7).
inline TurnedBoxDistance boxWithCornerInBlock() {
  const auto turn = openvdb::math::rotation<openvdb::Mat3d>(openvdb::Vec3d(0.36, 0.48, 0.8), 0.6);
  TurnedBoxDistance box;
  box.half = Vec3(20);
  box.center = Vec3(3.3, 4.1, 3.7);
  for (int i = 0; i < 3; ++i) {
    box.axes[i] = grid::fromVdb(turn.col(i));
    box.center -= box.axes[i] * box.half[i];
  }
  return box;
}

}  // namespace tufa::test
