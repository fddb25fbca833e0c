#pragma once

#include <tufa/chunks.h>
#include <functional>
#include <span>
#include <vector>

namespace tufa::chunks {

/// A triangle of a strip, and the number of an arc near it.
struct StripTriangle {
  Triangle triangle;
  std::size_t arc = 0;
};

/// Fills the strip between the vertices inside a chunk and those on its face with triangles. Of all
/// ways to advance now on one side, now on the other, takes one without folded triangles, if there
/// is one, and of these the one with the shortest edges across. If there is none, vertices of the
/// chunk that stand back behind their neighbours are first cut off by a triangle of their own,
/// where `mayJoin` lets the neighbours be joined.
///
/// Each of the strip's outer edges gets one triangle, no edge across more than two, and the ends on
/// chunk edges are joined to the vertices beside them alone. `several`: a vertex of the chunk may
/// come up more than once; then edges run as the arcs do. Positions and normals are of the vertices
/// that the seam names.
[[nodiscard]] std::vector<StripTriangle> stitch(
    const ChunkSeam& seam, bool several, std::span<const Position> positions,
    std::span<const Normal> normals,
    const std::function<bool(VertexIndex, VertexIndex)>& mayJoin = nullptr);

/// Whether a triangle of a strip faces away from the surface at its corners.
[[nodiscard]] bool isFolded(const Triangle& triangle, std::span<const Position> positions,
                            std::span<const Normal> normals);

}  // namespace tufa::chunks
