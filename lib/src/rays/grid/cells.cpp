#include "rays/grid/cells.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/box_ray.h"
#include "base/bvh.h"
#include "grid/data_end.h"
#include "grid/non_finite.h"
#include "grid/openvdb_templates.h"
#include "grid/tree.h"
#include "grid/volume.h"
#include "rays/grid/grid_caster.h"
#include "rays/surface.h"

namespace tufa::rays {
namespace {

/// The box around the cells of a block that the surface passes, in index space; empty if none.
base::Box crossedCells(const grid::Blocks& blocks, grid::BlockRef block, grid::Accessor& accessor) {
  const grid::CornerWords corners = blocks.cornerWords(blocks.upperNeighbours(block, accessor));
  const Coord& origin = blocks.origin(block);
  base::Box box = base::Box::empty();
  for (int x = 0; x < grid::kBlockSize; ++x) {
    std::uint64_t all = ~std::uint64_t{0};
    std::uint64_t any = 0;
    for (int dx = 0; dx < 2; ++dx) {
      for (const std::uint64_t word : corners.words[static_cast<std::size_t>(x + dx)]) {
        all &= word;
        any |= word;
      }
    }
    for (int cell = 0; cell < 64; ++cell) {
      if (((any & ~all) >> cell & 1) == 0) continue;
      const Vec3 least = Vec3(origin) + Vec3(x, cell / 8, cell % 8);
      box.add(least);
      box.add(least + Vec3(1.0));
    }
  }
  return box;
}

/// The boxes of all blocks, in index space.
std::vector<base::Box> crossedBoxes(const grid::Blocks& blocks, base::Job& job) {
  std::vector<base::Box> boxes(blocks.count());
  constexpr std::size_t kGrain = 64;
  job.forRanges(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const auto accessor = blocks.accessor();
    for (std::size_t n = begin; n < end; ++n) {
      boxes[n] = crossedCells(blocks, static_cast<grid::BlockRef>(n), *accessor);
    }
  });
  std::erase_if(boxes, [](const base::Box& box) { return box.isEmpty(); });
  return boxes;
}

base::Box inWorld(const std::vector<base::Box>& boxes, const grid::Transform& transform) {
  base::Box all = base::Box::empty();
  for (const base::Box& box : boxes) {
    for (int corner = 0; corner < 8; ++corner) {
      all.add(transform.indexToWorld({((corner & 1) != 0 ? box.upper : box.lower)[0],
                                      ((corner & 2) != 0 ? box.upper : box.lower)[1],
                                      ((corner & 4) != 0 ? box.upper : box.lower)[2]}));
    }
  }
  return all;
}

template <class GridT>
class CellSurface final : public RaySurface {
 public:
  CellSurface(std::shared_ptr<const GridT> grid, const grid::IsoChoice& iso,
              const grid::DataEnd& dataEnd, const std::vector<base::Box>& boxes, base::Job& job)
      : RaySurface(inWorld(boxes, grid::transformOf(*grid)),
                   0.5 * grid::Affine(grid::transformOf(*grid)).leastHeight()),
        grid_(std::move(grid)),
        iso_(iso),
        dataEnd_(dataEnd),
        transform_(grid::transformOf(*grid_)),
        affine_(transform_),
        boxes_(boxes),
        tree_(boxes, job) {}

  [[nodiscard]] std::unique_ptr<Caster> caster() const override;
  [[nodiscard]] const GridT& grid() const { return *grid_; }
  [[nodiscard]] const grid::IsoChoice& iso() const { return iso_; }
  [[nodiscard]] const grid::DataEnd& dataEnd() const { return dataEnd_; }
  [[nodiscard]] const grid::Transform& transform() const { return transform_; }
  [[nodiscard]] const grid::Affine& affine() const { return affine_; }
  [[nodiscard]] const base::Box& box(std::size_t n) const { return boxes_[n]; }
  [[nodiscard]] const base::Bvh& tree() const { return tree_; }

 private:
  std::shared_ptr<const GridT> grid_;
  grid::IsoChoice iso_;
  grid::DataEnd dataEnd_;
  grid::Transform transform_;
  grid::Affine affine_;
  std::vector<base::Box> boxes_;  ///< of crossed cells, in index space
  base::Bvh tree_;
};

/// A ray in index space: distances along it are those of the world.
struct IndexRay {
  Vec3 origin;
  Vec3 direction;
  [[nodiscard]] Vec3 at(double t) const { return origin + direction * t; }
};

template <class GridT>
class CellCaster final : public Caster {
 public:
  explicit CellCaster(const CellSurface<GridT>& surface)
      : surface_(surface), values_(surface.grid()) {}

  [[nodiscard]] std::optional<RayHit> cast(const UnitRay& ray) override {
    const grid::Transform& transform = surface_.transform();
    const Vec3 origin = transform.worldToIndex(ray.origin);
    const IndexRay indexRay{origin, transform.worldToIndex(ray.origin + ray.direction) - origin};
    double to = ray.greatest;
    bool found = false;
    const base::BoxRay boxRay(origin, indexRay.direction, ray.least);
    surface_.tree().itemsAlong(boxRay, to, [&](std::uint32_t n) {
      const auto [begin, end] = boxRay.span(surface_.box(n), to);
      if (!(begin <= end)) return;
      if (const auto crossing = firstIn(indexRay, surface_.box(n), begin, end)) {
        to = *crossing;
        found = true;
      }
    });
    if (!found) return std::nullopt;
    return RayHit{
        to, ray.at(to),
        normalAt(values_, surface_.affine(), indexRay.at(to), surface_.iso().insideIsBelow)};
  }

 private:
  /// The first crossing in a box of cells, by a walk from cell to cell (Amanatides and Woo 1987).
  [[nodiscard]] std::optional<double> firstIn(const IndexRay& ray, const base::Box& box,
                                              double begin, double end) const {
    const Vec3 start = ray.at(begin);
    openvdb::Coord cell;
    Vec3 next(0.0);  // where the ray leaves the cell, along each axis
    Vec3 step(0.0);  // from one side of cells to the next
    for (int axis = 0; axis < 3; ++axis) {
      const double last = box.upper[axis] - 1;
      const double at = std::clamp(std::floor(start[axis]), box.lower[axis], last);
      cell[axis] = static_cast<int>(at);
      const double d = ray.direction[axis];
      const double side = d > 0 ? at + 1 : at;
      next[axis] = d != 0 ? (side - ray.origin[axis]) / d : std::numeric_limits<double>::infinity();
      step[axis] = std::abs(1 / d);
    }
    double from = begin;
    while (from <= end) {
      const std::size_t axis = next[0] <= next[1] && next[0] <= next[2] ? 0
                               : next[1] <= next[2]                     ? 1
                                                                        : 2;
      const double to = std::min(next[axis], end);
      if (const auto crossing = inCell(ray, cell, from, std::max(from, to))) return crossing;
      cell[static_cast<int>(axis)] += ray.direction[axis] > 0 ? 1 : -1;
      const int at = cell[static_cast<int>(axis)];
      if (at < box.lower[axis] || at >= box.upper[axis]) return std::nullopt;
      from = std::max(from, next[axis]);
      next[axis] += step[axis];
    }
    return std::nullopt;
  }

  /// The interpolant is a cubic along the ray: between the places where its slope is 0 it crosses
  /// the isovalue at most once. What is at the isovalue is outside, as samples there are, and so is
  /// what rounding may have made of it.
  [[nodiscard]] std::optional<double> inCell(const IndexRay& ray, const openvdb::Coord& cell,
                                             double begin, double end) const {
    const auto corners = values_.corners(cell);
    const grid::IsoChoice& iso = surface_.iso();
    unsigned inside = 0;
    double farthest = 0;
    for (int n = 0; n < 8; ++n) {
      inside |= grid::isInside(corners[n], iso) ? 1U << n : 0;
      farthest = std::max(farthest, std::abs(corners[n] - iso.isovalue));
    }
    if (inside == 0 || inside == 0xFF || dataEndsIn(cell, corners, inside)) return std::nullopt;
    const Vec3 base(cell.x(), cell.y(), cell.z());
    const auto value = [&](double t) {
      return Interpolant<GridT>::mixed(corners, ray.at(t) - base) - iso.isovalue;
    };
    const auto isInside = [&, rounding = kRounding * farthest](double t) {
      return (iso.insideIsBelow ? -value(t) : value(t)) > rounding;
    };
    const double length = end - begin;
    const std::array<double, 2> flat = flatPlaces(
        {value(begin), value(begin + length / 3), value(begin + 2 * length / 3), value(end)});
    double a = begin;
    for (const double share : {flat[0], flat[1], 1.0}) {
      const double b = begin + share * length;
      if (isInside(a) != isInside(b)) return between(isInside, a, b);
      a = b;
    }
    return std::nullopt;
  }

  [[nodiscard]] bool dataEndsIn(const openvdb::Coord& cell, const std::array<double, 8>& corners,
                                unsigned inside) const {
    if (!surface_.dataEnd().exists()) return false;
    unsigned active = 0;
    for (int n = 0; n < 8; ++n) {
      active |= values_.isActive(cell.offsetBy(n & 1, n >> 1 & 1, n >> 2)) ? 1U << n : 0;
    }
    return surface_.dataEnd().isIn(corners, inside, active);
  }

  /// Where the slope of the cubic through values at 0, 1/3, 2/3 and 1 is 0, in order; 0 or 1 where
  /// that is beyond.
  static std::array<double, 2> flatPlaces(const std::array<double, 4>& v) {
    const double c3 = 4.5 * (v[3] - 3 * v[2] + 3 * v[1] - v[0]);
    const double c2 = 4.5 * (2 * v[0] - 5 * v[1] + 4 * v[2] - v[3]);
    const double c1 = 0.5 * (-11 * v[0] + 18 * v[1] - 9 * v[2] + 2 * v[3]);
    // Of 3 c3 t² + 2 c2 t + c1; q keeps the digits where terms cancel.
    const double discriminant = c2 * c2 - 3 * c3 * c1;
    if (!(discriminant > 0)) return {0, 0};
    const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
    const auto clamped = [](double t) { return t > 0 && t < 1 ? t : 0; };
    const double first = clamped(q / (3 * c3));
    const double second = clamped(c1 / q);
    return {std::min(first, second), std::max(first, second)};
  }

  template <class Predicate>
  static double between(const Predicate& isInside, double a, double b) {
    constexpr int kHalvings = 50;
    const bool first = isInside(a);
    for (int n = 0; n < kHalvings; ++n) {
      const double middle = (a + b) / 2;
      (isInside(middle) == first ? a : b) = middle;
    }
    return b;
  }

  // What rounding makes of interpolated values, beside the farthest of a cell's samples from the
  // isovalue.
  static constexpr double kRounding = 1e-9;

  const CellSurface<GridT>& surface_;
  Interpolant<GridT> values_;
};

template <class GridT>
std::unique_ptr<Caster> CellSurface<GridT>::caster() const {
  return std::make_unique<CellCaster<GridT>>(*this);
}

}  // namespace

std::shared_ptr<const RaySurface> makeCellSurface(std::shared_ptr<const openvdb::GridBase> grid,
                                                  const RaySurfaceOptions& options,
                                                  base::Job& job) {
  ContourOptions contour;
  contour.isovalue = options.isovalue;
  contour.inside = options.inside;
  std::vector<base::Box> boxes;
  grid::FieldScale scale;
  grid::IsoChoice iso;
  {
    const grid::Volume volume = grid::openVolume(*grid, contour, job);
    iso = volume.blocks.iso();
    scale = volume.scale;
    boxes = crossedBoxes(volume.blocks, job);
  }
  const grid::DataEnd end(scale);
  if (auto floats = openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid)) {
    return std::make_shared<CellSurface<openvdb::FloatGrid>>(std::move(floats), iso, end, boxes,
                                                             job);
  }
  return std::make_shared<CellSurface<openvdb::DoubleGrid>>(
      openvdb::gridConstPtrCast<openvdb::DoubleGrid>(grid), iso, end, boxes, job);
}

}  // namespace tufa::rays

namespace tufa {
namespace {

/// Throws Error(NonFiniteValues) as contour() does.
void requireFiniteValues(const openvdb::GridBase& grid, const RaySurfaceOptions& options,
                         base::Job& job) {
  const std::shared_ptr<const grid::Tree> tree = grid::treeOf(grid, job);
  std::vector<grid::BlockBits> sides(tree->leafCount());
  const grid::Tree::Summary summary =
      tree->readSides(grid::chooseIsovalue(grid, options.isovalue, options.inside), sides, job);
  if (summary.nonFiniteValues > 0) {
    grid::refuseNonFinite(grid.getName(), summary.nonFiniteValues, summary.firstNonFinite);
  }
}

}  // namespace

std::shared_ptr<const RaySurface> makeRaySurface(std::shared_ptr<const openvdb::GridBase> grid,
                                                 const RaySurfaceOptions& options) {
  if (!grid) throw Error(ErrorCode::InvalidArgument, "there is no grid to cast rays at");
  grid::requireMeshable(*grid);
  base::Job job(options.threads, options.progress);
  std::shared_ptr<const RaySurface> surface;
  job.run([&] {
    job.beginStage("cells", 1);
    surface = rays::makeLevelSetSurface(grid, options);
    if (surface) {
      requireFiniteValues(*grid, options, job);
    } else {
      surface = rays::makeCellSurface(std::move(grid), options, job);
    }
  });
  job.finish();
  return surface;
}

}  // namespace tufa
