#include "grid/tolerance_scale.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>

#include <algorithm>
#include <cmath>

#include "grid/vdb_coord.h"

namespace tufa::grid {

std::function<double(const Vec3&)> toleranceScale(
    const std::shared_ptr<const openvdb::GridBase>& scales, const Transform& transform) {
  if (!scales->isType<openvdb::FloatGrid>()) {
    throw Error(ErrorCode::UnsupportedGrid, "the tolerance grid \"" + scales->getName() +
                                                "\" holds values of type " + scales->valueType() +
                                                "; it must be a float grid");
  }
  if (!scales->transform().isLinear()) {
    throw Error(ErrorCode::InvalidArgument, "the transform of the tolerance grid \"" +
                                                scales->getName() +
                                                "\" is a frustum; it must be linear");
  }
  if (const std::string why = base::whyOutOfRange(transformOf(*scales).lattice()); !why.empty()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "the tolerance grid \"" + scales->getName() + "\" cannot be used: " + why);
  }
  const auto grid = openvdb::gridConstPtrCast<openvdb::FloatGrid>(scales);
  return [grid, transform](const Vec3& point) {
    const openvdb::Vec3d world = toVdb(transform.indexToWorld(point));
    const openvdb::Coord at = openvdb::Coord::round(grid->transform().worldToIndex(world));
    const float value = grid->tree().getValue(at);
    return std::isfinite(value) ? std::max(0.0, static_cast<double>(value)) : 0.0;
  };
}

}  // namespace tufa::grid
