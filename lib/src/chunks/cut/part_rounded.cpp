#include "chunks/cut/part_rounded.h"

#include <numeric>
#include <utility>
#include <vector>

#include "base/single_precision.h"
#include "refine/repair/repair.h"

namespace tufa::chunks {

void partRounded(CutMesh& cut, const grid::Affine& affine, bool singlePrecision, base::Job& job) {
  std::vector<Position>& positions = cut.mesh.positions;
  Mesh rounded;
  rounded.positions.resize(positions.size());
  rounded.triangles = cut.mesh.triangles;
  job.forRanges(positions.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Position world = affine.toWorld(positions[v]);
      rounded.positions[v] = singlePrecision ? base::toSingle(world) : world;
    }
  });
  const std::vector<Position> before = rounded.positions;
  refine::Source source;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex v : vertices) points.push_back(before[v]);
    return points;
  };
  source.isFixed = [&](VertexIndex v) { return cut.planesOf[v][0] != ChunkPlane::kNone; };
  source.voxelSize = affine.voxelSize();
  source.singlePrecision = singlePrecision;
  source.lastResort = false;
  std::vector<intersect::PolygonIndex> all(rounded.triangles.size());
  std::iota(all.begin(), all.end(), 0);
  if (refine::repairIntersections(rounded, all, source, job).movedVertices == 0) return;
  cut.reference = positions;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!(rounded.positions[v] == before[v])) positions[v] = affine.fromWorld(rounded.positions[v]);
  }
}

}  // namespace tufa::chunks
