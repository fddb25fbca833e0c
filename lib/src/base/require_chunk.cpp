#include "base/require_chunk.h"

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <vector>

namespace tufa::base {
namespace {

bool areFinite(const std::vector<Position>& positions) {
  return std::all_of(positions.begin(), positions.end(), [](const Position& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  });
}

}  // namespace

std::string chunkText(const Coord& index) {
  return "chunk (" + std::to_string(index[0]) + ", " + std::to_string(index[1]) + ", " +
         std::to_string(index[2]) + ")";
}

void requireSound(const Chunk& chunk, std::size_t number) {
  const ChunkLevel& level = chunk.levels[number];
  const std::size_t count = level.positions.size();
  const auto require = [&](bool holds, const char* fault) {
    if (holds) return;
    throw Error(ErrorCode::InvalidArgument, chunkText(chunk.index) + " is not sound at level " +
                                                std::to_string(number) + ": " + fault);
  };
  const auto areThere = [&](const std::vector<VertexIndex>& vertices) {
    return std::all_of(vertices.begin(), vertices.end(), [&](VertexIndex v) { return v < count; });
  };
  const auto requireFaces = [&](const std::vector<Triangle>& triangles) {
    require(std::all_of(triangles.begin(), triangles.end(),
                        [&](const Triangle& t) {
                          return std::all_of(t.vertices.begin(), t.vertices.end(),
                                             [&](VertexIndex v) { return v < count; });
                        }),
            "a triangle has a vertex that is not there");
  };
  require(level.normals.size() == count, "positions and normals differ in number");
  require(areFinite(level.positions), "a position is not finite");
  for (const Attribute& attribute : level.attributes) {
    require(attribute.width > 0 &&
                attribute.values.size() == static_cast<std::size_t>(attribute.width) * count,
            "positions and values of an attribute differ in number");
  }
  requireFaces(level.interior);
  for (std::size_t face = 0; face < kChunkFaces; ++face) {
    requireFaces(level.regular[face]);
    requireFaces(level.transition[face]);
    for (const ChunkSeam& seam : level.seams[face]) {
      require(seam.vertices.size() >= 2, "a seam has fewer than two vertices");
      require(areThere(seam.vertices), "a seam has a vertex that is not there");
      require(areFinite(seam.next), "a seam goes to a position that is not finite");
    }
  }
}

}  // namespace tufa::base
