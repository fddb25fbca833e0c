#pragma once

#include <openvdb/openvdb.h>

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/progress.h>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace tufa {

/// Demonstration volumes, most of which have an exact surface to compare with. All but Noise and
/// Fog are level sets: of exact signed distances, and of distances to first order for Gyroid and
/// Terrain.
enum class Shape {
  Sphere,   ///< radius 1
  Torus,    ///< radii 1 and 0.35, tilted
  Box,      ///< rotated box with sharp edges
  Bracket,  ///< a mechanical part: plates, a rib, through holes; convex, concave and curved creases
  Gyroid,   ///< thin shell of high genus inside a sphere or cube
  Terrain,  ///< a hilly heightfield slab, closed below
  Noise,    ///< white noise: every configuration of cells there is
  Fog,      ///< a soft density
};

/// Options of makeShape().
struct ShapeOptions {
  double voxelSize = 0.02;  ///< world units; every shape is about 2 units in size
  double halfWidth = 3;     ///< of the narrow band, in voxels: 1 to 1000
  std::uint32_t seed = 1;   ///< of the random shapes
  int threads = 0;          ///< most threads; 0: all. Never changes the result.
  Progress progress;        ///< called from the calling thread; may cancel
};

/// The shape of that name ("sphere", "torus", ...), if there is one.
[[nodiscard]] TUFA_API std::optional<Shape> shapeByName(std::string_view name);

/// Names of all shapes, in the order of the enum.
[[nodiscard]] TUFA_API const std::array<std::string_view, 8>& shapeNames();

/// Samples the shape on a grid of the given voxel size. Noise is a dense cube of random samples, 2
/// units long, with round(2 / voxelSize) of them along each edge, and a border of outside samples
/// around them. Throws Error(InvalidArgument) for a half width that is not from 1 to 1000, a voxel
/// size that is not from 1.5 * 10^-5 to 10^25, and one of Noise that leaves it no sample.
[[nodiscard]] TUFA_API openvdb::FloatGrid::Ptr makeShape(Shape shape,
                                                         const ShapeOptions& options = {});

/// Exact signed distance from a world point to the true shape, negative inside; for Gyroid and
/// Terrain the field that defines them, whose zero set is the shape and whose values are distances
/// to first order only. Throws Error(InvalidArgument) for Noise and Fog, which have no such
/// surface.
[[nodiscard]] TUFA_API double shapeDistance(Shape shape, const Position& point);

/// Points along the true creases of Box and Bracket, at most `spacing` apart; empty for the others.
[[nodiscard]] TUFA_API std::vector<Position> shapeCreasePoints(Shape shape, double spacing);

}  // namespace tufa
