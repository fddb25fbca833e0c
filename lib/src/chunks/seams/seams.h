#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "chunks/seams/chunk_cells.h"
#include "grid/affine.h"
#include "octree/cluster_forest.h"
#include "uniform/quads.h"

namespace tufa::chunks {

/// A vertex on a face between chunks, where the uniform mesh passes it. It depends on what is near
/// the face alone, so all chunks there compute the same bits.
struct SeamVertex {
  Coord cell;     ///< lattice point
  Vec3 offset;    ///< from it, in lattice steps
  Normal normal;  ///< outward unit normal, world space
};

/// Index among Seams::vertices.
using SeamIndex = std::uint32_t;
inline constexpr SeamIndex kNoSeam = octree::kNone;

/// An arc: where an edge of the uniform mesh passes the face of a cell between two chunks; or where
/// the diagonal of a quad does, if that makes a corner of the curve.
struct Arc {
  VertexIndex below = 0;   ///< uniform vertex in the cell below the face
  VertexIndex above = 0;   ///< uniform vertex in the cell above it
  std::uint32_t quad = 0;  ///< a uniform quad that it is an edge or the diagonal of
  bool single = true;      ///< the only arc in its cell face
  /// How far uniform vertices up to 1, 2, 4 and 5 steps from the arc lie off the tangent plane
  /// through it, world units.
  std::array<float, 4> flatness{};
  /// Distance to where the surface passes the same face and faces the other way, world units;
  /// infinite if that is nowhere within eight cells.
  float clearance = std::numeric_limits<float>::infinity();
};

/// A curve along which the surface passes the face between two chunks: a sequence of arcs. The
/// surface in the lower chunk lies to its right, seen from outside.
struct SeamCurve {
  int axis = 0;                 ///< across the face
  Coord chunk;                  ///< the one above the face
  std::vector<SeamIndex> arcs;  ///< the same one first for both chunks
  SeamIndex begin = kNoSeam;    ///< vertex on a chunk edge before the first arc, if any
  SeamIndex end = kNoSeam;      ///< vertex on a chunk edge behind the last arc, if any
  bool closed = false;          ///< the last arc is followed by the first
};

/// Calls body(begin, end) for the range of curves on each face.
template <class Body>
void forFaces(const std::vector<SeamCurve>& curves, const Body& body) {
  for (std::size_t begin = 0, end = 0; begin < curves.size(); begin = end) {
    while (end < curves.size() && curves[end].axis == curves[begin].axis &&
           curves[end].chunk == curves[begin].chunk) {
      ++end;
    }
    body(begin, end);
  }
}

/// Where the uniform mesh of some chunks is divided along their faces. There is a vertex for each
/// arc, and one for each point in which the surface crosses a chunk edge.
struct Seams {
  std::vector<SeamVertex> vertices;  ///< arcs first, then points on chunk edges
  std::vector<Arc> arcs;
  std::vector<SeamCurve> curves;  ///< sorted by axis, chunk and first arc
  Mesh mesh;                      ///< the uniform mesh, the seams' vertices behind its own
  /// The uniform quads: those inside one chunk to be made as they are, all others empty (four times
  /// the same vertex).
  std::vector<Quad> quads;
  std::vector<VertexIndex>
      beside;  ///< uniform vertices of chunks to be made at divided quads; sorted
};

/// Finds the seams of the chunks to be made. `vertexCells` has the cell of each uniform vertex,
/// `before` the positions of `base` before its repair.
///
/// Promised: whichever chunks are made, both sides of a face get the same vertices, bit for bit,
/// and the same curves: everything is computed from samples and unrepaired vertices near the face,
/// in lattice coordinates, and ordered by place. Curves end on chunk edges, at the end of the data,
/// or are closed. They do not cross, as far as moving vertices to fallback positions helps. Cost:
/// one pass over the quads; the rest grows with the number of arcs.
[[nodiscard]] Seams findSeams(const uniform::SurfaceView& context, const Mesh& base,
                              const Mesh& before, const std::vector<Coord>& vertexCells,
                              const ChunkCells& chunks, base::Job& job);

/// The world positions of the seams' vertices as they are written: computed from the lattice, so
/// that they do not depend on the region.
[[nodiscard]] std::vector<Position> worldPositions(const Seams& seams,
                                                   const grid::Transform& transform,
                                                   bool singlePrecision);

}  // namespace tufa::chunks
