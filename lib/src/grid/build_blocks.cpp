#include "grid/build_blocks.h"

#include <tufa/error.h>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/number_text.h"

namespace tufa::grid {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

/// Side of the cubes that one task fills: small enough to share the work evenly, large enough that
/// the culling above it costs nothing.
constexpr int kTaskSide = 64;

/// A cube of voxels, and what gives its values.
struct Cube {
  openvdb::Coord origin;
  std::shared_ptr<const BlockSource> source;
};

/// Not owned: it outlives all cubes.
std::shared_ptr<const BlockSource> borrowed(const BlockSource& source) {
  return {std::shared_ptr<const BlockSource>(), &source};
}

/// Calls visit(cube) for all cubes of the least side in one that may hold active values.
template <class Visit>
void forCubes(Cube cube, int side, int leastSide, const Visit& visit) {
  if (!cube.source->mayBeActive(cube.origin, side)) return;
  if (cube.source->narrowed) {
    if (auto narrowed = cube.source->narrowed(cube.origin, side)) cube.source = std::move(narrowed);
  }
  if (side == leastSide) {
    visit(cube);
    return;
  }
  const int half = side / 2;
  for (int child = 0; child < 8; ++child) {
    const openvdb::Coord offset((child >> 2) * half, ((child >> 1) & 1) * half, (child & 1) * half);
    forCubes({cube.origin + offset, cube.source}, half, leastSide, visit);
  }
}

std::vector<Cube> collectTasks(const BlockSource& source) {
  std::int64_t side = kTaskSide;
  while (side < source.halfExtentVoxels) side *= 2;
  const int root = static_cast<int>(side);
  std::vector<Cube> tasks;
  const auto add = [&](const Cube& cube) {
    if (tasks.size() >= source.mostCubes) {
      throw Error(ErrorCode::LimitExceeded,
                  "the surface may pass through more than " + std::to_string(source.mostCubes) +
                      " cubes of " + std::to_string(kTaskSide) +
                      " voxels a side; take larger voxels or smaller bounds, or raise the limit "
                      "(VoxelizeOptions::bandVoxels)");
    }
    tasks.push_back(cube);
  };
  for (int octant = 0; octant < 8; ++octant) {
    const openvdb::Coord origin((octant >> 2) ? 0 : -root, ((octant >> 1) & 1) ? 0 : -root,
                                (octant & 1) ? 0 : -root);
    forCubes({origin, borrowed(source)}, root, kTaskSide, add);
  }
  return tasks;
}

std::vector<std::unique_ptr<FloatLeaf>> fillTask(const Cube& task, float background) {
  std::vector<std::unique_ptr<FloatLeaf>> leaves;
  auto leaf = std::make_unique<FloatLeaf>(task.origin, background);
  forCubes(task, kTaskSide, static_cast<int>(FloatLeaf::DIM), [&](const Cube& cube) {
    leaf->setOrigin(cube.origin);
    cube.source->fill(*leaf);
    if (leaf->isEmpty()) return;
    leaves.push_back(std::move(leaf));
    leaf = std::make_unique<FloatLeaf>(task.origin, background);
  });
  return leaves;
}

}  // namespace

void buildBlocks(openvdb::FloatTree& tree, const BlockSource& source, base::Job& job) {
  const std::vector<Cube> tasks = collectTasks(source);
  std::vector<std::vector<std::unique_ptr<FloatLeaf>>> filled(tasks.size());
  job.run([&] {
    job.forRanges(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        filled[n] = fillTask(tasks[n], tree.background());
      }
    });
  });
  for (auto& leaves : filled) {
    for (auto& leaf : leaves) tree.addLeaf(leaf.release());
  }
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

}  // namespace tufa::grid
