#pragma once

#include <openvdb/openvdb.h>

#include <tufa/shapes.h>

#include "grid/build_blocks.h"
#include "shapes/distance_field.h"

namespace tufa::shapes {

/// buildBlocks() as a call of its own, with the options' threads and progress.
void sampleBlocks(openvdb::FloatTree& tree, const grid::BlockSource& source,
                  const ShapeOptions& options);

/// Samples a field as a narrow-band level set, with the values of tiles and inactive voxels clamped
/// to the band on their side of the surface.
[[nodiscard]] openvdb::FloatGrid::Ptr sampleLevelSet(const DistanceField& field,
                                                     const ShapeOptions& options);

}  // namespace tufa::shapes
