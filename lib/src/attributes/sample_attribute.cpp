#include <openvdb/openvdb.h>
#include <tufa/attributes.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/job.h"
#include "base/known_enum.h"

namespace tufa {
namespace {

using openvdb::Vec3d;

using SampledTypes =
    openvdb::NumericGridTypes::Append<openvdb::Vec3GridTypes>::Append<openvdb::BoolGrid,
                                                                      openvdb::MaskGrid>;

template <class Value>
constexpr int widthOf() {
  if constexpr (openvdb::VecTraits<Value>::IsVec) {
    return Value::size;
  } else {
    return 1;
  }
}

template <class Value>
double component(const Value& value, int i) {
  if constexpr (openvdb::VecTraits<Value>::IsVec) {
    return static_cast<double>(value[i]);
  } else {
    return static_cast<double>(value);
  }
}

/// One component of the values around a place in index space. Not by openvdb::tools::BoxSampler,
/// which rounds what lies between integers.
template <class Accessor>
double sampleComponent(const Accessor& accessor, const Vec3d& place, int i) {
  const openvdb::Coord least = openvdb::Coord::floor(place);
  const Vec3d share = place - least.asVec3d();
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double weight = (x == 1 ? share[0] : 1 - share[0]) * (y == 1 ? share[1] : 1 - share[1]) *
                          (z == 1 ? share[2] : 1 - share[2]);
    // A value that is not finite must not spoil places that it has no part in.
    if (weight > 0) sum += weight * component(accessor.getValue(least.offsetBy(x, y, z)), i);
  }
  return sum;
}

/// A place whose coordinates fit 32-bit integers, and 0 in place of NaN: mesh and grid may be of
/// any size. That far out there is nothing but background.
Vec3d nearestPlace(const Vec3d& place) {
  constexpr double kMost = 2147483000.0;
  Vec3d nearest;
  for (int axis = 0; axis < 3; ++axis) {
    nearest[axis] = std::isnan(place[axis]) ? 0 : std::clamp(place[axis], -kMost, kMost);
  }
  return nearest;
}

/// `factor` times a value, within the range of float; 0 where the value is not finite.
float scaledToFloat(double value, double factor) {
  if (!std::isfinite(value)) return 0;
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(factor * value, -kLargest, kLargest));
}

/// The values at a range of positions.
template <class GridT>
void sampleRange(const GridT& grid, std::span<const Position> positions, double factor,
                 std::size_t begin, std::size_t end, Attribute& attribute) {
  const auto accessor = grid.getConstUnsafeAccessor();
  const bool staggered = grid.getGridClass() == openvdb::GRID_STAGGERED;
  const auto width = static_cast<std::size_t>(attribute.width);
  for (std::size_t v = begin; v < end; ++v) {
    const Position& p = positions[v];
    const Vec3d place = nearestPlace(grid.transform().worldToIndex(Vec3d(p.x, p.y, p.z)));
    for (int i = 0; i < attribute.width; ++i) {
      Vec3d at = place;
      if (staggered && attribute.width == 3) at[i] += 0.5;
      attribute.values[v * width + static_cast<std::size_t>(i)] =
          scaledToFloat(sampleComponent(accessor, at, i), factor);
    }
  }
}

std::string shownName(const openvdb::GridBase& grid) { return "grid \"" + grid.getName() + "\""; }

void requireSound(const Attribute& attribute, const openvdb::GridBase& grid) {
  if (attribute.name.empty()) {
    throw Error(ErrorCode::InvalidArgument, "the attribute of a grid without a name needs one");
  }
  if (attribute.role != AttributeRole::Value && attribute.width != 3) {
    const bool colour = attribute.role == AttributeRole::Colour;
    throw Error(ErrorCode::InvalidArgument, shownName(grid) + " holds numbers; a " +
                                                (colour ? "colour" : "motion") + " needs vectors");
  }
}

}  // namespace

Attribute sampleAttribute(std::span<const Position> positions, const openvdb::GridBase& grid,
                          const AttributeOptions& options) {
  base::requireKnown(options.role, AttributeRole::Motion, "the role of an attribute");
  if (!std::isfinite(options.factor)) {
    throw Error(ErrorCode::InvalidArgument, "the factor of an attribute is not finite");
  }
  if (!grid.transform().isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "the transform of " + shownName(grid) + " is a frustum; it must be linear");
  }
  Attribute attribute;
  attribute.name = options.name.value_or(grid.getName());
  attribute.role = options.role;
  base::Job job(options.threads, {});
  const bool sampled = grid.apply<SampledTypes>([&](const auto& typed) {
    using Value = typename std::decay_t<decltype(typed)>::ValueType;
    attribute.width = widthOf<Value>();
    requireSound(attribute, grid);
    attribute.values.resize(positions.size() * static_cast<std::size_t>(attribute.width));
    job.run([&] {
      job.forRanges(positions.size(), [&](std::size_t begin, std::size_t end) {
        sampleRange(typed, positions, options.factor, begin, end, attribute);
      });
    });
  });
  if (!sampled) {
    throw Error(ErrorCode::UnsupportedGrid,
                shownName(grid) + " is a " + grid.type() +
                    "; an attribute is sampled from numbers, booleans or vectors in OpenVDB's "
                    "standard tree (5_4_3)");
  }
  return attribute;
}

Attribute sampleAttribute(const Mesh& mesh, const openvdb::GridBase& grid,
                          const AttributeOptions& options) {
  return sampleAttribute(std::span(mesh.positions), grid, options);
}

}  // namespace tufa
