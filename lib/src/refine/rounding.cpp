#include "refine/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/single_precision.h"

namespace tufa::refine {

double largestRounding(const grid::Blocks& blocks, const grid::Transform& transform) {
  double largest = 0;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const Vec3 corner(blocks.origin(static_cast<grid::BlockRef>(i)));
    for (int c = 0; c < 8; ++c) {
      const Vec3 step((c & 4) * 2.0, (c & 2) * 4.0, (c & 1) * 8.0);
      const Vec3 world = transform.indexToWorld(corner + step);
      largest = std::max({largest, std::abs(world[0]), std::abs(world[1]), std::abs(world[2])});
    }
  }
  return 0.5 * std::sqrt(3.0) * std::numeric_limits<float>::epsilon() * largest;
}

double roundingMargin(const grid::Volume& volume) {
  return 2 * std::min(kMostRounding * volume.affine.leastHeight(),
                      largestRounding(volume.blocks, volume.transform));
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
