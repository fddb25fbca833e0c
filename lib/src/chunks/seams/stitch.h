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
/// sequences of steps, now on one side, now on the other, it takes one without folded triangles, if
/// there is one, and of these the one with the shortest edges across, found by dynamic programming
/// as for surfaces between contours (Fuchs, Kedem and Uselton 1977). If all sequences fold,
/// vertices of the chunk that lie behind their neighbours are first cut off by a triangle of their
/// own, where `mayJoin` lets the neighbours be joined.
///
/// Promised: each outer edge of the strip gets one triangle, no edge across more than two, and the
/// ends on chunk edges are joined to the vertices beside them alone, so strips of different faces
/// share no edge. `several`: a vertex of the chunk may occur more than once; then edges run as the
/// arcs do. Positions and normals are those of the vertices that the seam names. Cost: the product
/// of both lengths at most; pairs dearer than the way along the arcs are skipped.
[[nodiscard]] std::vector<StripTriangle> stitch(
    const ChunkSeam& seam, bool several, std::span<const Position> positions,
    std::span<const Normal> normals,
    const std::function<bool(VertexIndex, VertexIndex)>& mayJoin = nullptr);

/// Whether a triangle of a strip faces away from the surface at its corners.
[[nodiscard]] bool isFolded(const Triangle& triangle, std::span<const Position> positions,
                            std::span<const Normal> normals);

}  // namespace tufa::chunks
