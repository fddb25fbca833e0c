#include "grid/isosurface.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "grid/data_end.h"
#include "grid/non_finite.h"
#include "grid/openvdb_templates.h"
#include "grid/vdb_coord.h"

namespace tufa::grid {
namespace {

/// The samples of a grid around one cell. Corner n is at (n & 1, n >> 1 & 1, n >> 2) from the cell.
struct CellSamples {
  Coord cell;
  std::array<double, 8> values{};  ///< less the isovalue
  unsigned insideMask = 0;         ///< bit n: corner n is inside
  bool isData = false;             ///< all are finite, and the data of a level set do not end here
};

template <class GridT>
class VdbField final : public TrilinearField {
 public:
  VdbField(const GridT& grid, const VoxelFrame& frame, const IsoChoice& iso, const DataEnd& dataEnd)
      : frame_(frame), iso_(iso), dataEnd_(dataEnd), accessor_(grid.getConstAccessor()) {}

  [[nodiscard]] const CellSamples& load(const Coord& cell) {
    if (isLoaded_ && cell == samples_.cell) return samples_;
    isLoaded_ = true;
    samples_.cell = cell;
    samples_.insideMask = 0;
    unsigned active = 0;
    bool finite = true;
    for (int n = 0; n < 8; ++n) {
      typename GridT::ValueType value;
      if (accessor_.probeValue(toVdb(cell.offsetBy(n & 1, (n >> 1) & 1, n >> 2)), value)) {
        active |= 1U << n;
      }
      finite &= std::isfinite(value);
      samples_.values[n] = static_cast<double>(value) - iso_.isovalue;
      if (isInside(static_cast<double>(value), iso_)) samples_.insideMask |= 1U << n;
    }
    samples_.isData = finite && !dataEnd_.isIn(samples_.values, samples_.insideMask, active);
    return samples_;
  }

  /// Value and gradient at a point.
  struct Sample {
    double value;
    Vec3 gradient;
    [[nodiscard]] double slope() const { return gradient.length(); }
  };
  [[nodiscard]] Sample at(const Vec3& point) {
    const Vec3 index = frame_.toIndex(point);
    const Coord cell = floorCoord(index);
    const std::array<double, 8>& v = load(cell).values;
    const double x = index[0] - cell[0];
    const double y = index[1] - cell[1];
    const double z = index[2] - cell[2];
    const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
    const double y0z0 = mix(v[0], v[1], x);
    const double y1z0 = mix(v[2], v[3], x);
    const double y0z1 = mix(v[4], v[5], x);
    const double y1z1 = mix(v[6], v[7], x);
    const double z0 = mix(y0z0, y1z0, y);
    const double z1 = mix(y0z1, y1z1, y);
    const Vec3 gradient(mix(mix(v[1] - v[0], v[3] - v[2], y), mix(v[5] - v[4], v[7] - v[6], y), z),
                        mix(y1z0 - y0z0, y1z1 - y0z1, z), z1 - z0);
    return {mix(z0, z1, z), frame_.gradientFromIndex(gradient)};
  }

  [[nodiscard]] std::optional<Vec3> project(const Vec3& start) override {
    if (!isWithinLattice(start)) return std::nullopt;
    const double tolerance = toleranceAt(start);
    Vec3 point = start;
    Sample sample = at(point);
    for (int step = 0; step < kMostSteps; ++step) {
      if (!samples_.isData) return std::nullopt;
      const double slope = sample.slope();
      // On a plateau at the isovalue every point is a zero and none is the surface.
      if (!(slope > 0)) return std::nullopt;
      if (std::abs(sample.value) <= tolerance * slope) return point;
      const double length = std::min(std::abs(sample.value) / slope, 1.0);
      if (!(length > 0)) return std::nullopt;
      const Vec3 next = point - sample.gradient * (std::copysign(length, sample.value) / slope);
      if ((next - start).length() > kReach) return std::nullopt;
      const Sample ahead = at(next);
      if (std::signbit(ahead.value) != std::signbit(sample.value)) {
        return rootBetween(point, sample.value, next, ahead.value, tolerance);
      }
      point = next;
      sample = ahead;
    }
    return std::nullopt;
  }

  [[nodiscard]] Vec3 direction(const Vec3& point) override {
    const Sample sample = at(point);
    const double slope = sample.slope();
    return slope > 0 ? sample.gradient / slope : Vec3(0);
  }

 private:
  /// Lattice coordinates are 32-bit integers; a mesh may lie anywhere.
  [[nodiscard]] bool isWithinLattice(const Vec3& point) const {
    constexpr double kMost = 2147483000.0;
    const Vec3 index = frame_.toIndex(point);
    return std::abs(index[0]) < kMost && std::abs(index[1]) < kMost && std::abs(index[2]) < kMost;
  }

  static constexpr int kMostSteps = 20;
  static constexpr double kReach = 4;  ///< voxels; farther away the search over samples is better

  /// How near to the surface a point must be, in voxels. Float samples carry no more than the
  /// first; far from the origin there is no double that near.
  [[nodiscard]] static double toleranceAt(const Vec3& point) {
    constexpr double kLeast = 1e-8;
    constexpr double kRoundings = 8 * std::numeric_limits<double>::epsilon();
    return std::max(kLeast, kRoundings * point.length());
  }

  /// A zero on a segment whose ends have different signs: the field is continuous, so the Illinois
  /// variant of false position cannot miss, even where the gradient jumps between cells.
  std::optional<Vec3> rootBetween(Vec3 a, double valueA, Vec3 b, double valueB, double tolerance) {
    for (int step = 0; step < 60; ++step) {
      const Vec3 middle = a + (b - a) * (valueA / (valueA - valueB));
      const Sample sample = at(middle);
      if (!samples_.isData || !std::isfinite(sample.value)) return std::nullopt;
      if (std::abs(sample.value) <= tolerance * sample.slope() ||
          (b - a).squaredLength() < tolerance * tolerance) {
        return middle;
      }
      if (std::signbit(sample.value) == std::signbit(valueB)) {
        valueA /= 2;
      } else {
        a = b;
        valueA = valueB;
      }
      b = middle;
      valueB = sample.value;
    }
    return std::nullopt;
  }

  const VoxelFrame& frame_;
  IsoChoice iso_;
  const DataEnd& dataEnd_;
  typename GridT::ConstAccessor accessor_;
  CellSamples samples_;
  bool isLoaded_ = false;
};

/// Finds the samples of one part of a grid, at most so many. For one thread.
template <class GridT>
class Sampler {
 public:
  Sampler(const GridT& grid, const VoxelFrame& frame, const IsoChoice& iso, const DataEnd& dataEnd,
          std::vector<Vec3>& points, std::size_t most = std::numeric_limits<std::size_t>::max())
      : frame_(frame),
        iso_(iso),
        dataEnd_(dataEnd),
        field_(grid, frame, iso, dataEnd),
        accessor_(grid.getConstAccessor()),
        points_(points),
        most_(most) {}

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
      for (auto voxel = lowest.begin(); voxel; ++voxel) addEdgeBelow(fromVdb(*voxel), axis);
      openvdb::CoordBBox highest = tile;
      highest.min()[axis] = tile.max()[axis];
      for (auto voxel = highest.begin(); voxel; ++voxel) {
        addEdge(fromVdb(*voxel), axis);
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
    typename GridT::ValueType lowerValue, upperValue;
    const bool lowerActive = accessor_.probeValue(toVdb(lower), lowerValue);
    const bool upperActive = accessor_.probeValue(toVdb(upper), upperValue);
    const double a = lowerValue, b = upperValue;
    if (isInside(a, iso_) == isInside(b, iso_)) return;
    if (!std::isfinite(a) || !std::isfinite(b)) return;
    if (dataEnd_.isAt(static_cast<std::size_t>(axis), a, b, lowerActive && upperActive)) return;
    Vec3 index = Vec3(lower);
    index[axis] += (iso_.isovalue - a) / (b - a);
    if (points_.size() >= most_) {
      throw Error(ErrorCode::LimitExceeded,
                  "the surface passes more than " + std::to_string(most_) +
                      " edges of voxels between tiles; resample the grid");
    }
    points_.push_back(frame_.fromIndex(index));
  }

  void addEdgeBelow(const Coord& upper, int axis) {
    const Coord lower = step(upper, axis, -1);
    if (!accessor_.isValueOn(toVdb(lower))) addEdge(lower, axis);
  }

  /// From the mean of the crossings a Newton step or two ends inside the cell, where the trilinear
  /// surface is farthest from what its edges tell.
  void addCell(const CellSamples& samples) {
    if (!samples.isData || samples.insideMask == 0 || samples.insideMask == 0xff) return;
    const Coord cell = samples.cell;
    Vec3 sum(0);
    int crossings = 0;
    for (int n = 0; n < 8; ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const int m = n | 1 << axis;
        if (m == n || (samples.insideMask >> n & 1) == (samples.insideMask >> m & 1)) continue;
        const double a = samples.values[n];
        Vec3 corner(n & 1, (n >> 1) & 1, n >> 2);
        corner[axis] += a / (a - samples.values[m]);
        sum += corner;
        ++crossings;
      }
    }
    const Vec3 start = Vec3(cell) + sum / crossings;
    const std::optional<Vec3> found = field_.project(frame_.fromIndex(start));
    if (!found) return;
    const Vec3 offset = frame_.toIndex(*found) - Vec3(cell);
    for (int axis = 0; axis < 3; ++axis) {
      // Points that ran into the next cell are left to that one.
      if (offset[axis] < 0 || offset[axis] > 1) return;
    }
    points_.push_back(*found);
  }

  const VoxelFrame& frame_;
  const IsoChoice& iso_;
  const DataEnd& dataEnd_;
  VdbField<GridT> field_;
  typename GridT::ConstAccessor accessor_;
  std::vector<Vec3>& points_;
  std::size_t most_;
};

/// Calls body(tile's box) for each active tile of the tree.
template <class TreeT, class Body>
void forActiveTiles(const TreeT& tree, const Body& body) {
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) body(tile.getBoundingBox());
}

template <class GridT>
class VdbIsosurface final : public Isosurface {
 public:
  VdbIsosurface(const GridT& grid, const VoxelFrame& frame, const IsoChoice& iso)
      : grid_(grid), frame_(frame), iso_(iso), dataEnd_(readFieldScale(grid, iso)) {
    requireFiniteBackground(grid.getName(), static_cast<double>(grid.background()));
  }

  [[nodiscard]] std::vector<Vec3> samples(base::Job& job) const override {
    constexpr std::size_t kGrain = 64;
    std::vector<const typename GridT::TreeType::LeafNodeType*> leaves;
    grid_.tree().getNodes(leaves);
    std::vector<std::vector<Vec3>> parts((leaves.size() + kGrain - 1) / kGrain + 1);
    job.forRanges(parts.size() - 1, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t part = first; part < last; ++part) {
        Sampler<GridT> sampler(grid_, frame_, iso_, dataEnd_, parts[part]);
        const std::size_t end = std::min((part + 1) * kGrain, leaves.size());
        for (std::size_t i = part * kGrain; i < end; ++i) {
          for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel) {
            sampler.addVoxel(fromVdb(voxel.getCoord()));
          }
        }
      }
    });
    // A tile is a few bytes, and its faces may be millions: no more than contour() takes.
    constexpr std::size_t kMostAtTiles = std::size_t{1} << 25;
    Sampler<GridT> tiles(grid_, frame_, iso_, dataEnd_, parts.back(), kMostAtTiles);
    forActiveTiles(grid_.tree(), [&](const openvdb::CoordBBox& tile) { tiles.addTile(tile); });

    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    std::vector<Vec3> points;
    points.reserve(count);
    for (auto& part : parts) {
      points.insert(points.end(), part.begin(), part.end());
      part = {};
    }
    return points;
  }

  [[nodiscard]] std::unique_ptr<TrilinearField> field() const override {
    return std::make_unique<VdbField<GridT>>(grid_, frame_, iso_, dataEnd_);
  }

 private:
  const GridT& grid_;
  const VoxelFrame& frame_;
  const IsoChoice& iso_;
  DataEnd dataEnd_;
};

}  // namespace

std::unique_ptr<const Isosurface> isosurfaceOf(const openvdb::GridBase& grid,
                                               const VoxelFrame& frame, const IsoChoice& iso) {
  if (grid.isType<openvdb::FloatGrid>()) {
    return std::make_unique<VdbIsosurface<openvdb::FloatGrid>>(
        static_cast<const openvdb::FloatGrid&>(grid), frame, iso);
  }
  return std::make_unique<VdbIsosurface<openvdb::DoubleGrid>>(
      static_cast<const openvdb::DoubleGrid&>(grid), frame, iso);
}

}  // namespace tufa::grid
