#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace tufa::io {

/// Why contour() would not take a grid of this type and transform, or nothing if it would.
[[nodiscard]] std::string whyNotMeshable(const openvdb::GridBase& grid);

/// Why a grid with a linear transform lies where no surface can be computed, or nothing if it does
/// not.
[[nodiscard]] std::string whyOutOfRange(const openvdb::GridBase& grid);

}  // namespace tufa::io
