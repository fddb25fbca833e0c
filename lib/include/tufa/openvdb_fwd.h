#pragma once

#include <openvdb/version.h>
#include <tufa/export.h>

// Names of OpenVDB's classes, for headers that only pass grids on: openvdb.h itself costs seconds
// in each file that includes it.
namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

class GridBase;

namespace math {
class Transform;
}

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
