#include "refine/measured.h"

#include <algorithm>
#include <utility>

#include "base/polygons.h"
#include "refine/repair_rounded.h"

namespace tufa::refine {
namespace {

// The polygons that have a marked vertex; all if there are no marks.
std::vector<intersect::PolygonIndex> withMarks(const Mesh& mesh,
                                               const std::vector<intersect::PolygonIndex>& polygons,
                                               const std::vector<std::uint8_t>& marks) {
  if (marks.empty()) return polygons;
  std::vector<intersect::PolygonIndex> some;
  for (const intersect::PolygonIndex polygon : polygons) {
    const base::Corners v = base::cornersOf(mesh, polygon);
    if (std::any_of(v.begin(), v.end(), [&](VertexIndex i) { return marks[i] != 0; })) {
      some.push_back(polygon);
    }
  }
  return some;
}

// Makes small changes to what is not of the uniform mesh; pairs that these do not help are left.
// Uniform vertices stay, as the uniform mesh is free of pairs where all cells are split. Vertices
// of larger cells have no mass point, so they fall back to where they are.
RepairReport repairCut(const Repair& repair, const octree::Cut& cut,
                       const std::vector<intersect::PolygonIndex>& candidates, Mesh& mesh,
                       base::Job& job) {
  Source source = repair.source;
  source.lastResort = false;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex vertex : vertices) points.push_back(mesh.positions[vertex]);
    return points;
  };
  source.isFixed = [&](VertexIndex vertex) { return cut.clusters[vertex].level == 0; };
  return repairRounded(mesh, candidates, std::move(source), *repair.affine, job);
}

}  // namespace

std::vector<intersect::PolygonIndex> candidatesOf(
    const octree::CutMesh& made, const octree::Cut& cut,
    const std::vector<std::uint32_t>& uniformCandidates, const std::vector<VertexIndex>& altered) {
  std::vector<std::uint8_t> other(cut.clusters.size());
  for (std::size_t i = 0; i < other.size(); ++i) other[i] = cut.clusters[i].level != 0 ? 1 : 0;
  for (const VertexIndex vertex : altered) other[vertex] = 1;
  std::vector<intersect::PolygonIndex> candidates;
  base::forPolygons(made.mesh, [&](base::PolygonIndex polygon, base::Corners v) {
    if (std::any_of(v.begin(), v.end(), [&](VertexIndex k) { return other[k] != 0; }) ||
        std::binary_search(uniformCandidates.begin(), uniformCandidates.end(),
                           made.sourceOf(polygon))) {
      candidates.push_back(polygon);
    }
  });
  return candidates;
}

void repairAndMeasure(distance::Certifier& certifier, const Repair* repair, Measured& mesh,
                      base::Job& job, const std::vector<std::uint8_t>& fresh) {
  if (repair != nullptr) {
    mesh.candidates = candidatesOf(mesh.made, mesh.cut, repair->candidates);
    mesh.repaired = repairCut(*repair, mesh.cut, withMarks(mesh.made.mesh, mesh.candidates, fresh),
                              mesh.made.mesh, job);
    const std::vector<VertexIndex> repaired =
        intersect::verticesOf(mesh.made.mesh, mesh.repaired.changed);
    mesh.altered.insert(mesh.altered.end(), repaired.begin(), repaired.end());
  }
  mesh.deviation = certifier.measure(mesh.cut, mesh.made, mesh.altered);
  mesh.meeting = intersect::verticesOf(mesh.made.mesh, intersect::polygonsOf(mesh.repaired.left));
}

}  // namespace tufa::refine
