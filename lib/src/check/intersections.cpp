#include "check/intersections.h"

#include <utility>
#include <vector>

#include "check/exact.h"
#include "check/sum_ranges.h"

namespace tufa::checks {

Bvh buildFaceTree(const Faces& faces, base::Job& job) {
  const std::vector<Triangle>& solid = faces.solid();
  std::vector<Box> boxes(solid.size());
  job.forRanges(solid.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      boxes[f] = Box::empty();
      for (const VertexIndex v : solid[f].vertices) {
        const Position& p = faces.positions[v];
        boxes[f].add(Vec3(p));
      }
    }
  });
  return Bvh(std::move(boxes), job);
}

std::size_t countIntersectingPairs(const Faces& faces, const Bvh& tree, base::Job& job) {
  // Where a mesh overlaps itself a single leaf is in many pairs.
  constexpr std::size_t kGrain = 4;
  const std::vector<Triangle>& solid = faces.solid();
  return sumRanges<std::size_t>(
      job, tree.leafCount(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::size_t pairs = 0;
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
          tree.pairsOfLeaf(leaf, [&](std::uint32_t a, std::uint32_t b) {
            pairs += intersectElsewhere(faces.positions, solid[a], solid[b]) ? 1 : 0;
          });
        }
        return pairs;
      });
}

}  // namespace tufa::checks
