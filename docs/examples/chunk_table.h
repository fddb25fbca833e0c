#pragma once

#include <tufa/chunks.h>

#include <array>
#include <cstdint>
#include <vector>

/// One LOD of a chunk as an engine keeps it: all parts in one index buffer, over the chunk's
/// vertices. Part p is from begin[p] to begin[p + 1]: the interior, six regular strips, six
/// transition strips.
struct ChunkTable {
  std::vector<std::uint32_t> indices;
  std::array<std::size_t, 14> begin{};

  explicit ChunkTable(const tufa::ChunkLevel& level) {
    add(0, level.interior);
    for (std::size_t face = 0; face < 6; ++face) add(1 + face, level.regular[face]);
    for (std::size_t face = 0; face < 6; ++face) add(7 + face, level.transition[face]);
  }
  void add(std::size_t part, const std::vector<tufa::Triangle>& triangles) {
    for (const tufa::Triangle& t : triangles) {
      indices.insert(indices.end(), t.vertices.begin(), t.vertices.end());
    }
    begin[part + 1] = indices.size();
  }

  /// Calls draw(first index, number of indices): once for the interior, and for each face once for
  /// the strip that the face's bit of the mask says.
  template <class Draw>
  void draw(unsigned mask, Draw&& draw) const {
    draw(begin[0], begin[1] - begin[0]);
    for (std::size_t face = 0; face < 6; ++face) {
      const std::size_t part = (mask >> face & 1) != 0 ? 7 + face : 1 + face;
      if (begin[part + 1] > begin[part]) draw(begin[part], begin[part + 1] - begin[part]);
    }
  }
};
