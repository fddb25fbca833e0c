#pragma once

#include <tufa/shapes.h>

#include <openvdb/openvdb.h>

namespace tufa::test {

/// A built-in shape, all else as it is made by default.
inline openvdb::FloatGrid::Ptr shapeOf(Shape shape, double voxelSize) {
  ShapeOptions options;
  options.voxelSize = voxelSize;
  return makeShape(shape, options);
}

}  // namespace tufa::test
