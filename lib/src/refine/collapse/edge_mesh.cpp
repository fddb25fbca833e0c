#include "refine/collapse/edge_mesh.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace tufa::refine {

EdgeMesh::EdgeMesh(const Mesh& mesh)
    : ranks_(mesh.positions.size()),
      order_(mesh.positions.size()),
      first_(mesh.positions.size(), kNone),
      vertexOf_(mesh.positions.size()) {
  points_.reserve(mesh.positions.size());
  for (const Position& p : mesh.positions) points_.emplace_back(p.x, p.y, p.z);
  std::iota(vertexOf_.begin(), vertexOf_.end(), VertexIndex{0});
  // By place: a grid that is translated has its vertices in another order.
  std::iota(order_.begin(), order_.end(), VertexIndex{0});
  std::sort(order_.begin(), order_.end(), [&](VertexIndex a, VertexIndex b) {
    const Position& p = mesh.positions[a];
    const Position& q = mesh.positions[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  for (std::uint32_t i = 0; i < order_.size(); ++i) ranks_[order_[i]] = i;

  corners_.reserve(6 * mesh.quads.size() + 3 * mesh.triangles.size());
  for (const Quad& quad : mesh.quads) {
    const auto& v = quad.vertices;
    corners_.insert(corners_.end(), {v[0], v[1], v[2], v[0], v[2], v[3]});
  }
  for (const Triangle& triangle : mesh.triangles) {
    corners_.insert(corners_.end(), triangle.vertices.begin(), triangle.vertices.end());
  }
  alive_ = corners_.size() / 3;
  next_.resize(corners_.size());
  for (std::uint32_t place = 0; place < corners_.size(); ++place) {
    next_[place] = first_[corners_[place]];
    first_[corners_[place]] = place;
  }
}

bool EdgeMesh::isOnBoundary(VertexIndex vertex) const {
  // In a closed fan each neighbour is once the first and once the second corner behind the vertex,
  // so the sums are equal. In an open fan the two ends differ.
  std::int64_t balance = 0;
  std::size_t triangles = 0;
  forTriangles(vertex, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
    balance += std::int64_t{x} - std::int64_t{y};
    ++triangles;
  });
  return triangles < 3 || balance != 0;
}

std::size_t EdgeMesh::degree(VertexIndex vertex) const {
  std::size_t triangles = 0;
  forTriangles(vertex, [&](std::uint32_t, VertexIndex, VertexIndex) { ++triangles; });
  return triangles;
}

void EdgeMesh::collectNeighbours(VertexIndex vertex, std::vector<VertexIndex>& out) const {
  out.clear();
  forTriangles(vertex, [&](std::uint32_t, VertexIndex x, VertexIndex) { out.push_back(x); });
  std::sort(out.begin(), out.end(), [&](VertexIndex a, VertexIndex b) { return isBefore(a, b); });
}

std::vector<std::uint8_t> EdgeMesh::dilated(const std::vector<std::uint8_t>& marks) const {
  std::vector<std::uint8_t> wider = marks;
  for (std::size_t t = 0; t < corners_.size(); t += 3) {
    if (!isAlive(t)) continue;
    const VertexIndex* v = &corners_[t];
    if (marks[v[0]] != 0 || marks[v[1]] != 0 || marks[v[2]] != 0) {
      for (int i = 0; i < 3; ++i) wider[v[i]] = 1;
    }
  }
  return wider;
}

bool LinkCheck::mayCollapse(const EdgeMesh& mesh, VertexIndex a, VertexIndex b) {
  const auto collect = [&](VertexIndex own, std::vector<VertexIndex>& around) {
    around.clear();
    mesh.forTriangles(own, [&](std::uint32_t, VertexIndex x, VertexIndex) { around.push_back(x); });
    std::sort(around.begin(), around.end());
    // A neighbour listed twice is at an edge of four triangles, as a quad's diagonal may be.
    return std::adjacent_find(around.begin(), around.end()) == around.end();
  };
  if (!collect(a, aroundA_) || !collect(b, aroundB_)) return false;
  std::array<VertexIndex, 2> beside{kNone, kNone};
  std::size_t shared = 0;
  mesh.forTriangles(a, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
    if (x == b || y == b) beside[std::min<std::size_t>(shared++, 1)] = x == b ? y : x;
  });
  if (shared != 2 || beside[0] == beside[1]) return false;
  std::size_t common = 0;
  for (std::size_t i = 0, j = 0; i < aroundA_.size() && j < aroundB_.size();) {
    const VertexIndex x = aroundA_[i], y = aroundB_[j];
    common += x == y ? 1 : 0;
    i += x <= y ? 1 : 0;
    j += y <= x ? 1 : 0;
  }
  return common == 2 && std::all_of(beside.begin(), beside.end(),
                                    [&](VertexIndex vertex) { return mesh.degree(vertex) > 3; });
}

// Removes the triangles at the edge and appends the corners of `drop` to the list of `keep`, in
// time proportional to both lists. Removed corners stay in the lists of the two opposite vertices;
// forTriangles() skips them.
void EdgeMesh::collapse(VertexIndex keep, VertexIndex drop, const Vec3& point) {
  points_[keep] = point;
  forTriangles(drop, [&](std::uint32_t t, VertexIndex x, VertexIndex y) {
    if (x != keep && y != keep) return;
    std::fill_n(&corners_[t], 3, kNone);
  });
  std::uint32_t last = kNone;
  for (std::uint32_t place = first_[drop]; place != kNone; place = next_[place]) {
    if (corners_[place] == drop) corners_[place] = keep;
    last = place;
  }
  next_[last] = first_[keep];
  first_[keep] = first_[drop];
  vertexOf_[drop] = keep;
  for (std::uint32_t* link = &first_[keep]; *link != kNone;) {  // drops removed corners
    if (corners_[*link] == keep) {
      link = &next_[*link];
    } else {
      *link = next_[*link];
    }
  }
}

void EdgeMesh::turn(std::uint32_t t, std::uint32_t u, VertexIndex a, VertexIndex b, VertexIndex c,
                    VertexIndex d) {
  replaceCorner(t, b, d);
  replaceCorner(u, a, c);
}

void EdgeMesh::replaceCorner(std::uint32_t triangle, VertexIndex from, VertexIndex to) {
  std::uint32_t place = triangle;
  while (corners_[place] != from) ++place;
  std::uint32_t* link = &first_[from];
  while (*link != place) link = &next_[*link];
  *link = next_[place];
  corners_[place] = to;
  next_[place] = first_[to];
  first_[to] = place;
}

}  // namespace tufa::refine
