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

/// A vertex on the faces between chunks: where the base mesh passes them. Made from what is near
/// the face alone: the same bits whichever of the chunks asks.
struct SeamVertex {
  Coord cell;     ///< lattice point
  Vec3 offset;    ///< from it, in lattice steps
  Normal normal;  ///< outward unit normal, world space
};

/// Names an element of Seams::vertices.
using SeamIndex = std::uint32_t;
inline constexpr SeamIndex kNoSeam = octree::kNone;

/// A stretch of surface in a face of one cell, where the face lies between two chunks: an edge of
/// the base mesh passes the face there. Or the diagonal of a quad that passes such a face, where
/// that makes a corner of the curve.
struct Arc {
  VertexIndex below = 0;   ///< base vertex in the cell below the face
  VertexIndex above = 0;   ///< base vertex in the cell above it
  std::uint32_t quad = 0;  ///< a base quad that it is a side or the diagonal of
  bool single = true;      ///< the only arc in its cell face
  /// How far base vertices beside the arc lie off the plane through it, in world units: those up to
  /// 1, 2, 4 and 5 steps away.
  std::array<float, 4> flatness{};
  /// How far it is, in world units, to where the surface passes the same face and faces the other
  /// way; infinite if that is nowhere within eight cells.
  float clearance = std::numeric_limits<float>::infinity();
};

/// A curve in which the surface passes the face between two chunks: arcs one behind the other. The
/// lower chunk's surface lies to the right of it, seen from outside.
struct SeamCurve {
  int axis = 0;                 ///< across the face
  Coord chunk;                  ///< the one above the face
  std::vector<SeamIndex> arcs;  ///< seen from either side, the same one first
  SeamIndex begin = kNoSeam;    ///< vertex on a chunk edge before the first arc, if any
  SeamIndex end = kNoSeam;      ///< vertex on a chunk edge behind the last arc, if any
  bool closed = false;          ///< the last arc is followed by the first
};

/// Calls body(begin, end) for the curves of each face, which are one behind the other.
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

/// Where the base mesh of some chunks is parted along their faces. A vertex stands for each arc,
/// and one for each point in which the surface crosses a chunk edge.
struct Seams {
  std::vector<SeamVertex> vertices;  ///< arcs first, then points on chunk edges
  std::vector<Arc> arcs;
  std::vector<SeamCurve> curves;  ///< sorted by axis, chunk and first arc
  Mesh mesh;                      ///< the base mesh, the seams' vertices behind its own
  /// The base quads: those of one chunk to be made as they are, nothing (four times the same
  /// vertex) of the others.
  std::vector<Quad> quads;
  std::vector<VertexIndex> beside;  ///< base vertices of chunks to be made at parted quads; sorted
};

/// Finds the seams of the chunks to be made. `vertexCells` has the cell of each base vertex,
/// `before` the positions of `base` before its repair.
[[nodiscard]] Seams findSeams(const uniform::SurfaceView& context, const Mesh& base,
                              const Mesh& before, const std::vector<Coord>& vertexCells,
                              const ChunkCells& chunks, base::Job& job);

/// The world positions of the seams' vertices as they are written. Straight from the lattice, so
/// that they do not depend on the region.
[[nodiscard]] std::vector<Position> worldPositions(const Seams& seams,
                                                   const grid::Transform& transform,
                                                   bool singlePrecision);

}  // namespace tufa::chunks
