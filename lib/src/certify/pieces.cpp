#include "certify/pieces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "base/bvh.h"
#include "base/flat_triangle.h"
#include "mend/exact.h"

namespace tufa::certify {
namespace {

using openvdb::Vec3d;

Vec3d vectorOf(const Position& p) { return {p.x, p.y, p.z}; }

// On which side of the line from a to b, seen from above, a point lies that is moved aside by an
// infinitesimal along x and by a smaller one along y; 0 if the line is vertical.
int sideFromAbove(const Position& a, const Position& b, const Position& point) {
  const int side = mend::orientationAcross(2, a, b, point);
  if (side != 0) return side;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;
  return a.x == b.x ? 0 : (a.x < b.x ? 1 : -1);
}

// Whether the ray up from a point passes through a triangle.
bool isAbove(const std::vector<Position>& positions, const Triangle& triangle,
             const Position& from) {
  const Position& a = positions[triangle.vertices[0]];
  const Position& b = positions[triangle.vertices[1]];
  const Position& c = positions[triangle.vertices[2]];
  const int side = sideFromAbove(a, b, from);
  if (side == 0 || side != sideFromAbove(b, c, from) || side != sideFromAbove(c, a, from)) {
    return false;
  }
  return side * mend::orientation(a, b, c, from) < 0;
}

// The triangles of a mesh, those of quads first, by their pieces.
class Soup {
 public:
  Soup(const Mesh& mesh, const std::vector<VertexIndex>& pieces, base::Job& job)
      : positions_(mesh.positions),
        pieces_(pieces),
        triangles_(splitQuads(mesh)),
        tree_(boxes(), job) {}

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

  // Whether a ray from the vertex crosses other pieces an odd number of times.
  [[nodiscard]] bool isInside(VertexIndex vertex) const {
    bool inside = false;
    tree_.itemsAbove(vectorOf(positions_[vertex]), [&](std::uint32_t item) {
      const Triangle& triangle = triangles_[item];
      if (isOfPiece(triangle, vertex)) return;
      inside ^= isAbove(positions_, triangle, positions_[vertex]);
    });
    return inside;
  }

  // The triangle of another piece that is nearest to a vertex; null if there is none.
  [[nodiscard]] const Triangle* nearestOther(VertexIndex vertex) const {
    const Vec3d point = vectorOf(positions_[vertex]);
    double best = std::numeric_limits<double>::infinity();
    const std::uint32_t found = tree_.nearest(point, best, [&](std::uint32_t item) {
      const Triangle& triangle = triangles_[item];
      if (isOfPiece(triangle, vertex)) return std::numeric_limits<double>::infinity();
      const auto& v = triangle.vertices;
      return base::squaredDistanceTo(point, vectorOf(positions_[v[0]]), vectorOf(positions_[v[1]]),
                                     vectorOf(positions_[v[2]]));
    });
    return found == base::Bvh::kNone ? nullptr : &triangles_[found];
  }

 private:
  static std::vector<Triangle> splitQuads(const Mesh& mesh) {
    std::vector<Triangle> triangles;
    triangles.reserve(mesh.triangleCount());
    for (const Quad& quad : mesh.quads) {
      const auto& v = quad.vertices;
      triangles.emplace_back(v[0], v[1], v[2]);
      triangles.emplace_back(v[0], v[2], v[3]);
    }
    triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    return triangles;
  }
  [[nodiscard]] std::vector<base::Box> boxes() const {
    std::vector<base::Box> boxes(triangles_.size(), base::Box::empty());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (const VertexIndex vertex : triangles_[i].vertices) {
        boxes[i].add(vectorOf(positions_[vertex]));
      }
    }
    return boxes;
  }
  [[nodiscard]] bool isOfPiece(const Triangle& triangle, VertexIndex vertex) const {
    return pieces_[triangle.vertices[0]] == pieces_[vertex];
  }

  const std::vector<Position>& positions_;
  const std::vector<VertexIndex>& pieces_;
  std::vector<Triangle> triangles_;
  base::Bvh tree_;
};

}  // namespace

std::vector<VertexIndex> piecesOf(const Mesh& mesh) {
  std::vector<VertexIndex> parents(mesh.positions.size());
  std::iota(parents.begin(), parents.end(), VertexIndex{0});
  const auto rootOf = [&](VertexIndex i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  };
  const auto join = [&](const auto& v) {
    for (const VertexIndex other : v) {
      const VertexIndex a = rootOf(v[0]), b = rootOf(other);
      parents[std::max(a, b)] = std::min(a, b);
    }
  };
  for (const Quad& quad : mesh.quads) join(quad.vertices);
  for (const Triangle& triangle : mesh.triangles) join(triangle.vertices);
  for (VertexIndex i = 0; i < parents.size(); ++i) parents[i] = rootOf(i);
  return parents;
}

std::vector<VertexIndex> findMisplaced(const Mesh& mesh, base::Job& job) {
  const std::vector<VertexIndex> pieces = piecesOf(mesh);
  std::vector<VertexIndex> misplaced;
  // Vertices that no polygon uses are pieces of their own here: they have no volume.
  if (std::all_of(pieces.begin(), pieces.end(), [](VertexIndex piece) { return piece == 0; })) {
    return misplaced;
  }
  const Soup soup(mesh, pieces, job);
  std::vector<double> volumes(pieces.size());
  for (const Triangle& triangle : soup.triangles()) {
    const VertexIndex piece = pieces[triangle.vertices[0]];
    std::array<Vec3d, 3> corners;
    for (int i = 0; i < 3; ++i) {
      corners[i] = vectorOf(mesh.positions[triangle.vertices[i]]) - vectorOf(mesh.positions[piece]);
    }
    volumes[piece] += corners[0].dot(corners[1].cross(corners[2]));
  }
  std::vector<std::uint8_t> wrong(pieces.size(), 0);
  job.forRanges(pieces.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (volumes[i] == 0) continue;
      wrong[i] = soup.isInside(static_cast<VertexIndex>(i)) != (volumes[i] < 0) ? 1 : 0;
    }
  });
  for (VertexIndex i = 0; i < pieces.size(); ++i) {
    if (wrong[pieces[i]] == 0) continue;
    misplaced.push_back(i);
    const Triangle* nearest = soup.nearestOther(i);
    if (nearest == nullptr) continue;
    misplaced.insert(misplaced.end(), nearest->vertices.begin(), nearest->vertices.end());
  }
  std::sort(misplaced.begin(), misplaced.end());
  misplaced.erase(std::unique(misplaced.begin(), misplaced.end()), misplaced.end());
  return misplaced;
}

}  // namespace tufa::certify
