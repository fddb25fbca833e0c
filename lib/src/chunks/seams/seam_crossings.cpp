#include "chunks/seams/seam_crossings.h"

#include <algorithm>

#include "uniform/quad_places.h"

namespace tufa::chunks {
namespace {

uniform::Crossing crossingAt(const uniform::CrossingFinder& finder, int lower, int axis) {
  if (axis == 0) return finder.at<0>(lower);
  return axis == 1 ? finder.at<1>(lower) : finder.at<2>(lower);
}

}  // namespace

std::vector<SeamCrossing> seamCrossings(const uniform::SurfaceView& context,
                                        const std::vector<std::uint32_t>& quads, base::Job& job) {
  std::vector<SeamCrossing> found(quads.size());
  job.forRanges(context.topology.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    const auto accessor = context.blocks.accessor();
    grid::BlockSamples samples;
    const uniform::CrossingFinder finder(samples, context.scale);
    for (std::size_t i = begin; i < end; ++i) {
      const uniform::SurfaceBlock& block = context.topology.blocks[i];
      auto next = std::lower_bound(quads.begin(), quads.end(), block.firstQuad);
      if (next == quads.end() || *next >= block.firstQuad + block.quadCount) continue;
      samples.gather(context.blocks, context.scale, block.block, block.neighbours, *accessor);
      uniform::forQuads(context, block, [&](const uniform::QuadPlace& place) {
        if (next == quads.end() || *next != place.quad) return;
        const auto [x, y, z] = place.start;
        const uniform::Crossing crossing =
            crossingAt(finder, grid::BlockSamples::index(x, y, z), place.axis);
        found[static_cast<std::size_t>(next - quads.begin())] = {
            context.blocks.origin(block.block).offsetBy(x, y, z), place.axis,
            static_cast<double>(crossing.along), crossing.normal};
        ++next;
      });
    }
  });
  return found;
}

}  // namespace tufa::chunks
