#include "chunks/chain/mixed_forms.h"

#include <algorithm>
#include <mutex>

#include "base/box.h"
#include "base/bvh.h"
#include "intersect/triangle_pair.h"

namespace tufa::chunks {
namespace {

base::Box boxOf(const ChainLevel& level, const Triangle& t) {
  base::Box box = base::Box::empty();
  for (const VertexIndex v : t.vertices) box.add(Vec3(level.positions[v]));
  return box;
}

}  // namespace

std::uint32_t changingPlane(const ChainLevel& level, const Triangle& triangle, bool& isMixed) {
  std::uint32_t plane = ChunkPlane::kNone;
  isMixed = false;
  for (const VertexIndex v : triangle.vertices) {
    if (level.into[v] == v) continue;
    const std::uint32_t own = level.intoPlane[v];
    isMixed |= plane != ChunkPlane::kNone && plane != own;
    plane = own;
  }
  return plane;
}

std::vector<std::array<std::uint32_t, 2>> findMixedForms(const ChainLevel& level, base::Job& job) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  std::vector<std::uint32_t> changing, planes;
  for (std::uint32_t t = 0; t < level.triangles.size(); ++t) {
    job.pollCancelled(t);
    bool isMixed = false;
    const std::uint32_t plane = changingPlane(level, level.triangles[t], isMixed);
    if (plane == ChunkPlane::kNone) continue;
    if (isMixed) pairs.push_back({t, t});
    changing.push_back(t), planes.push_back(plane);
  }
  std::vector<base::Box> boxes;
  boxes.reserve(changing.size());
  for (const std::uint32_t t : changing) boxes.push_back(boxOf(level, level.triangles[t]));
  const base::Bvh own(std::move(boxes), job);
  std::mutex mutex;
  job.forRanges(changing.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::array<std::uint32_t, 2>> found;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle t = changed(level, level.triangles[changing[i]]);
      if (isGone(t)) continue;
      own.itemsMeeting(boxOf(level, t), [&](std::uint32_t j, const base::Box&) {
        if (planes[j] == planes[i] || level.chunkOf[changing[i]] != level.chunkOf[changing[j]] ||
            !intersect::intersectElsewhere(level.positions, t, level.triangles[changing[j]])) {
          return;
        }
        found.push_back({changing[i], changing[j]});
      });
    }
    const std::scoped_lock lock(mutex);
    pairs.insert(pairs.end(), found.begin(), found.end());
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace tufa::chunks
