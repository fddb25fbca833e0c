#include "chunks/cut/name_planes.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

namespace tufa::chunks {
namespace {

// Of the chunks around a vertex, along an axis.
struct Range {
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  std::int32_t greatest = std::numeric_limits<std::int32_t>::min();
};

std::vector<std::array<Range, 3>> chunksAround(const CutMesh& cut, std::size_t vertices) {
  std::vector<std::array<Range, 3>> around(vertices);
  for (std::size_t t = 0; t < cut.chunkOf.size(); ++t) {
    const Coord& chunk = cut.chunks[cut.chunkOf[t]];
    for (const VertexIndex v : cut.mesh.triangles[t].vertices) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Range& range = around[v][axis];
        const std::int32_t at = chunk[static_cast<int>(axis)];
        range.greatest = std::max(range.greatest, at);
        range.least = std::min(range.least, at);
      }
    }
  }
  return around;
}

}  // namespace

void namePlanes(const std::vector<PlacesAmongPlanes>& places, CutMesh& cut) {
  const std::vector<std::array<Range, 3>> around = chunksAround(cut, places.size());
  constexpr std::array<std::uint32_t, 3> kNone = {ChunkPlane::kNone, ChunkPlane::kNone,
                                                  ChunkPlane::kNone};
  cut.planesOf.assign(places.size(), kNone);
  std::unordered_map<std::int64_t, std::uint32_t> numbers;
  for (std::size_t v = 0; v < places.size(); ++v) {
    std::size_t count = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Place place = places[v][static_cast<std::size_t>(axis)];
      const Range& range = around[v][static_cast<std::size_t>(axis)];
      if ((place & 1) != 0 || range.least >= range.greatest) continue;
      const std::int64_t n = place / 2;
      const auto [found, isNew] =
          numbers.emplace(3 * n + axis, static_cast<std::uint32_t>(cut.planes.size()));
      if (isNew) cut.planes.push_back({axis, static_cast<std::int32_t>(n)});
      cut.planesOf[v][count++] = found->second;
    }
  }
}

}  // namespace tufa::chunks
