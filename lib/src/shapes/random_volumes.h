#pragma once

#include <openvdb/openvdb.h>

#include <tufa/shapes.h>

namespace tufa::shapes {

[[nodiscard]] openvdb::FloatGrid::Ptr makeNoise(const ShapeOptions& options);
[[nodiscard]] openvdb::FloatGrid::Ptr makeFog(const ShapeOptions& options);

}  // namespace tufa::shapes
