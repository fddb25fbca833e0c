#pragma once

#include <cstdint>
#include <functional>
#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"
#include "components/topology.h"
#include "forest/forest.h"

namespace tufa::cut {

/// One bit for each cell of a forest, by level; bit and cell order as in forest::BlockForest.
struct CellFlags {
  std::vector<std::uint64_t> level1;              ///< for each surface block
  std::vector<std::uint8_t> level2;               ///< for each surface block
  std::vector<std::vector<std::uint8_t>> levels;  ///< as forest::Forest::levels

  explicit CellFlags(const forest::Forest& forest);
};

/// What a cluster must keep for its cell to become a leaf.
struct CutRule {
  double tolerance = 0;  ///< voxels; bound on a cluster's estimated error
  double maxAngle = 4;   ///< radians; bound on the angle between two normals of a cluster
  int minLevel = 0;      ///< cells up to this level need not keep the bounds above
  int maxLevel = 31;     ///< no cell above this level
  /// Multiplies the tolerance at a lattice point; empty: 1 everywhere.
  std::function<double(const openvdb::Vec3d&)> scale;
};

/// The cells that a cut merges: the leaves of a restricted octree, and all cells below them. A cell is
/// merged if it is safe, keeps the rule, is not forbidden, its children are merged, and so are all
/// surface cells of its children's size that touch it: no two leaves that touch differ by more than
/// one level, and no coarser octree has these properties.
[[nodiscard]] CellFlags mergeCells(const forest::Forest& forest,
                                   const components::Topology& topology, const CutRule& rule,
                                   const CellFlags& forbidden, base::Job& job);

}  // namespace tufa::cut
