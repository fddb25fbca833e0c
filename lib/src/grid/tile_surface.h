#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

#include "base/job.h"
#include "grid/isovalue.h"

namespace tufa::grid {

/// How much surface lies between tiles, in faces of voxels: a tile is a few bytes in a file, and
/// the largest one has a hundred million such faces, each a quad of the uniform mesh. Faces towards
/// leaves are not counted: a leaf has bytes of its own in a file for what surface there is.
///
/// Walks the nodes of the tree, not its voxels: a tile costs six look-ups, more where a node of
/// smaller tiles lies beside it.
template <class TreeT>
[[nodiscard]] std::uint64_t tileSurface(const TreeT& tree, const IsoChoice& iso, base::Job& job);

}  // namespace tufa::grid
