#pragma once

#include <openvdb/tree/ValueAccessor.h>

namespace tufa::grid {

/// Caches the internal nodes on the way, and no leaf: OpenVDB's usual accessor looks for the values
/// of each leaf that it passes, and makes room for them in one that has none.
template <class TreeT>
using NodeAccessor = openvdb::tree::ValueAccessor2<const TreeT, true, 1, 2>;

}  // namespace tufa::grid
