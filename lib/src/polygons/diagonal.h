#pragma once

#include <array>

namespace tufa::polygons {

using Point = std::array<double, 3>;

/// Whether the diagonal from corner 1 to corner 3 splits the quad better than the one from 0 to 2.
/// `crossing` is a point of the surface that the quad stands around, `direction` the outward
/// direction of the lattice edge there, of the length of a voxel.
[[nodiscard]] bool secondDiagonalIsBetter(const std::array<Point, 4>& corners,
                                          const Point& crossing, const Point& direction);

}  // namespace tufa::polygons
