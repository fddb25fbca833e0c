#pragma once

#include <openvdb/openvdb.h>
#include <tufa/error.h>

namespace tufa::filter {

/// Calls visit(typed grid) for a grid of integers. Throws Error(UnsupportedGrid) for another.
template <class Visit>
void withIntegers(const openvdb::GridBase& grid, const Visit& visit) {
  if (grid.isType<openvdb::Int32Grid>()) {
    visit(static_cast<const openvdb::Int32Grid&>(grid));
  } else if (grid.isType<openvdb::Int64Grid>()) {
    visit(static_cast<const openvdb::Int64Grid&>(grid));
  } else {
    throw Error(ErrorCode::UnsupportedGrid, "grid \"" + grid.getName() + "\" is a " + grid.type() +
                                                "; labels are 32- or 64-bit integers in OpenVDB's "
                                                "standard tree (5_4_3)");
  }
}

}  // namespace tufa::filter
