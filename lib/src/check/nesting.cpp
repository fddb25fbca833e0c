#include "check/nesting.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "check/exact.h"
#include "check/sum_ranges.h"

namespace tufa::checks {
namespace {

using openvdb::Vec3d;

Vec3d toVector(const Position& p) { return {p.x, p.y, p.z}; }

/// The first vertex of each piece.
std::vector<VertexIndex> firstVertices(const Pieces& pieces) {
  std::vector<VertexIndex> first(pieces.count, Pieces::kNone);
  for (VertexIndex v = 0; v < pieces.ofVertex.size(); ++v) {
    const VertexIndex piece = pieces.ofVertex[v];
    if (piece != Pieces::kNone && first[piece] == Pieces::kNone) first[piece] = v;
  }
  return first;
}

/// Six times the signed volume of each piece, taken about a vertex of its own.
std::vector<double> pieceVolumes(const Faces& faces, const Pieces& pieces,
                                 const std::vector<VertexIndex>& firstVertex) {
  std::vector<double> volumes(pieces.count);
  for (const Triangle& face : faces.proper) {
    const VertexIndex piece = pieces.ofVertex[face.vertices[0]];
    const Vec3d origin = toVector(faces.positions[firstVertex[piece]]);
    const Vec3d a = toVector(faces.positions[face.vertices[0]]) - origin;
    const Vec3d b = toVector(faces.positions[face.vertices[1]]) - origin;
    const Vec3d c = toVector(faces.positions[face.vertices[2]]) - origin;
    volumes[piece] += a.dot(b.cross(c));
  }
  return volumes;
}

/// How many other pieces hold `vertex`: those that a ray from it crosses an odd number of times.
std::size_t depthOf(VertexIndex vertex, const Faces& faces, const Pieces& pieces, const Bvh& tree) {
  const Position& from = faces.positions[vertex];
  std::vector<VertexIndex> crossed;
  tree.itemsAbove(toVector(from), [&](std::uint32_t item) {
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

/// Pieces that face the way their depth asks for, and the opposite way.
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
  const std::vector<VertexIndex> first = firstVertices(pieces);
  const std::vector<double> volumes = pieceVolumes(faces, pieces, first);
  const auto directions =
      sumRanges<Directions>(job, pieces.count, 64, [&](std::size_t begin, std::size_t end) {
        Directions part;
        for (std::size_t piece = begin; piece < end; ++piece) {
          const bool isHole =
              pieces.count > 1 && depthOf(first[piece], faces, pieces, tree) % 2 == 1;
          if (volumes[piece] > 0) ++(isHole ? part.wrong : part.right);
          if (volumes[piece] < 0) ++(isHole ? part.right : part.wrong);
        }
        return part;
      });
  return {.outward = directions.right == pieces.count,
          .alternates = directions.right == pieces.count || directions.wrong == pieces.count};
}

}  // namespace tufa::checks
