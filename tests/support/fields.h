#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <random>

namespace tufa::test {

/// Samples a function of the lattice point on a box of active voxels. Values outside the box are
/// the background.
template <class GridT, class Function>
typename GridT::Ptr sampled(const openvdb::CoordBBox& box, typename GridT::ValueType background,
                            const Function& function) {
  auto grid = GridT::create(background);
  auto accessor = grid->getAccessor();
  for (auto at = box.begin(); at; ++at) {
    accessor.setValue(*at, static_cast<typename GridT::ValueType>(function(*at)));
  }
  return grid;
}

/// A level set of a function of the lattice point that is a distance in voxels: active where
/// |distance| < halfWidth, clamped to the background on its side elsewhere. The values are scaled
/// by the voxel size.
template <class GridT, class Function>
typename GridT::Ptr levelSet(const openvdb::CoordBBox& box, double halfWidth,
                             const Function& distance, double voxelSize = 1) {
  using Value = typename GridT::ValueType;
  const auto background = static_cast<Value>(halfWidth * voxelSize);
  auto grid = GridT::create(background);
  auto accessor = grid->getAccessor();
  for (auto at = box.begin(); at; ++at) {
    const double d = distance(*at);
    if (d <= -halfWidth) accessor.setValueOff(*at, -background);
    if (std::abs(d) < halfWidth) accessor.setValue(*at, static_cast<Value>(d * voxelSize));
  }
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxelSize));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

/// What noise() makes.
struct NoiseOptions {
  int size = 64;  ///< samples along each axis
  std::uint32_t seed = 1;
  openvdb::Coord first{-13, 5, -40};  ///< not on a block's corner
  /// Values are whole numbers from -2 to 2, else uniform between -1 and 1.
  bool wholeNumbers = false;
  double border = 3;  ///< the background around
};

/// White noise in a cube: every configuration of cells there is.
template <class GridT>
typename GridT::Ptr noise(const NoiseOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<int> whole(-2, 2);
  const openvdb::CoordBBox box(options.first, options.first.offsetBy(options.size - 1));
  return sampled<GridT>(box, static_cast<typename GridT::ValueType>(options.border),
                        [&](const openvdb::Coord&) {
                          return options.wholeNumbers ? whole(random) : uniform(random);
                        });
}

/// What randomTree() makes.
struct RandomTreeOptions {
  std::uint32_t seed = 1;
  openvdb::Coord first{-16, -24, -8};  ///< of the lowest block, a multiple of 8
  int blocks = 5;                      ///< along each axis
  double background = 1;
};

/// A cube of blocks each of which is, by chance, nothing, a tile of either side, or a leaf:
/// uniform, striped along an axis or noise. Tiles and samples are active or not by chance.
template <class GridT>
typename GridT::Ptr randomTree(const RandomTreeOptions& options) {
  using Value = typename GridT::ValueType;
  std::mt19937 random(options.seed);
  const auto chance = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  auto grid = GridT::create(static_cast<Value>(options.background));
  const int side = 8;
  for (int block = 0; block < options.blocks * options.blocks * options.blocks; ++block) {
    const openvdb::Coord origin = options.first.offsetBy(
        block / (options.blocks * options.blocks) * side,
        block / options.blocks % options.blocks * side, block % options.blocks * side);
    const int kind = chance(6);
    if (kind == 0) continue;
    const auto tileValue = static_cast<Value>(chance(2) == 0 ? -1 : 1);
    if (kind <= 2) {
      grid->tree().addTile(1, origin, tileValue, chance(2) == 0);
      continue;
    }
    auto* leaf = grid->tree().touchLeaf(origin);
    const int axis = chance(3);
    for (openvdb::Index n = 0; n < 512; ++n) {
      const openvdb::Coord local = leaf->offsetToLocalCoord(n);
      double value = tileValue;
      if (kind == 4) value = local[axis] % 3 == 0 ? -value : value;
      if (kind == 5) value = chance(2) == 0 ? -0.5 : 0.5;
      leaf->setValueOnly(n, static_cast<Value>(value));
      leaf->setActiveState(n, chance(3) != 0);
    }
  }
  return grid;
}

}  // namespace tufa::test
