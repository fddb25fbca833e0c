#pragma once

#include <openvdb/openvdb.h>

#include <memory>

#include "base/leaf_source.h"
#include "io/grid/vdb_reader.h"

namespace tufa::io {

/// Reads the values of a grid's leaves whenever they are asked for, by the reader that read the
/// topology last. The grid keeps no values. Reading a leaf also sets its mask of active voxels: of
/// the two in a file the one beside the values counts.
[[nodiscard]] std::unique_ptr<base::LeafSource> leavesOf(VdbReader& reader,
                                                         VdbReader::Topology topology);

}  // namespace tufa::io
