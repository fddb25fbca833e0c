#include "check/nesting.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/count_odd.h"
#include "base/vec3.h"
#include "check/exact.h"
#include "check/sum_ranges.h"

namespace tufa::checks {
namespace {

/// Rays that decide by majority whether a component lies in a cavity; odd, so that there is a
/// majority.
constexpr std::size_t kMostRays = 33;

/// The members of each component, vertices or faces, in rising order.
class Members {
 public:
  /// Of `count` members; pieceOf(i) is the component of each, or Pieces::kNone.
  template <class PieceOf>
  Members(std::size_t pieces, std::size_t count, const PieceOf& pieceOf) : begins_(pieces + 1) {
    for (std::size_t i = 0; i < count; ++i) {
      if (const VertexIndex piece = pieceOf(i); piece != Pieces::kNone) ++begins_[piece + 1];
    }
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    members_.resize(begins_.back());
    std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
    for (std::size_t i = 0; i < count; ++i) {
      const VertexIndex piece = pieceOf(i);
      if (piece != Pieces::kNone) members_[next[piece]++] = static_cast<std::uint32_t>(i);
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t piece) const {
    return {members_.data() + begins_[piece], begins_[piece + 1] - begins_[piece]};
  }

 private:
  std::vector<std::size_t> begins_;
  std::vector<std::uint32_t> members_;
};

Members verticesOf(const Pieces& pieces) {
  return {pieces.count, pieces.ofVertex.size(), [&](std::size_t v) { return pieces.ofVertex[v]; }};
}

Members facesOf(const Pieces& pieces, const Faces& faces) {
  return {pieces.count, faces.proper.size(),
          [&](std::size_t f) { return pieces.ofVertex[faces.proper[f].vertices[0]]; }};
}

/// Six times the signed volume of each component, taken about a vertex of its own.
std::vector<double> pieceVolumes(const Faces& faces, const Pieces& pieces,
                                 const Members& vertices) {
  std::vector<double> volumes(pieces.count);
  for (const Triangle& face : faces.proper) {
    const VertexIndex piece = pieces.ofVertex[face.vertices[0]];
    const Vec3 origin = Vec3(faces.positions[vertices.of(piece).front()]);
    const Vec3 a = Vec3(faces.positions[face.vertices[0]]) - origin;
    const Vec3 b = Vec3(faces.positions[face.vertices[1]]) - origin;
    const Vec3 c = Vec3(faces.positions[face.vertices[2]]) - origin;
    volumes[piece] += a.dot(b.cross(c));
  }
  return volumes;
}

/// Tells which components lie in cavities of others. Keeps references to its arguments.
class CavityFinder {
 public:
  CavityFinder(const Faces& faces, const Pieces& pieces, const Members& vertices, const Bvh& tree,
               base::Job& job)
      : faces_(faces),
        pieces_(pieces),
        vertices_(vertices),
        facesOfPieces_(facesOf(pieces, faces)),
        tree_(tree),
        boxes_(boxesOf(faces, pieces.count, vertices)),
        pieceTree_(boxes_, job) {}

  /// Whether most of a component lies in an odd number of others. Vertices disagree only where
  /// components intersect: a vertex that protrudes through its neighbour must not reverse the
  /// answer. Centres of faces tell where all vertices lie on other components.
  [[nodiscard]] bool holds(std::size_t piece) const {
    const auto vertices = vertices_.of(piece);
    const auto byVertices = majority(vertices.size(), piece,
                                     [&](std::size_t i) { return faces_.positions[vertices[i]]; });
    if (byVertices) return *byVertices;
    const auto faces = facesOfPieces_.of(piece);
    const auto centre = [&](std::size_t i) {
      Vec3 sum(0);
      for (const VertexIndex v : faces_.proper[faces[i]].vertices) {
        sum += Vec3(faces_.positions[v]) / 3;
      }
      return Position(sum);
    };
    return majority(faces.size(), piece, centre).value_or(false);
  }

 private:
  static std::vector<base::Box> boxesOf(const Faces& faces, std::size_t count,
                                        const Members& vertices) {
    std::vector<base::Box> boxes(count, base::Box::empty());
    for (std::size_t piece = 0; piece < count; ++piece) {
      for (const VertexIndex v : vertices.of(piece)) boxes[piece].add(Vec3(faces.positions[v]));
    }
    return boxes;
  }

  /// Whether most of some points of a component lie in an odd number of others; nothing if all lie
  /// on others.
  template <class Point>
  [[nodiscard]] std::optional<bool> majority(std::size_t count, std::size_t piece,
                                             const Point& point) const {
    const std::size_t rays = std::min(kMostRays, (count - 1) | 1);
    std::size_t odd = 0, all = 0;
    for (std::size_t ray = 0; ray < rays; ++ray) {
      const auto depth = depthOf(point(ray * count / rays), piece);
      if (!depth) continue;
      odd += *depth % 2;
      ++all;
    }
    if (all == 0) return std::nullopt;
    return 2 * odd > all;
  }

  /// How many other components a point of one lies in: those that a ray from it crosses an odd
  /// number of times. Nothing if it lies on one.
  [[nodiscard]] std::optional<std::size_t> depthOf(const Position& from, std::size_t own) const {
    // The ray ends with the highest of the components whose boxes hold the point.
    const base::Box start{Vec3(from), Vec3(from)};
    base::Box ray = start;
    bool isHeld = false;
    pieceTree_.itemsMeeting(start, [&](std::uint32_t piece, const base::Box& box) {
      if (piece == own) return;
      ray.add(Vec3(from.x, from.y, box.upper[2]));
      isHeld = true;
    });
    if (!isHeld) return 0;
    std::vector<VertexIndex> crossed;
    bool isOn = false;
    tree_.itemsMeeting(ray, [&](std::uint32_t item, const base::Box& box) {
      const Triangle& face = faces_.solid()[item];
      const VertexIndex piece = pieces_.ofVertex[face.vertices[0]];
      if (piece == own || !boxes_[piece].meets(start)) return;
      if (liesAbove(faces_.positions, face, from)) crossed.push_back(piece);
      isOn = isOn || (box.meets(start) && liesOn(faces_.positions, face, from));
    });
    if (isOn) return std::nullopt;
    return base::countOdd(crossed);
  }

  const Faces& faces_;
  const Pieces& pieces_;
  const Members& vertices_;
  Members facesOfPieces_;
  const Bvh& tree_;
  std::vector<base::Box> boxes_;  ///< of the components
  Bvh pieceTree_;                 ///< over them
};

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
  const Members vertices = verticesOf(pieces);
  const std::vector<double> volumes = pieceVolumes(faces, pieces, vertices);
  std::optional<CavityFinder> cavities;
  if (pieces.count > 1) cavities.emplace(faces, pieces, vertices, tree, job);
  const auto directions =
      sumRanges<Directions>(job, pieces.count, 1, [&](std::size_t begin, std::size_t end) {
        Directions part;
        for (std::size_t piece = begin; piece < end; ++piece) {
          const bool isHole = cavities && cavities->holds(piece);
          if (volumes[piece] > 0) ++(isHole ? part.wrong : part.right);
          if (volumes[piece] < 0) ++(isHole ? part.right : part.wrong);
        }
        return part;
      });
  return {.outward = directions.right == pieces.count,
          .alternates = directions.right == pieces.count || directions.wrong == pieces.count};
}

}  // namespace tufa::checks
