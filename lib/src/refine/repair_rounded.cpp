#include "refine/repair_rounded.h"

#include <utility>

#include "refine/rounding.h"

namespace tufa::refine {

RepairReport repairRounded(Mesh& mesh, const std::vector<intersect::PolygonPair>& closePairs,
                           Source source, const grid::Affine& affine, base::Job& job) {
  if (closePairs.empty()) return {};
  Mesh world;
  world.positions = mesh.positions;
  source.singlePrecision = takeToWorld(world, affine, job);
  const std::vector<intersect::PolygonIndex> candidates = intersect::distinctPolygonsOf(
      intersect::intersectingAmong(closePairs, mesh, world.positions));
  if (candidates.empty()) return {};
  world.quads = mesh.quads;
  world.triangles = mesh.triangles;
  source.massPoints = [&affine,
                       points = source.massPoints](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> all = points(vertices);
    for (Position& point : all) point = affine.toWorld(point);
    return all;
  };
  source.crossings = nullptr;
  const std::vector<Position> before = world.positions;
  RepairReport repaired = repairIntersections(world, candidates, source, job);
  if (repaired.changed.empty()) return repaired;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!(world.positions[i] == before[i]))
      mesh.positions[i] = affine.fromWorld(world.positions[i]);
  }
  mesh.quads = std::move(world.quads);
  mesh.triangles = std::move(world.triangles);
  return repaired;
}

}  // namespace tufa::refine
