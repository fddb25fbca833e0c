#pragma once

#include <vector>

#include "base/job.h"
#include "chunks/seams/polyline.h"
#include "chunks/seams/seams.h"
#include "octree/cluster_forest.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"

namespace tufa::chunks {

/// One side of a curve.
struct StripPlace {
  std::uint32_t curve = 0;  ///< in Seams::curves
  bool above = false;       ///< in the chunk above the face

  /// A number for each side of each curve.
  [[nodiscard]] std::size_t number() const { return std::size_t{2} * curve + (above ? 1 : 0); }
};

/// A flag for each side of each curve, by StripPlace::number(); empty: none is set.
using SideFlags = std::vector<std::uint8_t>;

/// The mesh of a cut, divided at the seams, with strips.
struct SeamedCut {
  octree::Cut cut;  ///< of the uniform mesh with the seams' vertices
  octree::CutMesh made;
  /// The strip of each of the last triangles; all other polygons are inside their chunks.
  std::vector<StripPlace> strips;
  VertexIndex clusterCount = 0;      ///< vertices from here on are on seams
  std::vector<SeamIndex> seamOf;     ///< of each of these
  std::vector<VertexIndex> altered;  ///< beside and on seams: not as in the uniform mesh
  SideFlags direct;                  ///< sides whose strips run as the arcs do, see stitch()

  /// The first triangle that is in a strip, counted among triangles and among all polygons.
  [[nodiscard]] std::size_t firstStrip() const {
    return made.mesh.triangles.size() - strips.size();
  }
  [[nodiscard]] std::size_t firstStripPolygon() const {
    return made.mesh.quads.size() + firstStrip();
  }
  [[nodiscard]] bool isOnSeam(VertexIndex vertex) const { return vertex >= clusterCount; }
  [[nodiscard]] SeamIndex seamAt(VertexIndex vertex) const { return seamOf[vertex - clusterCount]; }
};

/// The mesh of `cut`, a cut of the uniform mesh, with boundary polylines as in `lines` and strips
/// to them in the chunks to be made; strips of `direct` run as their arcs do. `vertexCells` has the
/// cell of each uniform vertex.
[[nodiscard]] SeamedCut meshWithSeams(const octree::ClusterForest& forest, octree::Cut cut,
                                      const Seams& seams, const SeamPolylines& lines,
                                      const std::vector<Coord>& vertexCells,
                                      const ChunkCells& chunks, const grid::Affine& affine,
                                      SideFlags direct, base::Job& job);

/// A triangle of a strip after vertices of its mesh were joined.
struct StripLeft {
  std::size_t strip = 0;  ///< its index in SeamedCut::strips
  Triangle triangle;      ///< in the mesh as it is now
};

/// The triangles in strips of `before` that still have three distinct vertices, in order; `now` is
/// a cut of the same uniform vertices.
[[nodiscard]] std::vector<StripLeft> stripsLeft(const SeamedCut& before, const octree::Cut& now);

/// The inside of `mesh` with the polylines of `before`, which shared all but polylines and strips
/// with what became `mesh` by joining vertices. Strips are what remains of those of `before`; where
/// that would use an edge more than twice, as may happen along a closed curve, they are built
/// again.
[[nodiscard]] SeamedCut withStripsOf(const SeamedCut& before, const SeamedCut& mesh,
                                     const Seams& seams, const SeamPolylines& lines,
                                     const ChunkCells& chunks);

/// Moves the vertices of clusters off the faces of their chunks.
void keepInChunks(const std::vector<Coord>& vertexCells, const ChunkCells& chunks,
                  const grid::Affine& affine, SeamedCut& mesh);

}  // namespace tufa::chunks
