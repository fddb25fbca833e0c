#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <tufa/shapes.h>
#include <cmath>
#include <string>

#include "base/known_enum.h"
#include "base/lattice_range.h"
#include "base/number_text.h"
#include "shapes/fields.h"
#include "shapes/random_volumes.h"
#include "shapes/sampler.h"

namespace tufa {
namespace {

using shapes::DistanceField;

/// The field of a shape, or nothing for the shapes without a surface of their own.
std::unique_ptr<DistanceField> makeField(Shape shape, std::uint32_t seed) {
  switch (shape) {
    case Shape::Sphere:
      return shapes::makeSphere();
    case Shape::Torus:
      return shapes::makeTorus();
    case Shape::Box:
      return shapes::makeBox();
    case Shape::Bracket:
      return shapes::makeBracket();
    case Shape::Gyroid:
      return shapes::makeGyroid();
    case Shape::Terrain:
      return shapes::makeTerrain(seed);
    case Shape::Noise:
    case Shape::Fog:
      break;
  }
  return nullptr;
}

const DistanceField* sharedField(Shape shape) {
  static const auto fields = [] {
    std::array<std::unique_ptr<DistanceField>, 8> all;
    for (std::size_t n = 0; n < all.size(); ++n) {
      all[n] = makeField(static_cast<Shape>(n), ShapeOptions{}.seed);
    }
    return all;
  }();
  return fields.at(static_cast<std::size_t>(shape)).get();
}

}  // namespace

const std::array<std::string_view, 8>& shapeNames() {
  static constexpr std::array<std::string_view, 8> kNames{"sphere", "torus",   "box",   "bracket",
                                                          "gyroid", "terrain", "noise", "fog"};
  return kNames;
}

std::optional<Shape> shapeByName(std::string_view name) {
  for (std::size_t n = 0; n < shapeNames().size(); ++n) {
    if (shapeNames()[n] == name) return static_cast<Shape>(n);
  }
  return std::nullopt;
}

openvdb::FloatGrid::Ptr makeShape(Shape shape, const ShapeOptions& options) {
  base::requireVoxelSize(options.voxelSize);
  base::requireHalfWidth(options.halfWidth);
  base::requireKnown(shape, Shape::Fog, "the shape");
  openvdb::initialize();
  openvdb::FloatGrid::Ptr grid;
  if (const auto field = makeField(shape, options.seed)) {
    grid = shapes::sampleLevelSet(*field, options);
  } else {
    grid = shape == Shape::Noise ? shapes::makeNoise(options) : shapes::makeFog(options);
  }
  grid->setName(std::string(shapeNames().at(static_cast<std::size_t>(shape))));
  return grid;
}

double shapeDistance(Shape shape, const Position& point) {
  base::requireKnown(shape, Shape::Fog, "the shape");
  const DistanceField* const field = sharedField(shape);
  if (field == nullptr) {
    throw Error(ErrorCode::InvalidArgument,
                "noise and fog have no true surface to measure a distance to");
  }
  return field->distance({point.x, point.y, point.z});
}

std::vector<Position> shapeCreasePoints(Shape shape, double spacing) {
  base::requireKnown(shape, Shape::Fog, "the shape");
  constexpr double kLeast = 1e-6;  // of millions of points
  if (!(std::isfinite(spacing) && spacing >= kLeast)) {
    throw Error(ErrorCode::InvalidArgument, "spacing must be a finite number of " +
                                                base::numberText(kLeast) + " or more, not " +
                                                base::numberText(spacing));
  }
  if (shape == Shape::Box) return shapes::boxCreasePoints(spacing);
  if (shape == Shape::Bracket) return shapes::bracketCreasePoints(spacing);
  return {};
}

}  // namespace tufa
