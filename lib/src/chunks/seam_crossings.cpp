#include "chunks/seam_crossings.h"

#include <algorithm>

#include "polygons/quad_places.h"

namespace tufa::chunks {
namespace {

crossings::Crossing crossingAt(const crossings::CrossingFinder& finder, int lower, int axis) {
  if (axis == 0) return finder.at<0>(lower);
  return axis == 1 ? finder.at<1>(lower) : finder.at<2>(lower);
}

}  // namespace

template <class TreeT>
std::vector<SeamCrossing> seamCrossings(const polygons::QuadContext<TreeT>& context,
                                        const std::vector<std::uint32_t>& quads, base::Job& job) {
  std::vector<SeamCrossing> found(quads.size());
  job.forRanges(context.topology.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    typename blocks::Blocks<TreeT>::Accessor accessor(context.blocks.tree());
    blocks::BlockSamples samples;
    const crossings::CrossingFinder finder(samples, context.scale);
    for (std::size_t i = begin; i < end; ++i) {
      const components::SurfaceBlock& block = context.topology.blocks[i];
      auto next = std::lower_bound(quads.begin(), quads.end(), block.firstQuad);
      if (next == quads.end() || *next >= block.firstQuad + block.quadCount) continue;
      samples.gather(context.blocks, context.scale, block.block, block.neighbours, accessor);
      polygons::forQuads(context, block, [&](const polygons::QuadPlace& place) {
        if (next == quads.end() || *next != place.quad) return;
        const auto [x, y, z] = place.start;
        const crossings::Crossing crossing =
            crossingAt(finder, blocks::BlockSamples::index(x, y, z), place.axis);
        found[static_cast<std::size_t>(next - quads.begin())] = {
            context.blocks.origin(block.block).offsetBy(x, y, z), place.axis,
            static_cast<double>(crossing.along), crossing.normal};
        ++next;
      });
    }
  });
  return found;
}

template std::vector<SeamCrossing> seamCrossings(const polygons::QuadContext<openvdb::FloatTree>&,
                                                 const std::vector<std::uint32_t>&, base::Job&);
template std::vector<SeamCrossing> seamCrossings(const polygons::QuadContext<openvdb::DoubleTree>&,
                                                 const std::vector<std::uint32_t>&, base::Job&);

}  // namespace tufa::chunks
