#include "chunks/chain/split_level.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "chunks/chain/mixed_forms.h"

namespace tufa::chunks {
namespace {

// An edge of a curve, as it runs around a triangle.
struct CurveEdge {
  VertexIndex from, to;
  std::uint32_t plane;
};

class Splitter {
 public:
  Splitter(const CutMesh& cut, const ChainLevel& level, const ShadedLevel& shaded, base::Job& job)
      : cut_(cut), level_(level), shaded_(shaded) {
    triangles_.resize(cut.chunks.size());
    edges_.resize(cut.chunks.size());
    for (std::uint32_t t = 0; t < level.triangles.size(); ++t) {
      job.pollCancelled(t);
      triangles_[level.chunkOf[t]].push_back(t);
    }
    findEdges(job);
  }

  [[nodiscard]] ChunkLevel make(std::uint32_t chunk) const {
    ChunkLevel out;
    std::unordered_map<VertexIndex, VertexIndex> places, anyOf;
    const auto local = [&](VertexIndex v) {
      const auto [found, isNew] = places.emplace(v, static_cast<VertexIndex>(out.positions.size()));
      if (isNew) {
        out.positions.push_back(level_.positions[shaded_.sources[v]]);
        out.normals.push_back(shaded_.normals[v]);
        anyOf.emplace(shaded_.sources[v], found->second);
      }
      return found->second;
    };
    const auto localTriangle = [&](const Triangle& t) {
      const VertexIndex a = local(t.vertices[0]), b = local(t.vertices[1]);
      return Triangle(a, b, local(t.vertices[2]));
    };
    for (const std::uint32_t t : triangles_[chunk]) {
      const Triangle& triangle = level_.triangles[t];
      bool isMixed = false;
      const std::uint32_t plane = changingPlane(level_, triangle, isMixed);
      if (plane == ChunkPlane::kNone) {
        out.interior.push_back(localTriangle(shaded_.triangles[t]));
        continue;
      }
      const std::size_t face = faceOf(chunk, plane);
      out.regular[face].push_back(localTriangle(shaded_.triangles[t]));
      if (isGone(changed(level_, triangle))) continue;
      out.transition[face].push_back(localTriangle(shaded_.changed[t]));
    }
    addSeams(
        chunk, [&](VertexIndex v) { return anyOf.at(v); }, out);
    out.maxErrorVoxels = level_.errors[chunk];
    out.transitionErrorVoxels = level_.transitionErrors[chunk];
    return out;
  }

 private:
  [[nodiscard]] std::size_t faceOf(std::uint32_t chunk, std::uint32_t plane) const {
    const ChunkPlane& p = cut_.planes[plane];
    const auto axis = static_cast<std::size_t>(p.axis);
    return 2 * axis + (p.at == cut_.chunks[chunk][p.axis] ? 0 : 1);
  }

  // The plane that both ends of an edge lie on, if it is one.
  [[nodiscard]] std::uint32_t commonPlane(VertexIndex a, VertexIndex b) const {
    std::uint32_t plane = ChunkPlane::kNone;
    int count = 0;
    for (const std::uint32_t p : cut_.planesAt(level_.cutVertex[a])) {
      for (const std::uint32_t q : cut_.planesAt(level_.cutVertex[b])) {
        if (p != ChunkPlane::kNone && p == q) plane = p, ++count;
      }
    }
    return count == 1 ? plane : ChunkPlane::kNone;
  }

  // The edges between triangles of different chunks, for each chunk in the order of its triangles.
  void findEdges(base::Job& job) {
    const auto keyOf = [](VertexIndex a, VertexIndex b) { return std::uint64_t{a} << 32 | b; };
    const auto forEdges = [&](const auto& visit) {
      for (std::uint32_t t = 0; t < level_.triangles.size(); ++t) {
        job.pollCancelled(t);
        const auto& v = level_.triangles[t].vertices;
        for (std::size_t i = 0; i < 3; ++i) {
          const VertexIndex a = v[i], b = v[(i + 1) % 3];
          if (level_.cutVertex[a] == ChainLevel::kNone || level_.cutVertex[b] == ChainLevel::kNone)
            continue;
          const std::uint32_t plane = commonPlane(a, b);
          if (plane != ChunkPlane::kNone) visit(level_.chunkOf[t], CurveEdge{a, b, plane});
        }
      }
    };
    std::unordered_map<std::uint64_t, std::uint32_t> chunkBehind;
    forEdges([&](std::uint32_t chunk, const CurveEdge& e) {
      chunkBehind.emplace(keyOf(e.from, e.to), chunk);
    });
    forEdges([&](std::uint32_t chunk, const CurveEdge& e) {
      const auto found = chunkBehind.find(keyOf(e.to, e.from));
      if (found != chunkBehind.end() && found->second != chunk) edges_[chunk].push_back(e);
    });
  }

  // The curves on the faces of a chunk, from end to end; then those that are closed.
  template <class Local>
  void addSeams(std::uint32_t chunk, const Local& local, ChunkLevel& out) const {
    const std::vector<CurveEdge>& edges = edges_[chunk];
    std::vector<std::uint8_t> isDone(edges.size(), 0);
    // Inside a curve one edge starts at a vertex.
    std::unordered_map<VertexIndex, std::size_t> startingAt;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!level_.isEnd[edges[i].from]) startingAt.emplace(edges[i].from, i);
    }
    const auto follow = [&](std::size_t first) {
      ChunkSeam seam;
      const auto add = [&](VertexIndex v) {
        seam.vertices.push_back(local(v));
        seam.next.push_back(level_.positions[level_.into[v]]);
      };
      add(edges[first].from);
      for (std::size_t i = first;;) {
        isDone[i] = 1;
        const VertexIndex to = edges[i].to;
        const auto next = startingAt.find(to);
        const bool isLast = level_.isEnd[to] || next == startingAt.end();
        if (!isLast && isDone[next->second] != 0) {
          seam.closed = true;
          break;
        }
        add(to);
        if (isLast) break;
        i = next->second;
      }
      out.seams[faceOf(chunk, edges[first].plane)].push_back(std::move(seam));
    };
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (level_.isEnd[edges[i].from]) follow(i);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (isDone[i] == 0) follow(i);
    }
  }

  const CutMesh& cut_;
  const ChainLevel& level_;
  const ShadedLevel& shaded_;
  std::vector<std::vector<std::uint32_t>> triangles_;  ///< of each chunk
  std::vector<std::vector<CurveEdge>> edges_;          ///< of each chunk
};

}  // namespace

std::vector<ChunkLevel> splitLevel(const CutMesh& cut, const ChainLevel& level,
                                   const ShadedLevel& shaded, base::Job& job) {
  const Splitter splitter(cut, level, shaded, job);
  std::vector<ChunkLevel> chunks(cut.chunks.size());
  job.forRanges(chunks.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      chunks[i] = splitter.make(static_cast<std::uint32_t>(i));
    }
  });
  return chunks;
}

}  // namespace tufa::chunks
