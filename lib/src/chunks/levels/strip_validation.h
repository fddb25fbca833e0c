#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/job.h"
#include "chunks/seams/chunk_cells.h"
#include "chunks/seams/polyline.h"
#include "chunks/seams/seams.h"

namespace tufa::chunks {

/// Validates boundary polylines with the finest strips there are: those to the vertices of the
/// uniform mesh itself, before its repair. Both chunks at a face must choose the same polyline
/// without seeing each other, so it cannot be repaired later. If it is sound with these strips,
/// every chunk can reach strips without intersections by splitting its cells down to them. Depends
/// on what is near the face alone.
class StripValidation {
 public:
  /// `before` is the uniform mesh before its repair; it and the seams must outlive this object.
  /// `vertexCells` has the cell of each of its vertices.
  StripValidation(const Mesh& before, const Seams& seams, const std::vector<Coord>& vertexCells,
                  const ChunkCells& chunks, const grid::Affine& affine, base::Job& job);

  /// A validation of the curves `begin` to `end`, which are those of one face. Polylines that may
  /// be `far` from the uniform mesh's own curves intersect polygons that larger cells will not
  /// have; then triangles that intersect others count as folded ones do.
  [[nodiscard]] FaceValidation ofFace(std::size_t begin, std::size_t end, bool far) const;

 private:
  using StripCorners = std::array<VertexIndex, 3>;
  // What earlier validations found on one side of a face.
  struct Seen {
    std::vector<StripCorners> triangles;                     ///< sorted
    std::vector<std::pair<StripCorners, StripCorners>> met;  ///< pairs; for a polygon that is not
                                                             ///< of a strip, the other one again
  };
  void lookAtSide(std::size_t begin, std::size_t end, bool above, const SeamPolylines& lines,
                  Seen& seen, LineFaults& faults) const;

  const std::vector<Quad>& quads_;
  const Seams& seams_;
  base::Job& job_;
  std::vector<Position> positions_;  ///< of the uniform vertices, then of those on seams
  /// Uniform vertices beside faces, each with the uniform quads at it that lie in one chunk;
  /// sorted.
  std::vector<std::pair<VertexIndex, std::uint32_t>> quadsAt_;
};

}  // namespace tufa::chunks
