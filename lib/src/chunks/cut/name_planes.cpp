#include "chunks/cut/name_planes.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "base/ranked_bits.h"

namespace tufa::chunks {
namespace {

// Of the chunks around a vertex, along an axis.
struct Range {
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  std::int32_t greatest = std::numeric_limits<std::int32_t>::min();
};

// Of each of some vertices.
std::vector<std::array<Range, 3>> chunksAround(const CutMesh& cut, const base::RankedBits& some,
                                               base::Job& job) {
  std::vector<std::array<Range, 3>> around(some.size());
  for (std::size_t t = 0; t < cut.chunkOf.size(); ++t) {
    job.pollCancelled(t);
    const Coord& chunk = cut.chunks[cut.chunkOf[t]];
    for (const VertexIndex v : cut.mesh.triangles[t].vertices) {
      if (!some.has(v)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Range& range = around[some.rank(v)][axis];
        const std::int32_t at = chunk[static_cast<int>(axis)];
        range.greatest = std::max(range.greatest, at);
        range.least = std::min(range.least, at);
      }
    }
  }
  return around;
}

bool isOnPlane(Place place) { return (place & 1) == 0; }

}  // namespace

void namePlanes(const std::vector<PlacesAmongPlanes>& places, CutMesh& cut, base::Job& job) {
  base::RankedBits onPlanes(places.size());
  for (std::size_t v = 0; v < places.size(); ++v) {
    job.pollCancelled(v);
    if (std::any_of(places[v].begin(), places[v].end(), isOnPlane)) onPlanes.add(v);
  }
  onPlanes.count();
  const std::vector<std::array<Range, 3>> around = chunksAround(cut, onPlanes, job);
  std::unordered_map<std::int64_t, std::uint32_t> numbers;
  onPlanes.forAll([&](std::size_t v) {
    std::array<std::uint32_t, 3> planes = {ChunkPlane::kNone, ChunkPlane::kNone, ChunkPlane::kNone};
    std::size_t count = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Place place = places[v][static_cast<std::size_t>(axis)];
      const Range& range = around[onPlanes.rank(v)][static_cast<std::size_t>(axis)];
      if (!isOnPlane(place) || range.least >= range.greatest) continue;
      const std::int64_t n = place / 2;
      const auto [found, isNew] =
          numbers.emplace(3 * n + axis, static_cast<std::uint32_t>(cut.planes.size()));
      if (isNew) cut.planes.push_back({axis, static_cast<std::int32_t>(n)});
      planes[count++] = found->second;
    }
    if (count == 0) return;
    cut.onPlanes.push_back(static_cast<VertexIndex>(v));
    cut.planesOf.push_back(planes);
  });
}

}  // namespace tufa::chunks
