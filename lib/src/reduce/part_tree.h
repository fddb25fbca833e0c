#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/job.h"
#include "reduce/box3f.h"
#include "reduce/corners.h"

namespace tufa::reduce {

/// What a part has at most.
struct PartSize {
  Index vertices = 8192;
  /// Reference vertices that its triangles own, so that the last phases of a large mesh are not one
  /// part's, and one thread's.
  std::size_t samples = std::size_t{1} << 18;
  /// Parts have more samples rather than fewer vertices: those at borders stay for a phase.
  Index leastVertices = 1024;
};

/// A k-d tree whose leaves, the parts, divide vertices among them.
struct PartTree {
  struct Node {
    int axis;  ///< -1: a part, whose number is `low`
    float at;
    Index low, high;
  };
  std::vector<Node> nodes;
  std::vector<Box3f> boxes;     ///< of space, one for each part
  std::vector<Index> ranges;    ///< of `vertices`, one for each part, and their end
  std::vector<Index> vertices;  ///< part by part, in rising order in each

  [[nodiscard]] std::size_t size() const { return boxes.size(); }
};

/// Cuts across the longest extent leave about `share` of the vertices on their lower side, until
/// parts are small enough. `samplesAt`: how many samples a part has for each vertex, or empty.
/// Cost: n log n, one pass over the vertices for each level of the tree.
[[nodiscard]] PartTree splitIntoParts(std::span<const Vec3f> positions,
                                      std::span<const Index> samplesAt, const PartSize& size,
                                      float share, base::Job& job);

/// Cuts where another tree did, wherever the vertices are.
[[nodiscard]] PartTree splitAlong(std::span<const Vec3f> positions,
                                  const std::vector<PartTree::Node>& nodes, base::Job& job);

}  // namespace tufa::reduce
