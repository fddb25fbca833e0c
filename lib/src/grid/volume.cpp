#include "grid/volume.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>

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
    throw Error(ErrorCode::UnsupportedGrid, "grid \"" + grid.getName() +
                                                "\" holds values of type " + grid.valueType() +
                                                "; only float and double grids have an isosurface");
  }
}

void requireRange(const openvdb::GridBase& grid) {
  const std::string why = base::whyOutOfRange(transformOf(grid).lattice());
  if (why.empty()) return;
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" cannot be meshed: " + why);
}

void requireCoordinates(const openvdb::GridBase& grid) {
  // Cells and nodes of the tree reach that far beyond the data at most.
  constexpr std::int64_t kMargin = 4096;
  constexpr std::int64_t kEnd = std::int64_t{1} << 31;
  openvdb::CoordBBox box;
  if (!grid.constBaseTree().evalLeafBoundingBox(box)) return;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.min()[axis] >= kMargin - kEnd && box.max()[axis] < kEnd - kMargin) continue;
    throw Error(ErrorCode::LimitExceeded,
                "grid \"" + grid.getName() + "\" has coordinates from " +
                    std::to_string(box.min()[axis]) + " to " + std::to_string(box.max()[axis]) +
                    ", too near to the ends of 32-bit integers; move it towards the origin");
  }
}

void requireFewTileFaces(std::uint64_t faces, const ContourOptions& options,
                         const std::string& name) {
  if (faces <= options.tileFaces) return;
  throw Error(ErrorCode::LimitExceeded,
              "grid \"" + name + "\" has about " + std::to_string(faces) +
                  " faces of voxels on its surface between tiles, more than " +
                  std::to_string(options.tileFaces) +
                  "; resample it, or raise the limit (--tile-faces) if there is memory for " +
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

}  // namespace

void requireMeshable(const openvdb::GridBase& grid) {
  requireScalar(grid);
  requireRange(grid);
  requireCoordinates(grid);
}

std::string nameOf(const openvdb::GridBase& grid) { return grid.getName(); }

Volume openVolume(const openvdb::GridBase& grid, const ContourOptions& options, base::Job& job) {
  const IsoChoice iso = chooseIsovalue(grid, options.isovalue, options.inside);
  const std::shared_ptr<const Tree> tree = treeOf(grid, job);
  requireFewTileFaces(tree->tileSurface(iso, job), options, grid.getName());
  Blocks blocks(tree, iso, options.nonFinite, job);
  const FieldScale scale = readFieldScale(grid, iso);
  const Transform transform = transformOf(grid);
  const Affine affine(transform, lowestOrigin(blocks));
  return {std::move(blocks), scale, transform, affine};
}

Volume partOf(const Volume& whole, const base::IndexBox& box) {
  return {Blocks(whole.blocks, box), whole.scale, whole.transform, whole.affine};
}

}  // namespace tufa::grid
