#include "refine/repair_rounded.h"

#include <utility>

#include "base/huge_pages.h"
#include "refine/rounding.h"

namespace tufa::refine {

RepairReport repairRounded(Mesh& mesh, const std::vector<intersect::PolygonPair>& closePairs,
                           Source source, const grid::Affine& affine, base::Job& job) {
  if (closePairs.empty()) return {};
  Mesh world;
  base::copyLarge(mesh.positions, world.positions, job);
  source.singlePrecision = takeToWorld(world, affine, job);
  const std::vector<intersect::PolygonIndex> candidates = intersect::distinctPolygonsOf(
      intersect::intersectingAmong(closePairs, mesh, world.positions, job));
  if (candidates.empty()) return {};
  std::swap(world.quads, mesh.quads), std::swap(world.triangles, mesh.triangles);
  source.massPoints = [&affine,
                       points = source.massPoints](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> all = points(vertices);
    for (Position& point : all) point = affine.toWorld(point);
    return all;
  };
  source.crossings = nullptr;
  RepairReport repaired = repairIntersections(world, candidates, source, job);
  std::swap(world.quads, mesh.quads), std::swap(world.triangles, mesh.triangles);
  if (repaired.changed.empty()) return repaired;
  for (const auto& [vertex, from] : repaired.moved) {
    mesh.positions[vertex] = affine.fromWorld(world.positions[vertex]);
  }
  return repaired;
}

}  // namespace tufa::refine
