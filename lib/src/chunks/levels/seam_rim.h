#pragma once

#include <cstdint>
#include <vector>

#include "chunks/levels/seamed_cut.h"
#include "chunks/seams/seams.h"
#include "refine/collapse/rim.h"

namespace tufa::chunks {

/// The stretches that the clusters of a mesh stand for on its seams. As long as each stands for one
/// stretch of a curve, and of a closed one in one quadrant, strips to any polyline close the
/// surface. Clusters that break this rule already, and vertices on seams, are marked in `fixed`.
[[nodiscard]] refine::Rim rimOf(const SeamedCut& mesh, const Seams& seams,
                                std::vector<std::uint8_t>& fixed);

/// Marks the clusters of triangles that stitch() cut off before a strip: such a triangle joins
/// clusters that do not follow each other.
void fixEars(const SeamedCut& mesh, std::vector<std::uint8_t>& fixed);

}  // namespace tufa::chunks
