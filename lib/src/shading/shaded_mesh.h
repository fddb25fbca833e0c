#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <span>
#include <vector>

#include "base/job.h"

namespace tufa::shading {

/// A mesh for graphics cards: each vertex has one normal, so a point on a crease becomes one vertex
/// for each smooth group of faces around it.
struct ShadedMesh {
  std::vector<VertexIndex> sources;  ///< for each vertex its element of Mesh::positions
  std::vector<Normal> normals;       ///< one for each vertex
  std::vector<VertexIndex> indices;  ///< three for each triangle
};

/// Splits vertices where the normals of faces that share an edge differ by more than `creaseAngle`
/// degrees, and where those of groups of faces do by more than twice that on the whole: small faces
/// that bevel a crease do not connect its sides. A vertex with one group keeps the mesh's normal,
/// if there is one and it is within half that angle of the faces; the others get the mean of their
/// faces' normals, weighted by angle. Positions that no face uses are left out.
[[nodiscard]] ShadedMesh splitAtCreases(const Mesh& mesh, double creaseAngle, base::Job& job);

/// The same without splitting any, and without normals if the mesh has none.
[[nodiscard]] ShadedMesh unsplit(const Mesh& mesh);

/// Reorders triangles for the vertex cache of graphics cards and vertices by their first use.
/// Neither changes the surface. Triangles stay in their parts, of which `parts` has the sizes, in
/// indices; together they are all of the mesh's.
void orderForGraphics(ShadedMesh& mesh, std::span<const std::size_t> parts);

}  // namespace tufa::shading
