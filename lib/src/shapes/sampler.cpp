#include "shapes/sampler.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/job.h"
#include "base/number_text.h"

namespace tufa::shapes {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// Side of the cubes that one task fills: small enough to share the work evenly, large enough that
/// the culling above it costs nothing.
constexpr int kTaskSide = 64;

void collectCubes(const BlockSource& source, const openvdb::Coord& origin, int side, int leastSide,
                  std::vector<openvdb::Coord>& cubes) {
  if (!source.mayBeActive(origin, side)) return;
  if (side == leastSide) {
    cubes.push_back(origin);
    return;
  }
  const int half = side / 2;
  for (int child = 0; child < 8; ++child) {
    const openvdb::Coord offset((child >> 2) * half, ((child >> 1) & 1) * half, (child & 1) * half);
    collectCubes(source, origin + offset, half, leastSide, cubes);
  }
}

std::vector<openvdb::Coord> collectTasks(const BlockSource& source) {
  std::int64_t side = kTaskSide;
  while (side < source.halfExtentVoxels) side *= 2;
  const int root = static_cast<int>(side);
  std::vector<openvdb::Coord> tasks;
  for (int octant = 0; octant < 8; ++octant) {
    const openvdb::Coord origin((octant >> 2) ? 0 : -root, ((octant >> 1) & 1) ? 0 : -root,
                                (octant & 1) ? 0 : -root);
    collectCubes(source, origin, root, kTaskSide, tasks);
  }
  return tasks;
}

std::vector<std::unique_ptr<Leaf>> fillTask(const BlockSource& source, const openvdb::Coord& task,
                                            float background) {
  std::vector<openvdb::Coord> origins;
  collectCubes(source, task, kTaskSide, BlockLattice::kSide, origins);
  std::vector<std::unique_ptr<Leaf>> leaves;
  auto leaf = std::make_unique<Leaf>(task, background);
  for (const openvdb::Coord& origin : origins) {
    leaf->setOrigin(origin);
    source.fill(*leaf);
    if (leaf->isEmpty()) continue;
    leaves.push_back(std::move(leaf));
    leaf = std::make_unique<Leaf>(task, background);
  }
  return leaves;
}

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

void buildBlocks(openvdb::FloatTree& tree, const BlockSource& source, const ShapeOptions& options) {
  base::Job job(options.threads, options.progress);
  job.beginStage("sampling", 1);
  const std::vector<openvdb::Coord> tasks = collectTasks(source);
  std::vector<std::vector<std::unique_ptr<Leaf>>> filled(tasks.size());
  job.run([&] {
    job.forRanges(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        filled[n] = fillTask(source, tasks[n], tree.background());
      }
    });
  });
  for (auto& leaves : filled) {
    for (auto& leaf : leaves) tree.addLeaf(leaf.release());
  }
  job.finish();
}

int extentInVoxels(double worldLength, double voxelSize, double margin) {
  // Trees are walked in powers of two from the origin; a quarter of the range keeps all sums in it.
  constexpr double kLimit = 1 << 29;
  const double voxels = std::ceil(worldLength / voxelSize + margin) + 1;
  if (!(voxels < kLimit)) {
    throw Error(ErrorCode::InvalidArgument,
                "voxel size " + base::numberText(voxelSize) +
                    " is too small: the grid's coordinates would overflow");
  }
  return static_cast<int>(voxels);
}

openvdb::FloatGrid::Ptr sampleLevelSet(const DistanceField& field, const ShapeOptions& options) {
  const double voxelSize = options.voxelSize;
  const double band = options.halfWidth * voxelSize;
  BlockSource source;
  // First of all: it refuses voxel sizes that OpenVDB would not take for a transform.
  source.halfExtentVoxels = extentInVoxels(field.halfExtent(), voxelSize, options.halfWidth);
  auto grid = openvdb::FloatGrid::create(static_cast<float>(band));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxelSize));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  source.mayBeActive = [&](const openvdb::Coord& origin, int side) {
    // The samples of a cube fill it but for its last layer.
    const double half = 0.5 * (side - 1);
    const Vec3 center = (origin.asVec3d() + Vec3(half)) * voxelSize;
    const ValueRange range = field.range(center, std::sqrt(3.0) * half * voxelSize);
    return range.least < band && range.greatest > -band;
  };
  source.fill = [&](Leaf& leaf) { fillLeaf(field, voxelSize, band, leaf); };
  buildBlocks(grid->tree(), source, options);

  // Leaves already hold the right signs; only the tiles between them are still all outside.
  base::runWithThreads(options.threads,
                       [&] { openvdb::tools::signedFloodFill(grid->tree(), true, 1, 1); });
  return grid;
}

}  // namespace tufa::shapes
