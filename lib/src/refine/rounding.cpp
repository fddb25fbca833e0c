#include "refine/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/single_precision.h"

namespace tufa::refine {

double largestRounding(const grid::Volume& volume) {
  return 0.5 * std::sqrt(3.0) * std::numeric_limits<float>::epsilon() * volume.reach;
}

double roundingMargin(const grid::Volume& volume) {
  return 2 * std::min(kMostRounding * volume.affine.leastHeight(), largestRounding(volume));
}

bool isWrittenInSingle(const std::vector<Position>& positions, const grid::Affine& affine,
                       base::Job& job) {
  const double largest = base::largestCoordinate(
      positions.size(), [&](std::size_t i) { return affine.toWorld(positions[i]); }, job);
  return base::fitsSingle(largest, kMostRounding * affine.leastHeight());
}

bool takeToWorld(Mesh& mesh, const grid::Affine& affine, base::Job& job) {
  job.forRanges(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = affine.toWorld(mesh.positions[i]);
  });
  return base::roundToSingle(mesh, kMostRounding * affine.leastHeight(), job);
}

}  // namespace tufa::refine
