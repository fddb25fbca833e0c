#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace tufa::filter {

// The places that clipping keeps, on the lattice of the grid that is clipped. Each thread asks a
// reader of its own.

/// How much of a cube of voxels is kept; Part where that is not known, too.
enum class Held { None, Part, All };

/// The nearest integer that a voxel may be at; any for NaN.
inline std::int32_t voxelAt(double place) {
  constexpr double kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr double kGreatest = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::max(kLeast, std::min(kGreatest, std::floor(place + 0.5))));
}

/// The voxels of a box.
class BoxPlaces {
 public:
  explicit BoxPlaces(const openvdb::CoordBBox& box) : box_(box) {}

  [[nodiscard]] const BoxPlaces& reader() const { return *this; }
  [[nodiscard]] bool holds(const openvdb::Coord& at) const { return box_.isInside(at); }
  [[nodiscard]] Held heldOf(const openvdb::CoordBBox& cube) const {
    if (!box_.hasOverlap(cube)) return Held::None;
    return box_.isInside(cube) ? Held::All : Held::Part;
  }

 private:
  openvdb::CoordBBox box_;
};

/// The voxels whose nearest one of a mask is active. The mask may have another lattice, and be
/// finer or coarser.
class MaskPlaces {
 public:
  MaskPlaces(openvdb::BoolGrid::ConstPtr mask, const openvdb::math::Transform& lattice)
      : mask_(std::move(mask)),
        lattice_(lattice),
        isSameLattice_(mask_->constTransform() == lattice) {
    mask_->tree().evalActiveVoxelBoundingBox(bounds_);
  }

  class Reader {
   public:
    explicit Reader(const MaskPlaces& places)
        : places_(places), mask_(places.mask_->getConstUnsafeAccessor()) {}

    [[nodiscard]] bool holds(const openvdb::Coord& at) const {
      const openvdb::Vec3d place = places_.inMask(at);
      return mask_.isValueOn({voxelAt(place[0]), voxelAt(place[1]), voxelAt(place[2])});
    }

    [[nodiscard]] Held heldOf(const openvdb::CoordBBox& cube) const {
      openvdb::CoordBBox box = places_.inMask(cube);
      if (places_.bounds_.isInside(box)) {
        const bool on = mask_.isValueOn(box.min());
        return !isAll(box, on) ? Held::Part : on ? Held::All : Held::None;
      }
      box.intersect(places_.bounds_);
      return box.empty() || isAll(box, false) ? Held::None : Held::Part;
    }

   private:
    // From tile to tile along one axis, and for each of these along the others.
    [[nodiscard]] bool isAll(openvdb::CoordBBox box, bool on) const {
      for (;;) {
        if (mask_.isValueOn(box.min()) != on) return false;
        const openvdb::Coord end = lastOfTile(box.min());
        int axis = 0;
        while (axis < 3 && box.max()[axis] <= end[axis]) ++axis;
        if (axis == 3) return true;
        openvdb::CoordBBox lower = box;
        lower.max()[axis] = end[axis];
        if (!isAll(lower, on)) return false;
        box.min()[axis] = end[axis] + 1;
      }
    }

    // The last voxel of the tile, or of the part of the background, that a voxel is of.
    [[nodiscard]] openvdb::Coord lastOfTile(const openvdb::Coord& at) const {
      using Root = openvdb::BoolTree::RootNodeType;
      using Upper = Root::ChildNodeType;
      using Lower = Upper::ChildNodeType;
      constexpr std::array<int, 4> kSides = {Upper::DIM, Lower::DIM, Lower::ChildNodeType::DIM, 1};
      const int last = kSides[std::max(0, mask_.getValueDepth(at))] - 1;
      return {at[0] | last, at[1] | last, at[2] | last};
    }

    const MaskPlaces& places_;
    openvdb::BoolGrid::ConstUnsafeAccessor mask_;
  };

  [[nodiscard]] Reader reader() const { return Reader(*this); }

 private:
  /// In the mask's index space.
  [[nodiscard]] openvdb::Vec3d inMask(const openvdb::Coord& at) const {
    if (isSameLattice_) return at.asVec3d();
    return mask_->worldToIndex(lattice_.indexToWorld(at));
  }

  /// The voxels of the mask that are nearest to those of a cube, and perhaps a few more, as a place
  /// half-way between two may be rounded either way.
  [[nodiscard]] openvdb::CoordBBox inMask(const openvdb::CoordBBox& cube) const {
    constexpr double kRounding = 1e-3;
    openvdb::BBoxd box;
    for (int corner = 0; corner < 8; ++corner) {
      openvdb::Coord at = cube.min();
      for (int axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) != 0) at[axis] = cube.max()[axis];
      }
      box.expand(inMask(at));
    }
    box.expand(kRounding);
    return {{voxelAt(box.min()[0]), voxelAt(box.min()[1]), voxelAt(box.min()[2])},
            {voxelAt(box.max()[0]), voxelAt(box.max()[1]), voxelAt(box.max()[2])}};
  }

  openvdb::BoolGrid::ConstPtr mask_;
  const openvdb::math::Transform& lattice_;
  bool isSameLattice_;
  openvdb::CoordBBox bounds_;  ///< of the mask's active voxels
};

}  // namespace tufa::filter
