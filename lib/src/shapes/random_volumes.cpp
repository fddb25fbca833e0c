// Noise and fog: volumes that are not distance fields.

#include "shapes/random_volumes.h"

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/number_text.h"
#include "shapes/hash.h"
#include "shapes/sampler.h"

namespace tufa::shapes {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// A soft ball of density.
struct Puff {
  Vec3 center;
  double radius = 0;
};

constexpr int kPuffs = 24;
constexpr double kPuffSpread = 0.6;  ///< the centres lie in a cube of this half side
constexpr double kLeastPuff = 0.2;
constexpr double kGreatestPuff = 0.4;

std::vector<Puff> makePuffs(std::uint32_t seed) {
  std::vector<Puff> puffs(kPuffs);
  for (int n = 0; n < kPuffs; ++n) {
    const auto draw = [&](int channel) { return randomAt(seed, n, channel, 1); };
    puffs[n].center = Vec3(2 * draw(0) - 1, 2 * draw(1) - 1, 2 * draw(2) - 1) * kPuffSpread;
    puffs[n].radius = kLeastPuff + (kGreatestPuff - kLeastPuff) * draw(3);
  }
  return puffs;
}

/// 0 without puffs, and ever nearer to 1 where more of them overlap.
double density(const std::vector<Puff>& puffs, const Vec3& point) {
  double sum = 0;
  for (const Puff& puff : puffs) {
    const double t = 1 - (point - puff.center).lengthSqr() / (puff.radius * puff.radius);
    if (t > 0) sum += t * t * t;
  }
  return 1 - std::exp(-2 * sum);
}

/// The puffs that reach into a cube of samples.
std::vector<Puff> puffsNear(const std::vector<Puff>& puffs, const openvdb::Coord& origin, int side,
                            double voxelSize) {
  const Vec3 least = origin.asVec3d() * voxelSize;
  const Vec3 greatest = origin.offsetBy(side - 1).asVec3d() * voxelSize;
  std::vector<Puff> near;
  for (const Puff& puff : puffs) {
    const Vec3 nearest =
        openvdb::math::minComponent(openvdb::math::maxComponent(puff.center, least), greatest);
    if ((puff.center - nearest).length() < puff.radius) near.push_back(puff);
  }
  return near;
}

void fillFog(const std::vector<Puff>& allPuffs, double voxelSize, Leaf& leaf) {
  const auto puffs = puffsNear(allPuffs, leaf.origin(), BlockLattice::kSide, voxelSize);
  leaf.setValuesOff();
  for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
    const Vec3 point = leaf.offsetToGlobalCoord(n).asVec3d() * voxelSize;
    const float value = static_cast<float>(density(puffs, point));
    leaf.buffer().data()[n] = value;
    if (value > 0) leaf.setValueOn(n);
  }
}

}  // namespace

openvdb::FloatGrid::Ptr makeNoise(const ShapeOptions& options) {
  const int half = grid::extentInVoxels(1, options.voxelSize, 1);
  const int samples = static_cast<int>(std::lround(2 / options.voxelSize));
  if (samples < 1) {
    throw Error(ErrorCode::InvalidArgument, "voxel size " + base::numberText(options.voxelSize) +
                                                " leaves no sample in a cube of side 2");
  }
  const float outside = 1;
  auto grid = openvdb::FloatGrid::create(outside);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(options.voxelSize));

  const openvdb::Coord first(-(samples / 2));
  const openvdb::CoordBBox cube(first, first.offsetBy(samples - 1));
  openvdb::CoordBBox bordered = cube;
  bordered.expand(1);
  grid::BlockSource source;
  source.halfExtentVoxels = half + 1;
  source.mayBeActive = [&](const openvdb::Coord& origin, int side) {
    return bordered.hasOverlap(openvdb::CoordBBox(origin, origin.offsetBy(side - 1)));
  };
  source.fill = [&](Leaf& leaf) {
    leaf.setValuesOff();
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      const openvdb::Coord ijk = leaf.offsetToGlobalCoord(n);
      const double random = randomAt(options.seed, ijk.x(), ijk.y(), ijk.z());
      leaf.buffer().data()[n] = cube.isInside(ijk) ? static_cast<float>(2 * random - 1) : outside;
      if (bordered.isInside(ijk)) leaf.setValueOn(n);
    }
  };
  sampleBlocks(grid->tree(), source, options);
  return grid;
}

openvdb::FloatGrid::Ptr makeFog(const ShapeOptions& options) {
  const double voxelSize = options.voxelSize;
  grid::BlockSource source;
  source.halfExtentVoxels = grid::extentInVoxels(kPuffSpread + kGreatestPuff, voxelSize, 1);
  auto grid = openvdb::FloatGrid::create(0.0f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxelSize));
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);

  const std::vector<Puff> puffs = makePuffs(options.seed);
  source.mayBeActive = [&](const openvdb::Coord& origin, int side) {
    return !puffsNear(puffs, origin, side, voxelSize).empty();
  };
  source.fill = [&](Leaf& leaf) { fillFog(puffs, voxelSize, leaf); };
  sampleBlocks(grid->tree(), source, options);
  return grid;
}

}  // namespace tufa::shapes
