#pragma once

#include <tufa/chunks.h>
#include <filesystem>
#include <string>

namespace tufa::io {

/// The parts of an LOD of a chunk by their numbers in files: 0 the interior, 1 to 6 the regular
/// strips, 7 to 12 those to coarser neighbours.
inline constexpr std::size_t kChunkParts = 1 + 2 * kChunkFaces;

[[nodiscard]] std::vector<Triangle>& partOf(ChunkLevel& level, std::size_t part);
[[nodiscard]] const std::vector<Triangle>& partOf(const ChunkLevel& level, std::size_t part);

/// "interior", "face-x.regular", ..., "face+z.transition".
[[nodiscard]] std::string partName(std::size_t part);

/// The part of that name; kChunkParts if there is none.
[[nodiscard]] std::size_t partNamed(const std::string& name);

/// "chunk_X_Y_Z_LODn".
[[nodiscard]] std::string chunkName(const Coord& index, std::size_t level);

/// The path of chunks.json.
[[nodiscard]] std::filesystem::path chunkIndexFile(const std::string& folder);

}  // namespace tufa::io
