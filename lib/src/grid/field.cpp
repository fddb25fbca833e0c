#include "grid/field.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tufa::grid {
namespace {

// A field counts as a distance if these shares of the gradients near the surface have lengths
// within these tolerances of 1. Within the first are 0.8 and more of most scans and parts of 60
// voxels, 0.7 of walls of two voxels, none of white noise. Within the second are 0.5 and more of
// most scans and parts, 0.27 of a propeller, and 0.06 to 0.14 of a function divided by its
// gradient's length, as is the shape gyroid: what is a tenth off all over has kinks where the
// surface has no creases.
constexpr double kUnitShare = 0.5, kUnitTolerance = 0.2;
constexpr double kExactShare = 0.2, kExactTolerance = 0.05;
constexpr std::size_t kSampledLeaves = 512;

openvdb::math::Mat3d linearPart(const openvdb::math::Transform& transform) {
  openvdb::math::Mat3d columns;
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0);
    unit[axis] = 1;
    columns.setCol(axis, transform.baseMap()->applyJacobian(unit));
  }
  return columns;
}

// Calls use(leaf, values) for some of the leaves, all over the tree.
template <class TreeT, class Use>
void forSomeLeaves(const TreeT& tree, base::LeafSource* source, const Use& use) {
  using Leaf = typename TreeT::LeafNodeType;
  std::vector<const Leaf*> all;
  tree.getNodes(all);
  LeafValues<Leaf> valuesOf(source);
  const std::size_t step = std::max<std::size_t>(1, all.size() / kSampledLeaves);
  for (std::size_t i = 0; i < all.size(); i += step) use(*all[i], valuesOf.of(*all[i], i));
}

// Scales values that are so large or small that the squares of their differences are no floats,
// such as densities of 1e-24. By a power of two, as directions are all that counts of a field that
// is no distance.
template <class TreeT>
void bringIntoRange(const TreeT& tree, base::LeafSource* source, FieldScale& scale) {
  constexpr double kSmall = 1e-10, kLarge = 1e10, kLargestFactor = 1e38;
  double largest = 0;
  forSomeLeaves(tree, source, [&](const auto&, const auto* values) {
    for (int i = 0; i < kBlockCells; ++i) {
      const double size = std::abs((values[i] - scale.isovalue) * scale.factor);
      if (std::isfinite(size)) largest = std::max(largest, size);
    }
  });
  if (!(largest > 0) || (largest >= kSmall && largest <= kLarge)) return;
  const double factor = std::ldexp(scale.factor, -std::ilogb(largest));
  const bool isFloat = std::is_same_v<typename TreeT::ValueType, float>;
  scale.factor = isFloat ? std::clamp(factor, -kLargestFactor, kLargestFactor) : factor;
}

// Whether enough of the gradients near the surface have a length near 1, and very near it. They are
// taken towards the surface, where a distance comes from (Rouy and Tourin 1992): on the other side
// of a thin wall's middle it falls again, and a mean of both would be no gradient. But differences
// to one side are off by half a voxel over the radius of curvature, so that very near it is also
// what central ones say.
template <class TreeT>
bool hasUnitGradient(const TreeT& tree, base::LeafSource* source, const FieldScale& scale,
                     const IsoChoice& iso) {
  std::size_t units = 0, exact = 0, all = 0;
  const auto offUnit = [&](const std::array<double, 3>& gradient) {
    return std::abs(std::sqrt(scale.squaredLength(static_cast<float>(gradient[0]),
                                                  static_cast<float>(gradient[1]),
                                                  static_cast<float>(gradient[2]))) -
                    1);
  };
  forSomeLeaves(tree, source, [&](const auto& leaf, const auto* values) {
    const auto& mask = leaf.getValueMask();
    for (int cell = 0; cell < kBlockCells; ++cell) {
      const int x = cell >> 6, y = (cell >> 3) & 7, z = cell & 7;
      if (x == 0 || x == 7 || y == 0 || y == 7 || z == 0 || z == 7 || !mask.isOn(cell)) continue;
      const double here = values[cell];
      const bool inside = isInside(here, iso);
      std::array<double, 3> gradient{}, central{};
      bool crossed = false, complete = true, both = true;
      for (int axis = 0; axis < 3; ++axis) {
        const int stride = axis == 0 ? 64 : axis == 1 ? 8 : 1;
        bool any = false;
        double most = 0;  // of how much nearer to the other side of the surface a neighbour is
        for (const int side : {-stride, stride}) {
          const double there = values[cell + side];
          crossed |= inside != isInside(there, iso);
          both &= mask.isOn(cell + side);
          if (!mask.isOn(cell + side)) continue;
          any = true;
          const double rise = (there - here) * scale.factor;
          central[axis] += (side < 0 ? -rise : rise) / 2;
          if ((inside ? rise : -rise) <= most) continue;
          most = std::abs(rise);
          gradient[axis] = side < 0 ? -rise : rise;
        }
        complete &= any;
      }
      if (!crossed || !complete) continue;
      ++all;
      const double off = offUnit(gradient);
      units += off < kUnitTolerance ? 1 : 0;
      exact += off < kExactTolerance || (both && offUnit(central) < kExactTolerance) ? 1 : 0;
    }
  });
  const auto isMore = [&](std::size_t some, double share) {
    return static_cast<double>(some) > share * static_cast<double>(all);
  };
  return isMore(units, kUnitShare) && isMore(exact, kExactShare);
}

template <class TreeT>
FieldScale readScale(const openvdb::Grid<TreeT>& grid, base::LeafSource* source,
                     const IsoChoice& iso) {
  const openvdb::math::Mat3d linear = linearPart(grid.transform());
  const double voxel = std::cbrt(std::abs(linear.det()));
  FieldScale scale;
  scale.isovalue = iso.isovalue;
  scale.factor = (iso.insideIsBelow ? 1 : -1) / voxel;
  const openvdb::math::Mat3d inverse = linear.inverse();
  const openvdb::math::Mat3d metric = inverse * inverse.transpose() * (voxel * voxel);
  scale.metric = {static_cast<float>(metric(0, 0)), static_cast<float>(metric(0, 1)),
                  static_cast<float>(metric(0, 2)), static_cast<float>(metric(1, 1)),
                  static_cast<float>(metric(1, 2)), static_cast<float>(metric(2, 2))};
  for (int axis = 0; axis < 3; ++axis) {
    scale.axisLength[axis] = linear.col(axis).length() / voxel;
  }
  const bool isFog = grid.getGridClass() == openvdb::GRID_FOG_VOLUME;
  scale.distance = !isFog && hasUnitGradient(grid.tree(), source, scale, iso);
  if (!scale.distance) bringIntoRange(grid.tree(), source, scale);
  scale.narrowBand = scale.distance && grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  if (scale.narrowBand) {
    // A little less than the background, which a band clamps to.
    const double band = std::abs(static_cast<double>(grid.background())) * 0.9999;
    const double ends[2] = {(-band - iso.isovalue) * scale.factor,
                            (band - iso.isovalue) * scale.factor};
    scale.bandInside = static_cast<float>(std::min(ends[0], ends[1]));
    scale.bandOutside = static_cast<float>(std::max(ends[0], ends[1]));
  }
  return scale;
}

}  // namespace

FieldScale readFieldScale(const StoredGrid& stored, const IsoChoice& iso) {
  const openvdb::GridBase& grid = stored.grid;
  if (grid.isType<openvdb::FloatGrid>()) {
    return readScale(static_cast<const openvdb::FloatGrid&>(grid), stored.leaves, iso);
  }
  return readScale(static_cast<const openvdb::DoubleGrid&>(grid), stored.leaves, iso);
}

}  // namespace tufa::grid
