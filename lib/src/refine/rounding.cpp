#include "refine/rounding.h"

#include "base/single_precision.h"

namespace tufa::refine {

bool takeToWorld(Mesh& mesh, const grid::Affine& affine, base::Job& job) {
  constexpr std::size_t kGrain = 4096;
  job.forRanges(mesh.positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = affine.toWorld(mesh.positions[i]);
  });
  return base::roundToSingle(mesh, kMostRounding * affine.leastHeight(), job);
}

}  // namespace tufa::refine
