#include "check/iso_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "check/trilinear.h"

namespace tufa::checks {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

/// Finds the samples of one part of a grid. For one thread.
template <class GridT>
class Sampler {
 public:
  Sampler(const GridT& grid, const Frame& frame, const blocks::IsoChoice& iso,
          std::vector<Vec3d>& points)
      : frame_(frame),
        iso_(iso),
        narrowBand_(grid.getGridClass() == openvdb::GRID_LEVEL_SET),
        field_(grid, frame, iso),
        accessor_(grid.getConstAccessor()),
        points_(points) {}

  /// The samples of an active voxel: of the cell that it is the lowest corner of, of the three
  /// edges that start there, and of those that end there and that no active voxel owns.
  void addVoxel(const Coord& voxel) {
    for (int axis = 0; axis < 3; ++axis) {
      addEdge(voxel, axis);
      addEdgeBelow(voxel, axis);
    }
    addCell(field_.load(voxel));
  }

  /// The edges that leave a tile of active voxels. (Those inside it are not crossed.)
  void addTile(const openvdb::CoordBBox& tile) {
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::CoordBBox lowest = tile;
      lowest.max()[axis] = tile.min()[axis];
      for (auto voxel = lowest.begin(); voxel; ++voxel) addEdgeBelow(*voxel, axis);
      openvdb::CoordBBox highest = tile;
      highest.min()[axis] = tile.max()[axis];
      for (auto voxel = highest.begin(); voxel; ++voxel) {
        addEdge(*voxel, axis);
      }
    }
  }

 private:
  static Coord step(const Coord& voxel, int axis, int by) {
    Coord neighbour = voxel;
    neighbour[axis] += by;
    return neighbour;
  }

  void addEdge(const Coord& lower, int axis) {
    const Coord upper = step(lower, axis, 1);
    if (narrowBand_ && !(accessor_.isValueOn(lower) && accessor_.isValueOn(upper))) return;
    const double a = accessor_.getValue(lower);
    const double b = accessor_.getValue(upper);
    if (blocks::isInside(a, iso_) == blocks::isInside(b, iso_)) return;
    if (!std::isfinite(a) || !std::isfinite(b)) return;
    Vec3d index = lower.asVec3d();
    index[axis] += (iso_.isovalue - a) / (b - a);
    points_.push_back(frame_.fromIndex(index));
  }

  void addEdgeBelow(const Coord& upper, int axis) {
    const Coord lower = step(upper, axis, -1);
    if (!accessor_.isValueOn(lower)) addEdge(lower, axis);
  }

  /// From the mean of the crossings a Newton step or two ends inside the cell, where the trilinear
  /// surface is furthest from what its edges tell.
  void addCell(const CellSamples& samples) {
    if (!samples.isData || samples.insideMask == 0 || samples.insideMask == 0xff) return;
    const Coord cell = samples.cell;
    Vec3d sum(0);
    int crossings = 0;
    for (int n = 0; n < 8; ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const int m = n | 1 << axis;
        if (m == n || (samples.insideMask >> n & 1) == (samples.insideMask >> m & 1)) continue;
        const double a = samples.values[n];
        Vec3d corner(n & 1, (n >> 1) & 1, n >> 2);
        corner[axis] += a / (a - samples.values[m]);
        sum += corner;
        ++crossings;
      }
    }
    const Vec3d start = cell.asVec3d() + sum / crossings;
    const std::optional<Vec3d> found = field_.project(frame_.fromIndex(start));
    if (!found) return;
    const Vec3d offset = frame_.toIndex(*found) - cell.asVec3d();
    for (int axis = 0; axis < 3; ++axis) {
      // Points that ran into the next cell are left to that one.
      if (offset[axis] < 0 || offset[axis] > 1) return;
    }
    points_.push_back(*found);
  }

  const Frame& frame_;
  const blocks::IsoChoice& iso_;
  bool narrowBand_;
  TrilinearField<GridT> field_;
  typename GridT::ConstAccessor accessor_;
  std::vector<Vec3d>& points_;
};

/// Calls body(tile's box) for each active tile of the tree.
template <class TreeT, class Body>
void forActiveTiles(const TreeT& tree, const Body& body) {
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) body(tile.getBoundingBox());
}

}  // namespace

template <class GridT>
std::vector<Vec3d> sampleIsosurface(const GridT& grid, const Frame& frame,
                                    const blocks::IsoChoice& iso, base::Job& job) {
  constexpr std::size_t kGrain = 64;
  std::vector<const typename GridT::TreeType::LeafNodeType*> leaves;
  grid.tree().getNodes(leaves);
  std::vector<std::vector<Vec3d>> parts((leaves.size() + kGrain - 1) / kGrain + 1);
  job.forRanges(parts.size() - 1, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part) {
      Sampler<GridT> sampler(grid, frame, iso, parts[part]);
      const std::size_t end = std::min((part + 1) * kGrain, leaves.size());
      for (std::size_t i = part * kGrain; i < end; ++i) {
        for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel) {
          sampler.addVoxel(voxel.getCoord());
        }
      }
    }
  });
  Sampler<GridT> tiles(grid, frame, iso, parts.back());
  forActiveTiles(grid.tree(), [&](const openvdb::CoordBBox& tile) { tiles.addTile(tile); });

  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  std::vector<Vec3d> points;
  points.reserve(count);
  for (auto& part : parts) {
    points.insert(points.end(), part.begin(), part.end());
    part = {};
  }
  return points;
}

template std::vector<Vec3d> sampleIsosurface(const openvdb::FloatGrid&, const Frame&,
                                             const blocks::IsoChoice&, base::Job&);
template std::vector<Vec3d> sampleIsosurface(const openvdb::DoubleGrid&, const Frame&,
                                             const blocks::IsoChoice&, base::Job&);

}  // namespace tufa::checks
