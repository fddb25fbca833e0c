#pragma once

#include <openvdb/openvdb.h>

/// Declares that trees and grids of this type are compiled in one source file alone: their virtual
/// functions, which every file that makes one would compile again, take seconds each time.
#define TUFA_TREE_IS_ELSEWHERE(TreeT)                                      \
  extern template class openvdb::tree::Tree<openvdb::TreeT::RootNodeType>; \
  extern template class openvdb::Grid<openvdb::TreeT>

/// Compiles them in this source file.
#define TUFA_TREE_IS_HERE(TreeT)                                    \
  template class openvdb::tree::Tree<openvdb::TreeT::RootNodeType>; \
  template class openvdb::Grid<openvdb::TreeT>

TUFA_TREE_IS_ELSEWHERE(FloatTree);
TUFA_TREE_IS_ELSEWHERE(DoubleTree);
