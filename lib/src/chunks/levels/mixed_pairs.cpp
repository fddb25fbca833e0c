#include "chunks/levels/mixed_pairs.h"

#include "base/single_precision.h"

namespace tufa::chunks {
namespace {

// The face of its chunk that a strip is on.
struct Face {
  Coord chunk;
  int number;
};

Face faceOf(const StripPlace& place, const Seams& seams) {
  const SeamCurve& curve = seams.curves[place.curve];
  Coord chunk = curve.chunk;
  if (!place.above) --chunk[curve.axis];
  return {chunk, 2 * curve.axis + (place.above ? 0 : 1)};
}

}  // namespace

std::vector<intersect::PolygonPair> findMixedPairs(const SeamedCut& regular,
                                                   const SeamedCut& transition, const Seams& seams,
                                                   const std::vector<Position>& seamPositions,
                                                   const grid::Affine& affine, bool singlePrecision,
                                                   base::Job& job) {
  // The strips of both meshes as one mesh; a vertex on a seam is the same in both.
  Mesh strips;
  const auto seamBegin = static_cast<VertexIndex>(regular.clusterCount);
  const auto addPosition = [&](const Position& p) {
    strips.positions.push_back(singlePrecision ? base::toSingle(p) : p);
  };
  for (VertexIndex i = 0; i < seamBegin; ++i) {
    addPosition(affine.toWorld(regular.made.mesh.positions[i]));
  }
  for (const Position& p : seamPositions) addPosition(p);
  std::vector<Face> faces;
  const auto addStrips = [&](const SeamedCut& mesh) {
    const std::size_t first = mesh.firstStrip();
    for (std::size_t i = 0; i < mesh.strips.size(); ++i) {
      Triangle triangle = mesh.made.mesh.triangles[first + i];
      for (VertexIndex& vertex : triangle.vertices) {
        if (mesh.isOnSeam(vertex)) vertex = seamBegin + mesh.seamAt(vertex);
      }
      strips.triangles.push_back(triangle);
      faces.push_back(faceOf(mesh.strips[i], seams));
    }
  };
  addStrips(regular);
  const auto count = static_cast<intersect::PolygonIndex>(regular.strips.size());
  addStrips(transition);
  std::vector<intersect::PolygonIndex> candidates;
  for (auto i = count; i < strips.triangles.size(); ++i) candidates.push_back(i);
  const intersect::Surface surface(strips, job);
  std::vector<intersect::PolygonPair> pairs = intersect::findPairs(
      surface, candidates, job, [&](intersect::PolygonIndex a, intersect::PolygonIndex b) {
        return (a < count) != (b < count) && faces[a].number != faces[b].number &&
               faces[a].chunk == faces[b].chunk;
      });
  for (intersect::PolygonPair& pair : pairs) {
    pair.a += static_cast<intersect::PolygonIndex>(regular.firstStripPolygon());
    pair.b += static_cast<intersect::PolygonIndex>(transition.firstStripPolygon()) - count;
  }
  return pairs;
}

}  // namespace tufa::chunks
