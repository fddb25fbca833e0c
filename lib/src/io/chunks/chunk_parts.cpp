#include "io/chunks/chunk_parts.h"

#include <array>
#include <utility>

namespace tufa::io {

const std::vector<Triangle>& partOf(const ChunkLevel& level, std::size_t part) {
  if (part == 0) return level.interior;
  return part <= kChunkFaces ? level.regular[part - 1] : level.transition[part - 1 - kChunkFaces];
}

std::vector<Triangle>& partOf(ChunkLevel& level, std::size_t part) {
  return const_cast<std::vector<Triangle>&>(partOf(std::as_const(level), part));
}

std::string partName(std::size_t part) {
  static constexpr std::array<const char*, kChunkFaces> kFaces{"-x", "+x", "-y", "+y", "-z", "+z"};
  if (part == 0) return "interior";
  return std::string("face") + kFaces[(part - 1) % kChunkFaces] +
         (part <= kChunkFaces ? ".regular" : ".transition");
}

std::size_t partNamed(const std::string& name) {
  std::size_t part = 0;
  while (part < kChunkParts && partName(part) != name) ++part;
  return part;
}

std::string chunkName(const Coord& index, std::size_t level) {
  std::string name = "chunk";
  for (int axis = 0; axis < 3; ++axis) name.append("_").append(std::to_string(index[axis]));
  return name + "_LOD" + std::to_string(level);
}

std::filesystem::path chunkIndexFile(const std::string& folder) {
  return std::filesystem::path(folder) / "chunks.json";
}

}  // namespace tufa::io
