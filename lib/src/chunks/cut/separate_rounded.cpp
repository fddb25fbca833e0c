#include "chunks/cut/separate_rounded.h"

#include <cstdint>
#include <vector>

#include "base/huge_pages.h"
#include "base/single_precision.h"
#include "refine/keep_apart.h"
#include "refine/repair/repair.h"

namespace tufa::chunks {

void separateRounded(CutMesh& cut, const grid::Affine& affine, bool singlePrecision,
                     base::Job& job) {
  if (cut.isSeparated) return;
  std::vector<Position>& positions = cut.mesh.positions;
  Mesh rounded;
  base::resizeLarge(rounded.positions, positions.size(), job);
  base::copyLarge(cut.mesh.triangles, rounded.triangles, job);
  job.forRanges(positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Position world = affine.toWorld(positions[v]);
      rounded.positions[v] = singlePrecision ? base::toSingle(world) : world;
    }
  });
  std::vector<Position> before;
  base::copyLarge(rounded.positions, before, job);
  refine::Source source;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex v : vertices) points.push_back(before[v]);
    return points;
  };
  source.isFixed = [&](VertexIndex v) { return cut.planesAt(v)[0] != ChunkPlane::kNone; };
  source.voxelSize = affine.voxelSize();
  source.singlePrecision = singlePrecision;
  source.lastResort = false;
  std::vector<intersect::PolygonIndex> candidates;
  for (std::uint32_t t = 0; t < rounded.triangles.size(); ++t) {
    job.pollCancelled(t);
    const auto& v = rounded.triangles[t].vertices;
    if ((cut.isNew[v[0]] | cut.isNew[v[1]] | cut.isNew[v[2]]) != 0) candidates.push_back(t);
  }
  if (refine::repairIntersections(rounded, candidates, source, job).movedVertices == 0) return;
  cut.reference = positions;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    job.pollCancelled(v);
    if (!(rounded.positions[v] == before[v])) positions[v] = affine.fromWorld(rounded.positions[v]);
  }
}

void keepApart(CutMesh& cut, const grid::Affine& affine, bool singlePrecision, base::Job& job) {
  cut.moved +=
      refine::keepApart(cut.mesh.positions, cut.mesh.triangles, affine, singlePrecision, job);
}

}  // namespace tufa::chunks
