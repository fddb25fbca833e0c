#include <openvdb/openvdb.h>
#include <openvdb/tools/RayIntersector.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/box.h"
#include "grid/isovalue.h"
#include "grid/openvdb_templates.h"
#include "grid/transform.h"
#include "grid/vdb_coord.h"
#include "rays/grid/cells.h"
#include "rays/grid/grid_caster.h"
#include "rays/surface.h"

namespace tufa::rays {
namespace {

template <class GridT>
class LevelSetSurface final : public RaySurface {
 public:
  // Two steps of refinement: the first place is that of a straight line between two samples of the
  // interpolant, which is a cubic.
  using Search = openvdb::tools::LinearSearchImpl<GridT, 2>;
  using Intersector = openvdb::tools::LevelSetRayIntersector<GridT, Search>;

  LevelSetSurface(std::shared_ptr<const GridT> grid, const base::Box& bounds)
      : RaySurface(bounds, 0.5 * grid->voxelSize()[0]),
        grid_(std::move(grid)),
        transform_(grid::transformOf(*grid_)),
        affine_(transform_),
        intersector_(*grid_) {}

  [[nodiscard]] std::unique_ptr<Caster> caster() const override;
  [[nodiscard]] const GridT& grid() const { return *grid_; }
  [[nodiscard]] const Intersector& intersector() const { return intersector_; }
  [[nodiscard]] const grid::Transform& transform() const { return transform_; }
  [[nodiscard]] const grid::Affine& affine() const { return affine_; }

 private:
  std::shared_ptr<const GridT> grid_;
  grid::Transform transform_;
  grid::Affine affine_;
  Intersector intersector_;
};

// How far a ray may be followed before a surface begins; 0 unless it comes from far away.
double wayTo(const base::Box& bounds, const UnitRay& ray) {
  constexpr double kFar = 1e3;
  const double size = bounds.size().length(), away = (bounds.centre() - ray.origin).length();
  return away > kFar * size ? std::max(0.0, away - 2 * size) : 0;
}

template <class GridT>
class LevelSetCaster final : public Caster {
 public:
  explicit LevelSetCaster(const LevelSetSurface<GridT>& surface)
      : surface_(surface), intersector_(surface.intersector()), values_(surface.grid()) {}

  [[nodiscard]] std::optional<RayHit> cast(const UnitRay& ray) override {
    using OpenVdbRay = typename LevelSetSurface<GridT>::Intersector::RayType;
    // From far away a voxel is no step that the intersector can make: it would not come to an end.
    const double skipped = wayTo(surface_.bounds(), ray);
    // It takes neither 0 nor infinity.
    const double least = std::max(ray.least - skipped, openvdb::math::Delta<double>::value());
    constexpr double kMost = 1e30;
    const double greatest = std::min(ray.greatest - skipped, kMost);
    if (!(least < greatest)) return std::nullopt;
    const OpenVdbRay openVdbRay(grid::toVdb(ray.at(skipped)), grid::toVdb(ray.direction), least,
                                greatest);
    openvdb::Vec3d place;
    double distance = 0;
    if (!intersector_.intersectsWS(openVdbRay, place, distance)) return std::nullopt;
    distance += skipped;
    const Vec3 point(place.x(), place.y(), place.z());
    const Vec3 index = surface_.transform().worldToIndex(point);
    return RayHit{distance, point, normalAt(values_, surface_.affine(), index, true)};
  }

 private:
  const LevelSetSurface<GridT>& surface_;
  typename LevelSetSurface<GridT>::Intersector intersector_;
  Interpolant<GridT> values_;
};

template <class GridT>
std::unique_ptr<Caster> LevelSetSurface<GridT>::caster() const {
  return std::make_unique<LevelSetCaster<GridT>>(*this);
}

template <class GridT>
std::shared_ptr<const RaySurface> surfaceOf(const std::shared_ptr<const openvdb::GridBase>& base) {
  const auto grid = openvdb::gridConstPtrCast<GridT>(base);
  const openvdb::CoordBBox voxels = grid->evalActiveVoxelBoundingBox();
  const openvdb::BBoxd world = grid->transform().indexToWorld(voxels);
  const base::Box bounds{{world.min().x(), world.min().y(), world.min().z()},
                         {world.max().x(), world.max().y(), world.max().z()}};
  return std::make_shared<LevelSetSurface<GridT>>(grid, bounds);
}

/// Whether voxels are so near to the index origin that the intersector, which counts from there,
/// finds places to a hundredth of a voxel. Ten million voxels away it is off by most of one.
bool isNear(const openvdb::GridBase& grid) {
  constexpr std::int32_t kFarthest = 1 << 18;
  openvdb::CoordBBox box;
  if (!grid.constBaseTree().evalLeafBoundingBox(box)) return true;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.min()[axis] < -kFarthest || box.max()[axis] > kFarthest) return false;
  }
  return true;
}

/// Whether the intersector can be asked: it takes active tiles for empty, and does not come to an
/// end where no voxel is active.
bool isSuited(const openvdb::GridBase& grid, const RaySurfaceOptions& options) {
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET || !grid.hasUniformVoxels()) return false;
  if (options.isovalue.value_or(0) != 0 || options.inside == Inside::Above) return false;
  return isNear(grid) && grid.constBaseTree().activeVoxelCount() > 0 &&
         grid.constBaseTree().activeTileCount() == 0;
}

}  // namespace

std::shared_ptr<const RaySurface> makeLevelSetSurface(
    const std::shared_ptr<const openvdb::GridBase>& grid, const RaySurfaceOptions& options) {
  if (!isSuited(*grid, options)) return nullptr;
  // It looks only in active voxels: of a narrower band some cells on the surface have none at the
  // corner that it asks. It also refuses backgrounds that are no band.
  constexpr double kLeastHalfWidth = 2 * (1 - 1e-6);  // voxels, but for rounding
  const double least = kLeastHalfWidth * grid->voxelSize()[0];
  const auto usable = [least](double background) {
    return background >= least && std::isfinite(background);
  };
  if (const auto floats = openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid)) {
    return usable(floats->background()) ? surfaceOf<openvdb::FloatGrid>(grid) : nullptr;
  }
  const auto doubles = openvdb::gridConstPtrCast<openvdb::DoubleGrid>(grid);
  return doubles && usable(doubles->background()) ? surfaceOf<openvdb::DoubleGrid>(grid) : nullptr;
}

}  // namespace tufa::rays
