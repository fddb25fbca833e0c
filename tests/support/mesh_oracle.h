#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstddef>
#include <ostream>

namespace tufa::test {

/// The combinatorics of a mesh by their plain definitions, written without a look at tufa::check.
/// Faces are taken as they are: a quad is one face of four edges.
struct MeshTopology {
  std::size_t vertices = 0;  ///< used by a face
  std::size_t edges = 0;
  std::size_t faces = 0;
  std::size_t unusedVertices = 0;
  std::size_t boundaryEdges = 0;
  std::size_t nonManifoldEdges = 0;     ///< of three or more faces
  std::size_t misorientedEdges = 0;     ///< passed twice in one direction
  std::size_t nonManifoldVertices = 0;  ///< whose faces are not one open or closed fan
  std::size_t duplicateFaces = 0;       ///< with the vertex set of another face
  std::size_t collapsedFaces = 0;       ///< with a repeated vertex
  std::size_t components = 0;           ///< vertices joined by edges

  [[nodiscard]] long long euler() const {
    return static_cast<long long>(vertices) - static_cast<long long>(edges) +
           static_cast<long long>(faces);
  }
  /// A 2-manifold, perhaps with boundary, each face and vertex in its place.
  [[nodiscard]] bool manifold() const {
    return nonManifoldEdges + misorientedEdges + nonManifoldVertices + duplicateFaces +
               collapsedFaces + unusedVertices ==
           0;
  }
  [[nodiscard]] bool closed() const { return boundaryEdges == 0 && faces > 0; }

  friend bool operator==(const MeshTopology&, const MeshTopology&) = default;
  friend std::ostream& operator<<(std::ostream& out, const MeshTopology& t);
};

[[nodiscard]] MeshTopology inspect(const Mesh& mesh);

/// The same mesh with every quad split.
[[nodiscard]] Mesh triangulated(const Mesh& mesh);

/// Sum of the areas of the triangles.
[[nodiscard]] double area(const Mesh& mesh);

/// Enclosed volume by the divergence theorem, positive if the faces look outward.
[[nodiscard]] double volume(const Mesh& mesh);

/// Edges folded by more than 150 degrees between two faces that both have over 0.05 square voxels.
[[nodiscard]] std::size_t foldedEdges(const Mesh& mesh, double voxelSize);

/// Those of them where `solid`, a uniform mesh, is not as sharp: where it has no two faces over a
/// thousandth of a square voxel, within three voxels, that are as far apart and face as the two of
/// the fold do, to 35 degrees.
[[nodiscard]] std::size_t foldedEdges(const Mesh& mesh, const Mesh& solid, double voxelSize);

/// Bit-equal in every array.
[[nodiscard]] bool sameBytes(const Mesh& a, const Mesh& b);

}  // namespace tufa::test
