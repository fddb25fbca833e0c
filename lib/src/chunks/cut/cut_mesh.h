#pragma once

#include <tufa/coord.h>
#include <tufa/mesh.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "base/shared_array.h"
#include "chunks/cut/moved_vertex.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// A plane between chunks.
struct ChunkPlane {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  int axis = 0;         ///< it stands across
  std::int32_t at = 0;  ///< in chunks: between those of index at - 1 and at

  friend bool operator==(const ChunkPlane&, const ChunkPlane&) = default;
};

/// The uniform mesh, divided where it passes the planes between chunks; or LOD 0 in its place.
///
/// Each triangle lies in one chunk, its boundary included. What lies in a plane belongs to the
/// chunk on the solid's side.
struct CutMesh {
  Mesh mesh;  ///< triangles; positions as the uniform mesh's, whose vertices come first
  std::vector<Coord> chunks;                 ///< that have triangles, sorted
  base::SharedArray<std::uint32_t> chunkOf;  ///< of each triangle, a place in `chunks`
  std::vector<ChunkPlane> planes;            ///< by number
  /// The vertices on planes on both sides of which they have triangles, rising, and the numbers of
  /// these planes.
  std::vector<VertexIndex> onPlanes;
  std::vector<std::array<std::uint32_t, 3>> planesOf;
  /// The positions that distances are measured to, where some are others than the mesh's.
  std::vector<Position> reference;
  /// For each vertex whether it or a triangle at it is not as in the uniform mesh.
  std::vector<std::uint8_t> isNew;
  /// Whether a search has shown that no triangle with a new vertex intersects another one once
  /// positions are rounded.
  bool isSeparated = false;
  /// How far triangles at some vertices are from the uniform mesh at most, voxels: vertices were
  /// moved to planes, and edges collapsed and flipped. Rising.
  std::vector<MovedVertex> movedAt;
  /// How much farther they may be, and all others, voxels: vertices were moved apart, and to a
  /// lattice.
  double moved = 0;
  std::vector<double> errors;  ///< of LOD 0: the same for each chunk

  /// The planes of a vertex, kNone where there are fewer than three.
  [[nodiscard]] std::array<std::uint32_t, 3> planesAt(VertexIndex v) const {
    const auto found = std::lower_bound(onPlanes.begin(), onPlanes.end(), v);
    if (found == onPlanes.end() || *found != v) {
      return {ChunkPlane::kNone, ChunkPlane::kNone, ChunkPlane::kNone};
    }
    return planesOf[static_cast<std::size_t>(found - onPlanes.begin())];
  }
};

/// Cuts a mesh, positions counted from affine.origin(), into chunks of `size` voxels.
///
/// Vertices within half a hundredth of a voxel of a plane are moved to it unless that turns a
/// triangle: flat faces of parts often lie in such planes but for rounding, and would be shredded.
/// So are those within `flatDistance` voxels where the surface lies along the plane: the field is
/// off by that beside edges of faces.
/// Short edges that are cut where single precision, if positions are to be written in it, does not
/// tell their vertices apart are collapsed. Cost: linear, some 100 ns a triangle.
[[nodiscard]] CutMesh cutAtChunks(Mesh uniform, const grid::Affine& affine, int size,
                                  bool singlePrecision, double flatDistance, base::Job& job);

}  // namespace tufa::chunks
