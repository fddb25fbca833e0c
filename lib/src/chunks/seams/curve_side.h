#pragma once

#include <tufa/chunks.h>
#include <algorithm>
#include <utility>

#include "chunks/seams/polyline.h"
#include "chunks/seams/seams.h"

namespace tufa::chunks {

/// One side of a curve in the order of the chunk there. tileOf(uniform vertex) and vertexOf(seam
/// vertex) give the indices that this side has for them.
template <class TileOf, class VertexOf>
[[nodiscard]] ChunkSeam sideOf(const SeamCurve& curve, bool above, const Seams& seams,
                               const SeamPolylines& lines, const TileOf& tileOf,
                               const VertexOf& vertexOf) {
  ChunkSeam side;
  for (const SeamIndex arc : curve.arcs) {
    side.tiles.push_back(tileOf(above ? seams.arcs[arc].above : seams.arcs[arc].below));
    side.polyline.push_back(vertexOf(lines[arc]));
  }
  if (curve.begin != kNoSeam) side.begin = vertexOf(curve.begin);
  if (curve.end != kNoSeam) side.end = vertexOf(curve.end);
  side.closed = curve.closed;
  if (above) {
    std::reverse(side.tiles.begin(), side.tiles.end());
    std::reverse(side.polyline.begin(), side.polyline.end());
    std::swap(side.begin, side.end);
  }
  return side;
}

}  // namespace tufa::chunks
