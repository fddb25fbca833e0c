#include "support/mesh_oracle.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/vec3.h"

namespace tufa::test {
namespace {

using Face = std::vector<VertexIndex>;

std::vector<Face> facesOf(const Mesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(mesh.triangles.size() + mesh.quads.size());
  for (const Triangle& t : mesh.triangles) faces.emplace_back(t.vertices.begin(), t.vertices.end());
  for (const Quad& q : mesh.quads) faces.emplace_back(q.vertices.begin(), q.vertices.end());
  return faces;
}

VertexIndex rootOf(std::vector<VertexIndex>& parent, VertexIndex v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

// One use of an edge by a face.
struct EdgeUse {
  VertexIndex low, high;
  bool rising;
  friend auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

void countEdges(const std::vector<Face>& faces, MeshTopology& topology) {
  std::vector<EdgeUse> uses;
  for (const Face& face : faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      const VertexIndex a = face[i], b = face[(i + 1) % face.size()];
      if (a != b) uses.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(uses.begin(), uses.end());
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i;
    while (end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high)
      ++end;
    ++topology.edges;
    if (end - i == 1) ++topology.boundaryEdges;
    if (end - i > 2) ++topology.nonManifoldEdges;
    if (end - i == 2 && uses[i].rising == uses[i + 1].rising) ++topology.misorientedEdges;
    i = end;
  }
}

// Whether the links of a vertex, one pair of neighbours for each face around it, are one path or
// one cycle.
bool isFan(const std::vector<std::pair<VertexIndex, VertexIndex>>& links) {
  std::map<VertexIndex, std::vector<VertexIndex>> around;
  for (const auto& [a, b] : links) {
    around[a].push_back(b);
    around[b].push_back(a);
  }
  for (const auto& [vertex, others] : around) {
    if (others.size() > 2) return false;
  }
  std::vector<VertexIndex> open = {around.begin()->first};
  std::map<VertexIndex, bool> seen = {{open[0], true}};
  while (!open.empty()) {
    const VertexIndex vertex = open.back();
    open.pop_back();
    for (const VertexIndex other : around[vertex]) {
      if (!std::exchange(seen[other], true)) open.push_back(other);
    }
  }
  return seen.size() == around.size();
}

void countVertices(const std::vector<Face>& faces, std::size_t count, MeshTopology& topology) {
  std::vector<std::vector<std::pair<VertexIndex, VertexIndex>>> links(count);
  std::vector<VertexIndex> parent(count);
  std::iota(parent.begin(), parent.end(), VertexIndex{0});
  for (const Face& face : faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      const VertexIndex next = face[(i + 1) % face.size()];
      const VertexIndex before = face[(i + face.size() - 1) % face.size()];
      links[face[i]].emplace_back(before, next);
      parent[rootOf(parent, face[i])] = rootOf(parent, next);
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    if (links[v].empty()) {
      ++topology.unusedVertices;
      continue;
    }
    ++topology.vertices;
    if (!isFan(links[v])) ++topology.nonManifoldVertices;
    if (parent[v] == v) ++topology.components;
  }
}

Vec3 at(const Mesh& mesh, VertexIndex v) { return mesh.positions[v]; }

template <class T>
bool equalArrays(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const MeshTopology& t) {
  return out << "vertices " << t.vertices << ", edges " << t.edges << ", faces " << t.faces
             << ", unused " << t.unusedVertices << ", boundary " << t.boundaryEdges
             << ", non-manifold edges " << t.nonManifoldEdges << ", vertices "
             << t.nonManifoldVertices << ", misoriented " << t.misorientedEdges << ", duplicate "
             << t.duplicateFaces << ", collapsed " << t.collapsedFaces << ", components "
             << t.components;
}

MeshTopology inspect(const Mesh& mesh) {
  std::vector<Face> faces = facesOf(mesh);
  MeshTopology topology;
  topology.faces = faces.size();
  countEdges(faces, topology);
  countVertices(faces, mesh.positions.size(), topology);
  for (Face& face : faces) {
    std::sort(face.begin(), face.end());
    if (std::adjacent_find(face.begin(), face.end()) != face.end()) ++topology.collapsedFaces;
  }
  std::sort(faces.begin(), faces.end());
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i] == faces[i - 1]) ++topology.duplicateFaces;
  }
  return topology;
}

Mesh triangulated(const Mesh& mesh) {
  Mesh split;
  split.positions = mesh.positions;
  split.normals = mesh.normals;
  split.triangles = triangulate(mesh);
  return split;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : triangulate(mesh)) {
    const auto [a, b, c] = t.vertices;
    sum += (at(mesh, b) - at(mesh, a)).cross(at(mesh, c) - at(mesh, a)).length() / 2;
  }
  return sum;
}

namespace {

constexpr double kFolded = -0.8660254;  // cosine of 150 degrees

struct Fold {
  Vec3 middle;
  std::array<Vec3, 2> normals;
};

// The normal of a face of more than so many square voxels, or nothing.
std::optional<Vec3> normalOf(const Mesh& mesh, const Triangle& t, double leastArea) {
  const auto [a, b, c] = t.vertices;
  const Vec3 normal = (at(mesh, b) - at(mesh, a)).cross(at(mesh, c) - at(mesh, a));
  if (normal.length() <= 2 * leastArea) return {};
  return normal * (1 / normal.length());
}

std::vector<Fold> foldsOf(const Mesh& mesh, double voxelSize) {
  struct Side {
    VertexIndex low, high;
    Vec3 normal;
  };
  std::vector<Side> sides;
  for (const Triangle& t : triangulate(mesh)) {
    const std::optional<Vec3> normal = normalOf(mesh, t, 0.05 * voxelSize * voxelSize);
    if (!normal) continue;
    const auto [a, b, c] = t.vertices;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      sides.push_back({std::min(from, to), std::max(from, to), *normal});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  std::vector<Fold> folds;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side &a = sides[i - 1], &b = sides[i];
    if (a.low != b.low || a.high != b.high || a.normal.dot(b.normal) >= kFolded) continue;
    folds.push_back({(at(mesh, a.low) + at(mesh, a.high)) * 0.5, {a.normal, b.normal}});
  }
  return folds;
}

// Whether two faces of a solid near a fold are as sharp.
bool isSharpAt(const Fold& fold, const Mesh& solid, double voxelSize) {
  constexpr double kAlike = 0.819;
  std::array<std::vector<Vec3>, 2> normals;
  for (const Triangle& t : triangulate(solid)) {
    const auto isNear = [&](VertexIndex v) {
      return (at(solid, v) - fold.middle).length() < 3 * voxelSize;
    };
    if (!std::any_of(t.vertices.begin(), t.vertices.end(), isNear)) continue;
    const std::optional<Vec3> normal = normalOf(solid, t, 1e-3 * voxelSize * voxelSize);
    if (!normal) continue;
    for (const std::size_t i : {0, 1}) {
      if (normal->dot(fold.normals[i]) > kAlike) normals[i].push_back(*normal);
    }
  }
  return std::any_of(normals[0].begin(), normals[0].end(), [&](const Vec3& a) {
    return std::any_of(normals[1].begin(), normals[1].end(),
                       [&](const Vec3& b) { return a.dot(b) < kFolded; });
  });
}

}  // namespace

std::size_t foldedEdges(const Mesh& mesh, double voxelSize) {
  return foldsOf(mesh, voxelSize).size();
}

std::size_t foldedEdges(const Mesh& mesh, const Mesh& solid, double voxelSize) {
  const std::vector<Fold> folds = foldsOf(mesh, voxelSize);
  return static_cast<std::size_t>(std::count_if(folds.begin(), folds.end(), [&](const Fold& fold) {
    return !isSharpAt(fold, solid, voxelSize);
  }));
}

double volume(const Mesh& mesh) {
  if (mesh.positions.empty()) return 0;
  const Vec3 origin = at(mesh, 0);
  double sum = 0;
  for (const Triangle& t : triangulate(mesh)) {
    const auto [a, b, c] = t.vertices;
    sum += (at(mesh, a) - origin).dot((at(mesh, b) - origin).cross(at(mesh, c) - origin)) / 6;
  }
  return sum;
}

bool sameBytes(const Mesh& a, const Mesh& b) {
  return equalArrays(a.positions, b.positions) && equalArrays(a.normals, b.normals) &&
         equalArrays(a.quads, b.quads) && equalArrays(a.triangles, b.triangles);
}

}  // namespace tufa::test
