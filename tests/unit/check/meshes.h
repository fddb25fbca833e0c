#pragma once

#include <tufa/mesh.h>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

namespace tufa::test {

/// An axis-aligned box of quads, normals outward.
inline Mesh box(const Position& lower, const Position& upper) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                                (i & 4) != 0 ? upper.z : lower.z);
  }
  mesh.quads = {Quad(0, 2, 3, 1), Quad(4, 5, 7, 6), Quad(0, 1, 5, 4),
                Quad(2, 6, 7, 3), Quad(0, 4, 6, 2), Quad(1, 3, 7, 5)};
  return mesh;
}

/// A tetrahedron with one corner at `corner` and its edges along the axes, normals outward.
inline Mesh tetrahedron(const Position& corner, double size = 1) {
  Mesh mesh;
  mesh.positions = {corner, Position(corner.x + size, corner.y, corner.z),
                    Position(corner.x, corner.y + size, corner.z),
                    Position(corner.x, corner.y, corner.z + size)};
  mesh.triangles = {Triangle(0, 2, 1), Triangle(0, 1, 3), Triangle(0, 3, 2), Triangle(1, 2, 3)};
  return mesh;
}

/// Turns all faces around.
inline Mesh inverted(Mesh mesh) {
  for (Triangle& face : mesh.triangles) std::swap(face.vertices[1], face.vertices[2]);
  for (Quad& face : mesh.quads) std::swap(face.vertices[1], face.vertices[3]);
  return mesh;
}

/// Puts two meshes into one, without sharing vertices.
inline Mesh joined(Mesh mesh, const Mesh& other) {
  const auto offset = static_cast<VertexIndex>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (Triangle face : other.triangles) {
    for (VertexIndex& v : face.vertices) v += offset;
    mesh.triangles.push_back(face);
  }
  for (Quad face : other.quads) {
    for (VertexIndex& v : face.vertices) v += offset;
    mesh.quads.push_back(face);
  }
  return mesh;
}

/// A torus around the z axis: quads on a closed grid of `around` by `across`.
inline Mesh torus(double major, double minor, unsigned around, unsigned across) {
  Mesh mesh;
  const double turn = 2 * std::numbers::pi;
  for (unsigned i = 0; i < around; ++i) {
    for (unsigned j = 0; j < across; ++j) {
      const double u = turn * i / around;
      const double v = turn * j / across;
      const double r = major + minor * std::cos(v);
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
      const unsigned i1 = (i + 1) % around;
      const unsigned j1 = (j + 1) % across;
      mesh.quads.emplace_back(i * across + j, i1 * across + j, i1 * across + j1, i * across + j1);
    }
  }
  return mesh;
}

/// A sphere about the origin: an octahedron, each face split in four `levels` times.
inline Mesh sphere(double radius, int levels) {
  Mesh mesh;
  mesh.positions = {Position(1, 0, 0),  Position(-1, 0, 0), Position(0, 1, 0),
                    Position(0, -1, 0), Position(0, 0, 1),  Position(0, 0, -1)};
  mesh.triangles = {Triangle(0, 2, 4), Triangle(2, 1, 4), Triangle(1, 3, 4), Triangle(3, 0, 4),
                    Triangle(2, 0, 5), Triangle(1, 2, 5), Triangle(3, 1, 5), Triangle(0, 3, 5)};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<VertexIndex, VertexIndex>, VertexIndex> middles;
    const auto middle = [&](VertexIndex a, VertexIndex b) {
      const auto [at, isNew] =
          middles.try_emplace(std::minmax(a, b), static_cast<VertexIndex>(mesh.positions.size()));
      if (isNew) {
        const Position p = mesh.positions[a];
        const Position q = mesh.positions[b];
        mesh.positions.emplace_back((p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2);
      }
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& face : mesh.triangles) {
      const auto [a, b, c] = face.vertices;
      const VertexIndex ab = middle(a, b);
      const VertexIndex bc = middle(b, c);
      const VertexIndex ca = middle(c, a);
      finer.insert(finer.end(), {Triangle(a, ab, ca), Triangle(ab, b, bc), Triangle(ca, bc, c),
                                 Triangle(ab, bc, ca)});
    }
    mesh.triangles = std::move(finer);
  }
  for (Position& p : mesh.positions) {
    const double scale = radius / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    p = Position(p.x * scale, p.y * scale, p.z * scale);
  }
  return mesh;
}

}  // namespace tufa::test
