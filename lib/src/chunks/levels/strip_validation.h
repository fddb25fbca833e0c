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

/// Tries lines with the finest strips there are: those between them and the base mesh's own
/// vertices, as it was before the repair. Lines that are sound with these can be had without
/// intersections, whatever else the chunks beside them are like, as their cells can be split down
/// to such strips. Depends on what is near the face alone.
class StripValidation {
 public:
  /// `before` is the base mesh before its repair; it and the seams must outlive the trial.
  /// `vertexCells` has the cell of each of its vertices.
  StripValidation(const Mesh& before, const Seams& seams, const std::vector<Coord>& vertexCells,
                  const ChunkCells& chunks, const grid::Affine& affine, base::Job& job);

  /// A trial of the curves `begin` to `end`, which are those of one face. Where lines may be `far`
  /// from the base mesh's own curves they meet polygons that larger cells will not have: then
  /// triangles that meet others count as folded ones do.
  [[nodiscard]] FaceValidation ofFace(std::size_t begin, std::size_t end, bool far) const;

 private:
  using StripCorners = std::array<VertexIndex, 3>;
  // What was seen of a side of a face in the trials before.
  struct Seen {
    std::vector<StripCorners> triangles;                     ///< sorted
    std::vector<std::pair<StripCorners, StripCorners>> met;  ///< of pairs; a polygon that is not of
                                                             ///< a strip is like the other one
  };
  void lookAtSide(std::size_t begin, std::size_t end, bool above, const SeamPolylines& lines,
                  Seen& seen, LineFaults& faults) const;

  const std::vector<Quad>& quads_;
  const Seams& seams_;
  base::Job& job_;
  std::vector<Position> positions_;  ///< of the base vertices, then of those on seams
  /// Base vertices beside faces, each with the base quads at it that lie in one chunk; sorted.
  std::vector<std::pair<VertexIndex, std::uint32_t>> quadsAt_;
};

}  // namespace tufa::chunks
