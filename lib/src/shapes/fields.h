#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <memory>
#include <vector>

#include "shapes/distance_field.h"

namespace tufa::shapes {

/// A rotation by a fixed, generic angle about a generic axis, so that no face of a shape lies along
/// the lattice. Takes a world point to the shape's own frame.
[[nodiscard]] Vec3 toShapeFrame(const Vec3& worldPoint);

/// The inverse of toShapeFrame().
[[nodiscard]] Vec3 toWorldFrame(const Vec3& shapePoint);

[[nodiscard]] std::unique_ptr<DistanceField> makeSphere();
[[nodiscard]] std::unique_ptr<DistanceField> makeTorus();
[[nodiscard]] std::unique_ptr<DistanceField> makeBox();
[[nodiscard]] std::unique_ptr<DistanceField> makeBracket();
[[nodiscard]] std::unique_ptr<DistanceField> makeGyroid();
[[nodiscard]] std::unique_ptr<DistanceField> makeTerrain(std::uint32_t seed);

[[nodiscard]] std::vector<Position> boxCreasePoints(double spacing);
[[nodiscard]] std::vector<Position> bracketCreasePoints(double spacing);

/// Points from `a` to `b`, both included, at most `spacing` apart, in world space.
void appendSegment(const Vec3& a, const Vec3& b, double spacing, std::vector<Position>& points);

}  // namespace tufa::shapes
