#include "refine/split_cells.h"

namespace tufa::refine {

bool splitCells(const octree::ClusterForest& forest, const std::vector<VertexIndex>& vertices,
                const octree::Cut& cut, int minLevel, octree::CellFlags& forbidden) {
  bool any = false;
  for (const VertexIndex vertex : vertices) {
    const octree::ClusterRef& ref = cut.clusters[vertex];
    if (ref.level <= minLevel) continue;
    any = true;
    forbidden.at(ref.level)[forest.at(ref.level).clusters[ref.cluster].cell] = 1;
  }
  return any;
}

}  // namespace tufa::refine
