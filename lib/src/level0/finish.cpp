#include "level0/finish.h"

#include <algorithm>

#include "base/single_precision.h"
#include "vertices/place_vertices.h"

namespace tufa::level0 {
namespace {

// Asks `base` about the elements that some elements of a mesh come from: sorted and distinct, as it
// wants them. `points` are the answers for elements without such an origin.
template <class Ask>
void askOrigins(const Ask& ask, const std::vector<std::uint32_t>& origins,
                std::vector<Position>& points) {
  std::vector<std::uint32_t> sorted;
  for (const std::uint32_t origin : origins) {
    if (origin != forest::kNone) sorted.push_back(origin);
  }
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  const std::vector<Position> answers = ask(sorted);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i] == forest::kNone) continue;
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), origins[i]);
    points[i] = answers[static_cast<std::size_t>(at - sorted.begin())];
  }
}

// What mending asks of a mesh in world space.
template <class TreeT>
mend::Source worldSource(const Level0<TreeT>& level0, const Origins& origins, const Mesh& mesh,
                         base::Job& job) {
  const mend::Source base = level0.source(job);
  const base::Affine& affine = level0.affine();
  const auto toWorld = [&affine](std::vector<Position> points) {
    for (Position& point : points) point = affine.toWorld(point);
    return points;
  };
  mend::Source source = base;
  source.massPoints = [base, toWorld, &origins, &mesh](const std::vector<VertexIndex>& vertices) {
    if (origins.vertices.empty()) return toWorld(base.massPoints(vertices));
    std::vector<Position> points;
    std::vector<std::uint32_t> own;
    for (const VertexIndex vertex : vertices) {
      points.push_back(mesh.positions[vertex]);
      own.push_back(origins.vertices[vertex]);
    }
    askOrigins([&](const std::vector<VertexIndex>& some) { return toWorld(base.massPoints(some)); },
               own, points);
    return points;
  };
  source.crossings = [base, toWorld, &origins](const std::vector<mend::PolygonIndex>& polygons) {
    if (origins.quads.empty()) return toWorld(base.crossings(polygons));
    std::vector<std::uint32_t> own;
    for (const mend::PolygonIndex polygon : polygons) own.push_back(origins.quads[polygon]);
    std::vector<Position> points(own.size());
    askOrigins(
        [&](const std::vector<std::uint32_t>& some) { return toWorld(base.crossings(some)); }, own,
        points);
    return points;
  };
  return source;
}

}  // namespace

template <class TreeT>
void finishMesh(const Level0<TreeT>& level0, const ContourOptions& options, const Origins& origins,
                const std::vector<mend::PolygonIndex>& suspects, Mesh& mesh, ContourReport& report,
                base::Job& job) {
  const base::Affine& affine = level0.affine();
  job.forRanges(mesh.positions.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = affine.toWorld(mesh.positions[i]);
  });
  const bool single = base::roundToSingle(mesh, kMostRounding * affine.leastHeight(), job);
  if (options.repair) {
    mend::Source source = worldSource(level0, origins, mesh, job);
    source.singlePrecision = single;
    const mend::MendReport mended = mend::mend(mesh, suspects, source, job);
    report.intersectionsLeft = mended.left.size();
    report.movedVertices += mended.movedVertices;
    report.turnedQuads += mended.turnedQuads;
    report.fannedQuads += mended.fannedQuads;
  }
  if (options.normals == Normals::Faces) vertices::setFaceNormals(mesh, job);
  if (options.normals == Normals::None) mesh.normals = {};
}

template void finishMesh(const Level0<openvdb::FloatTree>&, const ContourOptions&, const Origins&,
                         const std::vector<mend::PolygonIndex>&, Mesh&, ContourReport&, base::Job&);
template void finishMesh(const Level0<openvdb::DoubleTree>&, const ContourOptions&, const Origins&,
                         const std::vector<mend::PolygonIndex>&, Mesh&, ContourReport&, base::Job&);

}  // namespace tufa::level0
