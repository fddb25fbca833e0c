#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <array>
#include <vector>

namespace tufa {

/// The order in which a face names its corners, seen from outside.
enum class Winding {
  CounterClockwise,  ///< as in USD, glTF and Mesh
  Clockwise,         ///< as in Houdini and Alembic
};

/// Options of toFloat().
struct FloatMeshOptions {
  Winding winding = Winding::CounterClockwise;  ///< of the faces
  /// Count positions from the middle of the mesh where single precision would move some, which
  /// FloatMesh::origin then tells; otherwise, and in any other mesh, from the world's origin.
  bool relative = true;
};

/// A mesh in the arrays that hosts such as USD, Alembic and Houdini take: points, the number of
/// corners of each face, and the corners of one face after the other.
struct FloatMesh {
  std::vector<std::array<float, 3>> positions;  ///< counted from `origin`, world units
  std::vector<std::array<float, 3>> normals;    ///< empty, or one for each position
  std::vector<int> faceCounts;                  ///< 4 for each quad, then 3 for each triangle
  std::vector<int> faceIndices;                 ///< into positions
  Position origin{0, 0, 0};                     ///< world space
};

/// Copies a mesh into arrays for hosts. Its attributes are such arrays already: Attribute::values.
/// Throws Error: InvalidArgument for a position that is not finite, a face that names no vertex,
/// and normals that are not one for each position; LimitExceeded if an int cannot count the
/// positions or the corners, and for positions that no float is near.
[[nodiscard]] TUFA_API FloatMesh toFloat(const Mesh& mesh, const FloatMeshOptions& options = {});

}  // namespace tufa
