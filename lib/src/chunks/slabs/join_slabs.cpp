#include "chunks/slabs/join_slabs.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/sort_unique.h"
#include "uniform/uniform_surface.h"

namespace tufa::chunks {
namespace {

constexpr VertexIndex kNew = ~VertexIndex{0};

class SlabJoiner {
 public:
  explicit SlabJoiner(base::Job& job) : job_(job) {}

  void add(CutSlab slab) {
    const CutMesh& cut = slab.cut;
    std::vector<VertexIndex> numbers(cut.mesh.positions.size(), kNew);
    for (std::size_t i = 0; i < slab.lower.vertices.size(); ++i) {
      numbers[slab.lower.vertices[i].vertex] = below_[i];
    }
    std::vector<const SlabBorder::Vertex*> upper(cut.mesh.positions.size(), nullptr);
    for (const SlabBorder::Vertex& vertex : slab.upper.vertices) upper[vertex.vertex] = &vertex;
    for (VertexIndex v = 0; v < numbers.size(); ++v) {
      job_.pollCancelled(v);
      if (numbers[v] != kNew) continue;
      numbers[v] = static_cast<VertexIndex>(joined_.mesh.positions.size());
      joined_.mesh.positions.push_back(cut.mesh.positions[v]);
      joined_.mesh.normals.push_back(cut.mesh.normals[v]);
      addPlanes(numbers[v], cut, v, upper[v]);
    }
    uniform::requireIndexable(joined_.mesh.positions.size());
    for (std::size_t t = 0; t < cut.mesh.triangles.size(); ++t) {
      job_.pollCancelled(t);
      const auto& v = cut.mesh.triangles[t].vertices;
      joined_.mesh.triangles.emplace_back(numbers[v[0]], numbers[v[1]], numbers[v[2]]);
      chunkOf_.push_back(cut.chunks[cut.chunkOf[t]]);
    }
    for (std::size_t c = 0; c < cut.chunks.size(); ++c) errors_[cut.chunks[c]] = cut.errors[c];
    below_.clear();
    for (const SlabBorder::Vertex& vertex : slab.upper.vertices) {
      below_.push_back(numbers[vertex.vertex]);
    }
  }

  CutMesh take() {
    std::vector<std::uint32_t> places;
    for (const auto& [chunk, error] : errors_) {
      joined_.chunks.push_back(chunk);
      joined_.errors.push_back(error);
      joined_.moved = std::max(joined_.moved, error);
    }
    places.reserve(chunkOf_.size());
    for (std::size_t t = 0; t < chunkOf_.size(); ++t) {
      job_.pollCancelled(t);
      const auto found =
          std::lower_bound(joined_.chunks.begin(), joined_.chunks.end(), chunkOf_[t]);
      places.push_back(static_cast<std::uint32_t>(found - joined_.chunks.begin()));
    }
    joined_.chunkOf = std::move(places);
    return std::move(joined_);
  }

 private:
  // Those of a vertex of a slab, or of a border, whose vertices have planes of both slabs.
  void addPlanes(VertexIndex now, const CutMesh& cut, VertexIndex v,
                 const SlabBorder::Vertex* border) {
    std::array<std::uint32_t, 3> planes = {ChunkPlane::kNone, ChunkPlane::kNone, ChunkPlane::kNone};
    const std::array<std::uint32_t, 3> own = cut.planesAt(v);
    for (std::size_t i = 0; i < 3; ++i) {
      if (border != nullptr && border->planes[i].axis >= 0) {
        planes[i] = numberOf(border->planes[i]);
      } else if (border == nullptr && own[i] != ChunkPlane::kNone) {
        planes[i] = numberOf(cut.planes[own[i]]);
      }
    }
    if (planes[0] == ChunkPlane::kNone) return;
    joined_.onPlanes.push_back(now);
    joined_.planesOf.push_back(planes);
  }

  std::uint32_t numberOf(const ChunkPlane& plane) {
    const auto number = static_cast<std::uint32_t>(joined_.planes.size());
    const auto [found, isNew] = planes_.emplace(std::pair(plane.axis, plane.at), number);
    if (isNew) joined_.planes.push_back(plane);
    return found->second;
  }

  base::Job& job_;
  CutMesh joined_;
  std::vector<Coord> chunkOf_;      ///< of each triangle
  std::map<Coord, double> errors_;  ///< of each chunk
  std::vector<VertexIndex> below_;  ///< the upper border of the last slab, by place
  std::map<std::pair<int, std::int32_t>, std::uint32_t> planes_;
};

}  // namespace

CutMesh joinSlabs(std::vector<CutSlab> slabs, base::Job& job) {
  SlabJoiner joiner(job);
  for (CutSlab& slab : slabs) joiner.add(std::exchange(slab, {}));
  return joiner.take();
}

}  // namespace tufa::chunks
