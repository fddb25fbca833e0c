#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "base/job.h"
#include "grid/isovalue.h"

namespace tufa::grid {

/// Origins of the blocks without a leaf in which two tiles of different sides may touch (the
/// background counts as a tile): sorted, each once. None is missed, but some may hold no such
/// cells. Cost: proportional to the number of tiles on the side the background is not on; of large
/// tiles only the shell is searched.
template <class TreeT>
[[nodiscard]] std::vector<openvdb::Coord> findTileContacts(const TreeT& tree, const IsoChoice& iso,
                                                           base::Job& job);

}  // namespace tufa::grid
