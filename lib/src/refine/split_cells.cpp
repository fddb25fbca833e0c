#include "refine/split_cells.h"

namespace tufa::refine {

bool splitCells(const std::vector<VertexIndex>& vertices, const octree::Cut& cut, int minLevel,
                octree::CellFlags& forbidden) {
  bool any = false;
  for (const VertexIndex vertex : vertices) {
    const octree::ClusterRef& ref = cut.clusters[vertex];
    if (ref.level <= minLevel) continue;
    any = true;
    if (ref.level == 1) forbidden.level1[ref.parentCell] |= std::uint64_t{1} << ref.cell;
    if (ref.level == 2)
      forbidden.level2[ref.parentCell] |= static_cast<std::uint8_t>(1 << ref.cell);
    if (ref.level >= 3) forbidden.levels[ref.level - 3][ref.parentCell] = 1;
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
