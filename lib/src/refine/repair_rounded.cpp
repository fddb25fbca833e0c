#include "refine/repair_rounded.h"

#include <utility>

#include "base/single_precision.h"
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
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Position& now = world.positions[i];
    const Position before = affine.toWorld(mesh.positions[i]);
    if (!(now == (source.singlePrecision ? base::toSingle(before) : before))) {
      mesh.positions[i] = affine.fromWorld(now);
    }
  }
  return repaired;
}

}  // namespace tufa::refine
