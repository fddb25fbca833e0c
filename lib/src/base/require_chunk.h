#pragma once

#include <tufa/chunk.h>
#include <cstddef>
#include <string>

namespace tufa::base {

/// "chunk (1, 0, -2)".
[[nodiscard]] std::string chunkText(const Coord& index);

/// Throws Error(InvalidArgument) unless all that an LOD of a chunk indexes is there, positions and
/// the next LOD's are finite, every curve has two ends, and each position has a normal and the
/// values of attributes.
void requireSound(const Chunk& chunk, std::size_t level);

}  // namespace tufa::base
