#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "uniform/crossings.h"
#include "uniform/quads.h"

namespace tufa::chunks {

/// Where the surface crosses the lattice edge that a uniform quad stands around.
struct SeamCrossing {
  Coord start;               ///< lower end of the edge
  int axis = 0;              ///< along the edge
  double along = 0;          ///< from 0 at the lower end to 1
  uniform::Vector normal{};  ///< outward covector of unit length in index space
};

/// The crossings of some uniform quads, given in rising order. Each depends on the samples near its
/// edge alone, so that all who compute it get the same bits.
[[nodiscard]] std::vector<SeamCrossing> seamCrossings(const uniform::SurfaceView& context,
                                                      const std::vector<std::uint32_t>& quads,
                                                      base::Job& job);

}  // namespace tufa::chunks
