#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "base/job.h"
#include "blocks/isovalue.h"
#include "check/frame.h"

namespace tufa::checks {

/// Points on the trilinear isosurface, in voxel space: where it crosses a lattice edge with an
/// active end, and one inside each cell whose lowest corner is active. In level sets both ends must
/// be active. Found apart from contour()'s own search, so that one can be held against the other.
template <class GridT>
[[nodiscard]] std::vector<openvdb::Vec3d> sampleIsosurface(const GridT& grid, const Frame& frame,
                                                           const blocks::IsoChoice& iso,
                                                           base::Job& job);

extern template std::vector<openvdb::Vec3d> sampleIsosurface(const openvdb::FloatGrid&,
                                                             const Frame&, const blocks::IsoChoice&,
                                                             base::Job&);
extern template std::vector<openvdb::Vec3d> sampleIsosurface(const openvdb::DoubleGrid&,
                                                             const Frame&, const blocks::IsoChoice&,
                                                             base::Job&);

}  // namespace tufa::checks
