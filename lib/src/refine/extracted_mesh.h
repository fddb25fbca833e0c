#pragma once

#include <tufa/mesh.h>

#include <cstdint>
#include <vector>

#include "intersect/surface.h"

namespace tufa::refine {

/// A mesh taken from a surface model, and where its elements come from.
struct ExtractedMesh {
  Mesh mesh;
  /// Uniform vertex of each vertex, kNone for one of a larger cell. Empty: the vertices are those
  /// of the uniform mesh.
  std::vector<VertexIndex> baseVertices;
  /// Uniform quad of each polygon, quads first. Empty: the polygons are those of the uniform mesh.
  std::vector<std::uint32_t> baseQuads;
  /// Each intersecting pair contains one of these polygons, or is one of these pairs. Sorted.
  std::vector<intersect::PolygonIndex> candidates;
  std::vector<intersect::PolygonPair> closePairs;
};

}  // namespace tufa::refine
