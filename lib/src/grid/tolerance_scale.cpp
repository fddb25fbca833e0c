#include "grid/tolerance_scale.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

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
    const openvdb::Vec3d place = grid->transform().worldToIndex(world);
    // Coordinates are 32-bit integers.
    constexpr double kMost = std::numeric_limits<std::int32_t>::max();
    const bool isOnLattice =
        std::abs(place[0]) < kMost && std::abs(place[1]) < kMost && std::abs(place[2]) < kMost;
    const float value =
        isOnLattice ? grid->tree().getValue(openvdb::Coord::round(place)) : grid->background();
    if (std::isnan(value)) return 0.0;
    // Products with infinity might be no numbers.
    constexpr float kLargest = std::numeric_limits<float>::max();
    return static_cast<double>(std::clamp(value, 0.0F, kLargest));
  };
}

}  // namespace tufa::grid
