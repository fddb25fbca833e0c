#include "check/stars.h"

#include <algorithm>
#include <numeric>

namespace tufa::checks {
namespace {

using Edge = std::pair<VertexIndex, VertexIndex>;

/// An end of an edge at the vertex under study, as one face sees it.
struct Spoke {
  VertexIndex to;
  std::uint32_t face;  ///< position of the face in the star
  bool leaves;         ///< the face runs from the vertex to `to`, not back
  friend bool operator<(const Spoke& a, const Spoke& b) {
    return std::tie(a.to, a.face, a.leaves) < std::tie(b.to, b.face, b.leaves);
  }
};

/// Scratch space of one thread, so that stars do not allocate.
struct Scratch {
  std::vector<Spoke> spokes;
  std::vector<std::uint32_t> parents;
  std::vector<Edge> opposites;
};

std::uint32_t findRoot(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) {
    parents[i] = parents[parents[i]];
    i = parents[i];
  }
  return i;
}

/// Counts the edges at `vertex` that go to larger vertices. Boundary edges go to `boundary`.
void countEdges(VertexIndex vertex, const std::vector<Spoke>& spokes, StarCounts& counts,
                std::vector<Edge>& boundary) {
  for (std::size_t first = 0, last = 0; first < spokes.size(); first = last) {
    std::size_t leaving = 0;
    for (; last < spokes.size() && spokes[last].to == spokes[first].to; ++last) {
      leaving += spokes[last].leaves ? 1 : 0;
    }
    const VertexIndex to = spokes[first].to;
    if (to < vertex) continue;
    const std::size_t faces = last - first;
    ++counts.edges;
    if (faces == 1) {
      ++counts.boundaryEdges;
      boundary.emplace_back(vertex, to);
    } else if (faces > 2) {
      ++counts.nonManifoldEdges;
    } else if (leaving != 1) {
      ++counts.misorientedEdges;
    }
  }
}

/// True if the faces are joined by their edges at the vertex, at most two at each: one fan.
bool formFan(const std::vector<Spoke>& spokes, std::size_t faceCount,
             std::vector<std::uint32_t>& parents) {
  parents.resize(faceCount);
  std::iota(parents.begin(), parents.end(), 0U);
  std::size_t groups = faceCount;
  for (std::size_t i = 1; i < spokes.size(); ++i) {
    if (spokes[i].to != spokes[i - 1].to) continue;
    if (i > 1 && spokes[i].to == spokes[i - 2].to) return false;
    const std::uint32_t a = findRoot(parents, spokes[i].face);
    const std::uint32_t b = findRoot(parents, spokes[i - 1].face);
    if (a == b) continue;
    parents[a] = b;
    --groups;
  }
  return groups == 1;
}

/// Faces that have the same vertices as another of the same star, `vertex` being the smallest.
std::uint32_t countDuplicates(std::vector<Edge>& opposites) {
  std::sort(opposites.begin(), opposites.end());
  const auto last = std::unique(opposites.begin(), opposites.end());
  return static_cast<std::uint32_t>(opposites.end() - last);
}

StarCounts studyStar(VertexIndex vertex, const std::vector<Triangle>& faces,
                     const VertexFaces& around, Scratch& scratch, std::vector<Edge>& boundary) {
  scratch.spokes.clear();
  scratch.opposites.clear();
  std::uint32_t faceCount = 0;
  for (const std::uint32_t* f = around.begin(vertex); f != around.end(vertex); ++f, ++faceCount) {
    const auto& v = faces[*f].vertices;
    const std::size_t corner = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
    const VertexIndex next = v[(corner + 1) % 3];
    const VertexIndex previous = v[(corner + 2) % 3];
    scratch.spokes.push_back({next, faceCount, true});
    scratch.spokes.push_back({previous, faceCount, false});
    if (vertex < next && vertex < previous) {
      scratch.opposites.emplace_back(std::min(next, previous), std::max(next, previous));
    }
  }
  StarCounts counts;
  if (faceCount == 0) return counts;
  std::sort(scratch.spokes.begin(), scratch.spokes.end());
  countEdges(vertex, scratch.spokes, counts, boundary);
  counts.isFan = formFan(scratch.spokes, faceCount, scratch.parents);
  counts.duplicateFaces = countDuplicates(scratch.opposites);
  return counts;
}

}  // namespace

VertexFaces::VertexFaces(const std::vector<Triangle>& faces, std::size_t vertexCount)
    : offsets_(vertexCount + 1), faceIndices_(3 * faces.size()) {
  for (const Triangle& face : faces) {
    for (const VertexIndex v : face.vertices) ++offsets_[v];
  }
  std::inclusive_scan(offsets_.begin(), offsets_.end(), offsets_.begin());
  // Each offset is now the end of its vertex's list; filling from the back leaves the beginning.
  for (std::size_t f = faces.size(); f-- > 0;) {
    for (const VertexIndex v : faces[f].vertices) {
      faceIndices_[--offsets_[v]] = static_cast<std::uint32_t>(f);
    }
  }
}

std::vector<StarCounts> studyStars(const std::vector<Triangle>& faces, const VertexFaces& around,
                                   base::Job& job, std::vector<Edge>& boundaryEdges) {
  std::vector<StarCounts> stars(around.vertexCount());
  std::vector<std::vector<Edge>> boundaries((stars.size() + base::kGrain - 1) / base::kGrain);
  job.forRanges(stars.size(), [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    for (std::size_t v = begin; v < end; ++v) {
      stars[v] = studyStar(static_cast<VertexIndex>(v), faces, around, scratch,
                           boundaries[begin / base::kGrain]);
    }
  });
  for (const auto& part : boundaries) {
    boundaryEdges.insert(boundaryEdges.end(), part.begin(), part.end());
  }
  return stars;
}

}  // namespace tufa::checks
