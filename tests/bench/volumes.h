#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace tufa::bench {

/// The grid of a shape ("sphere", "gyroid", ...) or of a mesh file, voxelized, with about
/// `activeVoxels` active voxels.
[[nodiscard]] openvdb::FloatGrid::Ptr makeVolume(const std::string& shapeOrFile,
                                                 double activeVoxels);

}  // namespace tufa::bench
