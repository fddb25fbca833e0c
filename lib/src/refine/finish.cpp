#include "refine/finish.h"

#include <algorithm>
#include <iterator>

#include "base/collect.h"
#include "base/sort_unique.h"
#include "refine/rounding.h"
#include "refine/uniform_repair.h"
#include "uniform/place_vertices.h"

namespace tufa::refine {
namespace {

// Calls `ask` for the elements of the uniform mesh that some elements of a mesh come from, sorted
// and distinct as it needs them. `points` holds the answers for elements without such an origin.
template <class Ask>
void askOrigins(const Ask& ask, const std::vector<std::uint32_t>& origins,
                std::vector<Position>& points) {
  std::vector<std::uint32_t> sorted;
  for (const std::uint32_t origin : origins) {
    if (origin != octree::kNone) sorted.push_back(origin);
  }
  base::sortUnique(sorted);
  const std::vector<Position> answers = ask(sorted);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i] == octree::kNone) continue;
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), origins[i]);
    points[i] = answers[static_cast<std::size_t>(at - sorted.begin())];
  }
}

// The source of a mesh in world space. Vertices of larger cells stay where they are.
Source worldSource(SurfaceModel& model, const ExtractedMesh& extracted, base::Job& job) {
  const Source base = sourceOf(model.withCells(job), job);
  const grid::Affine& affine = model.affine();
  const auto toWorld = [&affine](std::vector<Position> points) {
    for (Position& point : points) point = affine.toWorld(point);
    return points;
  };
  Source source = base;
  source.massPoints = [base, toWorld, &extracted](const std::vector<VertexIndex>& vertices) {
    if (extracted.baseVertices.empty()) return toWorld(base.massPoints(vertices));
    std::vector<Position> points;
    std::vector<std::uint32_t> own;
    for (const VertexIndex vertex : vertices) {
      points.push_back(extracted.mesh.positions[vertex]);
      own.push_back(extracted.baseVertices[vertex]);
    }
    askOrigins([&](const std::vector<VertexIndex>& some) { return toWorld(base.massPoints(some)); },
               own, points);
    return points;
  };
  source.crossings = [base, toWorld,
                      &extracted](const std::vector<intersect::PolygonIndex>& polygons) {
    if (extracted.baseQuads.empty()) return toWorld(base.crossings(polygons));
    std::vector<std::uint32_t> own;
    for (const intersect::PolygonIndex polygon : polygons)
      own.push_back(extracted.baseQuads[polygon]);
    std::vector<Position> points(own.size());
    askOrigins(
        [&](const std::vector<std::uint32_t>& some) { return toWorld(base.crossings(some)); }, own,
        points);
    return points;
  };
  return source;
}

// The candidates for what intersects now that the mesh is rounded.
std::vector<intersect::PolygonIndex> candidatesOf(const ExtractedMesh& extracted, base::Job& job) {
  const std::vector<intersect::PolygonIndex> close =
      intersect::distinctPolygonsOf(intersect::intersectingAmong(
          extracted.closePairs, extracted.mesh, extracted.mesh.positions, job));
  std::vector<intersect::PolygonIndex> candidates;
  std::set_union(close.begin(), close.end(), extracted.candidates.begin(),
                 extracted.candidates.end(), std::back_inserter(candidates));
  return candidates;
}

// Normals of length 1 where gradients or faces cancel: those of the faces around by area, and of
// any direction where these cancel, too.
void replaceZeroNormals(Mesh& mesh, base::Job& job) {
  const std::vector<VertexIndex> without =
      base::collectIf(job, mesh.normals.size(),
                      [&](VertexIndex v) { return Vec3(mesh.normals[v]).squaredLength() == 0; });
  if (without.empty()) return;
  std::vector<Vec3> sums(without.size(), Vec3(0));
  const auto add = [&](VertexIndex v, const Vec3& normal) {
    const auto at = std::lower_bound(without.begin(), without.end(), v);
    if (at != without.end() && *at == v) sums[at - without.begin()] += normal;
  };
  for (const Triangle& t : triangulate(mesh)) {
    const auto& [a, b, c] = t.vertices;
    const Vec3 p(mesh.positions[a]), q(mesh.positions[b]), r(mesh.positions[c]);
    for (const VertexIndex v : t.vertices) add(v, (q - p).cross(r - p));
  }
  for (std::size_t i = 0; i < without.size(); ++i)
    mesh.normals[without[i]] = Normal(sums[i].unitOrX());
}

}  // namespace

double finishMesh(SurfaceModel& model, const ContourOptions& options, ExtractedMesh& extracted,
                  ContourReport& report, base::Job& job) {
  const grid::Affine& affine = model.affine();
  Mesh& mesh = extracted.mesh;
  double moved = 0;
  const bool single = takeToWorld(mesh, affine, job);
  const std::vector<intersect::PolygonIndex> candidates =
      options.repair ? candidatesOf(extracted, job) : std::vector<intersect::PolygonIndex>();
  if (options.repair) report.intersectionsLeft = 0;
  if (!candidates.empty()) {
    Source source = worldSource(model, extracted, job);
    source.singlePrecision = single;
    const RepairReport repaired = repairIntersections(mesh, candidates, source, job);
    report.intersectionsLeft = repaired.left.size();
    report.movedVertices += repaired.movedVertices;
    report.flippedDiagonals += repaired.flippedDiagonals;
    report.fannedQuads += repaired.fannedQuads;
    for (const auto& [vertex, from] : repaired.moved) {
      moved = std::max(moved, (Vec3(mesh.positions[vertex]) - Vec3(from)).length());
    }
  }
  if (options.normals == Normals::Faces) uniform::setFaceNormals(mesh, job);
  if (options.normals == Normals::None) mesh.normals = {};
  replaceZeroNormals(mesh, job);
  return moved / affine.voxelSize();
}

}  // namespace tufa::refine
