#include "grid/volume.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tufa::grid {
namespace {

void requireScalar(const openvdb::GridBase& grid) {
  if (!grid.transform().isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" has a " + grid.transform().mapType() +
                    " transform; only linear ones can be meshed; resample the grid first");
  }
  if (!grid.isType<openvdb::FloatGrid>() && !grid.isType<openvdb::DoubleGrid>()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" holds values of type " + grid.valueType() +
                    "; only float and double grids of OpenVDB's standard tree have an isosurface");
  }
}

void requireRange(const openvdb::GridBase& grid) {
  const std::string why = base::whyOutOfRange(transformOf(grid).lattice());
  if (why.empty()) return;
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" cannot be meshed: " + why);
}

// Cells and nodes of the tree reach that far beyond the data at most: as far as the root's children
// and tiles are wide. Tiles that are not active count, too, as they may be inside.
constexpr std::int64_t kCoordinateMargin = 4096;

template <class Iterator>
void addRootItems(Iterator item, openvdb::CoordBBox& box) {
  for (; item; ++item) box.expand(item.getCoord());
}

template <class GridT>
openvdb::CoordBBox rootOrigins(const openvdb::GridBase& grid) {
  static_assert(GridT::TreeType::RootNodeType::ChildNodeType::DIM == kCoordinateMargin);
  const auto& root = static_cast<const GridT&>(grid).tree().root();
  openvdb::CoordBBox box;
  addRootItems(root.cbeginChildOn(), box);
  for (auto tile = root.cbeginValueAll(); tile; ++tile) {
    if (tile.isValueOn() || *tile != root.background()) box.expand(tile.getCoord());
  }
  return box;
}

// The grid must be of float or double.
void requireCoordinates(const openvdb::GridBase& grid) {
  constexpr std::int64_t kEnd = std::int64_t{1} << 31;
  const openvdb::CoordBBox box = grid.isType<openvdb::FloatGrid>()
                                     ? rootOrigins<openvdb::FloatGrid>(grid)
                                     : rootOrigins<openvdb::DoubleGrid>(grid);
  if (box.empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t least = box.min()[axis], most = box.max()[axis] + kCoordinateMargin - 1;
    if (least >= kCoordinateMargin - kEnd && most < kEnd - kCoordinateMargin) continue;
    throw Error(ErrorCode::LimitExceeded,
                "grid \"" + grid.getName() + "\" has coordinates from about " +
                    std::to_string(least) + " to " + std::to_string(most) +
                    ", too near to the ends of 32-bit integers; move it towards the origin");
  }
}

void requireFewTileFaces(const Tree& tree, const IsoChoice& iso, std::uint64_t most,
                         const std::string& name, base::Job& job) {
  const std::uint64_t faces = tree.tileSurface(iso, job);
  if (faces <= most) return;
  throw Error(
      ErrorCode::LimitExceeded,
      "grid \"" + name + "\" has about " + std::to_string(faces) +
          " faces of voxels on its surface between tiles, more than " + std::to_string(most) +
          "; resample it, or raise the limit (ContourOptions::tileFaces) if there is memory for " +
          std::to_string(faces / 5'000'000 + 1) + " GB");
}

// A grid that is moved by whole blocks keeps its surface in the same place beside this.
Coord lowestOrigin(const Blocks& blocks) {
  if (blocks.count() == 0) return Coord(0);
  Coord lowest = blocks.origin(0);
  for (std::size_t i = 1; i < blocks.count(); ++i) {
    lowest = minCoord(lowest, blocks.origin(static_cast<BlockRef>(i)));
  }
  return lowest;
}

double largestCoordinate(const Blocks& blocks, const Transform& transform) {
  double largest = 0;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const Vec3 corner(blocks.origin(static_cast<BlockRef>(i)));
    for (int c = 0; c < 8; ++c) {
      const Vec3 step((c & 4) * 2.0, (c & 2) * 4.0, (c & 1) * 8.0);
      const Vec3 world = transform.indexToWorld(corner + step);
      largest = std::max({largest, std::abs(world[0]), std::abs(world[1]), std::abs(world[2])});
    }
  }
  return largest;
}

}  // namespace

void requireMeshable(const openvdb::GridBase& grid) {
  requireScalar(grid);
  requireRange(grid);
  requireCoordinates(grid);
}

std::string nameOf(const openvdb::GridBase& grid) { return grid.getName(); }

Volume openVolume(const StoredGrid& stored, const ContourOptions& options, base::Job& job) {
  const openvdb::GridBase& grid = stored.grid;
  const IsoChoice iso = chooseIsovalue(stored, options.isovalue, options.inside);
  const std::shared_ptr<const Tree> tree = treeOf(stored, job);
  requireFewTileFaces(*tree, iso, options.tileFaces, grid.getName(), job);
  Blocks blocks(tree, iso, options.nonFinite, job);
  const FieldScale scale = readFieldScale(stored, iso);
  const Transform transform = transformOf(grid);
  const Affine affine(transform, lowestOrigin(blocks));
  const double reach = largestCoordinate(blocks, transform);
  return {std::move(blocks), scale, transform, affine, reach, {}};
}

void load(Volume& volume, base::Job& job) { volume.blocks.load(job); }

Volume partOf(const Volume& whole, const Slab& slab, const Slab& own, base::Job& job) {
  return {Blocks(whole.blocks, slab, job),
          whole.scale,
          whole.transform,
          whole.affine,
          whole.reach,
          own};
}

}  // namespace tufa::grid
