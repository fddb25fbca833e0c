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

std::vector<VertexIndex> tooCoarse(const Mesh& base, const octree::Cut& cut,
                                   const distance::Deviation& deviation) {
  std::vector<VertexIndex> vertices = deviation.coarse;
  const std::size_t points = base.positions.size();
  for (const std::uint64_t point : deviation.farPoints) {
    if (point < points) {
      vertices.push_back(cut.vertexOf[point]);
      continue;
    }
    for (const VertexIndex corner : base.quads[point - points].vertices) {
      vertices.push_back(cut.vertexOf[corner]);
    }
  }
  return vertices;
}

}  // namespace tufa::refine
