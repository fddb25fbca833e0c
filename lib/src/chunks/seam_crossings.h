#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "crossings/crossings.h"
#include "polygons/base_quads.h"

namespace tufa::chunks {

/// Where the surface crosses the lattice edge that a base quad stands around.
struct SeamCrossing {
  openvdb::Coord start;  ///< lower end of the edge
  int axis = 0;          ///< along the edge
  double along = 0;      ///< from 0 at the lower end to 1
  qef::Vector normal{};  ///< outward covector of unit length in index space
};

/// The crossings of some base quads, sorted. Each is found from the samples near its edge alone, so
/// that whoever asks for it gets the same bits.
template <class TreeT>
[[nodiscard]] std::vector<SeamCrossing> seamCrossings(const polygons::QuadContext<TreeT>& context,
                                                      const std::vector<std::uint32_t>& quads,
                                                      base::Job& job);

}  // namespace tufa::chunks
