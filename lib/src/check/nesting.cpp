#include "check/nesting.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "check/exact.h"
#include "check/sum_ranges.h"

namespace tufa::checks {
namespace {

/// Rays that decide by majority whether a component lies in a cavity; odd, so that there is a
/// majority.
constexpr std::size_t kMostRays = 33;

/// The vertices of each component, in rising order.
class Members {
 public:
  explicit Members(const Pieces& pieces) : begins_(pieces.count + 1) {
    for (const VertexIndex piece : pieces.ofVertex) {
      if (piece != Pieces::kNone) ++begins_[piece + 1];
    }
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    vertices_.resize(begins_.back());
    std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
    for (VertexIndex v = 0; v < pieces.ofVertex.size(); ++v) {
      const VertexIndex piece = pieces.ofVertex[v];
      if (piece != Pieces::kNone) vertices_[next[piece]++] = v;
    }
  }
  [[nodiscard]] std::span<const VertexIndex> of(std::size_t piece) const {
    return {vertices_.data() + begins_[piece], begins_[piece + 1] - begins_[piece]};
  }

 private:
  std::vector<std::size_t> begins_;
  std::vector<VertexIndex> vertices_;
};

/// Six times the signed volume of each component, taken about a vertex of its own.
std::vector<double> pieceVolumes(const Faces& faces, const Pieces& pieces, const Members& members) {
  std::vector<double> volumes(pieces.count);
  for (const Triangle& face : faces.proper) {
    const VertexIndex piece = pieces.ofVertex[face.vertices[0]];
    const Vec3 origin = Vec3(faces.positions[members.of(piece).front()]);
    const Vec3 a = Vec3(faces.positions[face.vertices[0]]) - origin;
    const Vec3 b = Vec3(faces.positions[face.vertices[1]]) - origin;
    const Vec3 c = Vec3(faces.positions[face.vertices[2]]) - origin;
    volumes[piece] += a.dot(b.cross(c));
  }
  return volumes;
}

/// How many other components `vertex` lies in: those that a ray from it crosses an odd number of
/// times.
std::size_t depthOf(VertexIndex vertex, const Faces& faces, const Pieces& pieces, const Bvh& tree) {
  const Position& from = faces.positions[vertex];
  std::vector<VertexIndex> crossed;
  tree.itemsAbove(Vec3(from), [&](std::uint32_t item) {
    const Triangle& face = faces.solid()[item];
    const VertexIndex piece = pieces.ofVertex[face.vertices[0]];
    if (piece != pieces.ofVertex[vertex] && liesAbove(faces.positions, face, from)) {
      crossed.push_back(piece);
    }
  });
  std::sort(crossed.begin(), crossed.end());
  std::size_t depth = 0;
  for (std::size_t first = 0, last = 0; first < crossed.size(); first = last) {
    while (last < crossed.size() && crossed[last] == crossed[first]) ++last;
    depth += (last - first) % 2;
  }
  return depth;
}

/// Whether most of a component lies in an odd number of others. Vertices disagree only where
/// components intersect: a vertex that protrudes through its neighbour must not reverse the answer.
bool liesInHole(std::span<const VertexIndex> members, const Faces& faces, const Pieces& pieces,
                const Bvh& tree) {
  const std::size_t rays = std::min(kMostRays, (members.size() - 1) | 1);
  std::size_t odd = 0;
  for (std::size_t ray = 0; ray < rays; ++ray) {
    const VertexIndex vertex = members[ray * members.size() / rays];
    odd += depthOf(vertex, faces, pieces, tree) % 2;
  }
  return 2 * odd > rays;
}

/// Components that face as their depth demands, and the opposite way.
struct Directions {
  std::size_t right = 0;
  std::size_t wrong = 0;
  Directions& operator+=(const Directions& other) {
    right += other.right;
    wrong += other.wrong;
    return *this;
  }
};

}  // namespace

Nesting studyNesting(const Faces& faces, const Pieces& pieces, const Bvh& tree, base::Job& job) {
  const Members members(pieces);
  const std::vector<double> volumes = pieceVolumes(faces, pieces, members);
  const auto directions =
      sumRanges<Directions>(job, pieces.count, 64, [&](std::size_t begin, std::size_t end) {
        Directions part;
        for (std::size_t piece = begin; piece < end; ++piece) {
          const bool isHole =
              pieces.count > 1 && liesInHole(members.of(piece), faces, pieces, tree);
          if (volumes[piece] > 0) ++(isHole ? part.wrong : part.right);
          if (volumes[piece] < 0) ++(isHole ? part.right : part.wrong);
        }
        return part;
      });
  return {.outward = directions.right == pieces.count,
          .alternates = directions.right == pieces.count || directions.wrong == pieces.count};
}

}  // namespace tufa::checks
