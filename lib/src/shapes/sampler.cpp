#include "shapes/sampler.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>

#include "base/job.h"

namespace tufa::shapes {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

void fillLeaf(const DistanceField& field, double voxelSize, double band, Leaf& leaf) {
  std::array<double, BlockLattice::kSamples> values;
  field.sample({leaf.origin(), voxelSize}, band, values);
  const float background = static_cast<float>(band);
  leaf.setValuesOff();
  float* const data = leaf.buffer().data();
  for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
    const float value = static_cast<float>(values[n]);
    const bool active = std::abs(value) < background;
    data[n] = active ? value : std::copysign(background, value);
    if (active) leaf.setValueOn(n);
  }
}

}  // namespace

void DistanceField::sample(const BlockLattice& lattice, double /*band*/,
                           std::array<double, BlockLattice::kSamples>& values) const {
  std::size_t n = 0;
  for (int x = 0; x < BlockLattice::kSide; ++x) {
    for (int y = 0; y < BlockLattice::kSide; ++y) {
      for (int z = 0; z < BlockLattice::kSide; ++z) values[n++] = distance(lattice.point(x, y, z));
    }
  }
}

void sampleBlocks(openvdb::FloatTree& tree, const grid::BlockSource& source,
                  const ShapeOptions& options) {
  base::Job job(options.threads, options.progress);
  job.beginStage("sampling", 1);
  grid::buildBlocks(tree, source, job);
  job.finish();
}

openvdb::FloatGrid::Ptr sampleLevelSet(const DistanceField& field, const ShapeOptions& options) {
  const double voxelSize = options.voxelSize;
  const double band = options.halfWidth * voxelSize;
  grid::BlockSource source;
  // First of all: it refuses voxel sizes that OpenVDB would not take for a transform.
  source.halfExtentVoxels = grid::extentInVoxels(field.halfExtent(), voxelSize, options.halfWidth);
  auto levelSet = openvdb::FloatGrid::create(static_cast<float>(band));
  levelSet->setTransform(openvdb::math::Transform::createLinearTransform(voxelSize));
  levelSet->setGridClass(openvdb::GRID_LEVEL_SET);
  source.mayBeActive = [&](const openvdb::Coord& origin, int side) {
    // The samples of a cube fill it but for its last layer.
    const double half = 0.5 * (side - 1);
    const Vec3 center = (origin.asVec3d() + Vec3(half)) * voxelSize;
    const ValueRange range = field.range(center, std::sqrt(3.0) * half * voxelSize);
    return range.least < band && range.greatest > -band;
  };
  source.fill = [&](Leaf& leaf) { fillLeaf(field, voxelSize, band, leaf); };
  sampleBlocks(levelSet->tree(), source, options);

  // Leaves already hold the right signs; only the tiles between them are still all outside.
  base::runWithThreads(options.threads,
                       [&] { openvdb::tools::signedFloodFill(levelSet->tree(), true, 1, 1); });
  return levelSet;
}

}  // namespace tufa::shapes
