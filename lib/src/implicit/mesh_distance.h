#pragma once

#include <tufa/mesh.h>
#include <functional>

#include "base/vec3.h"
#include "implicit/fields.h"

namespace tufa::implicit {

/// The exact signed distance to a closed mesh that does not intersect itself. Throws
/// Error(InvalidArgument) for meshes without faces, with vertices that are no numbers, open ones,
/// such as have edges of more than two faces or of faces that turn both ways, those that face
/// inward, and those with parts that have no area. What requireSolid() asks beyond that is not
/// asked here.
[[nodiscard]] FieldPtr makeMeshSolid(const Mesh& mesh);

/// The signed distance from a point to a mesh. `most`: a bound of its size, infinity if none is
/// known; a small one makes the search for the nearest triangle short.
using SignedDistance = std::function<double(const Vec3& p, double most)>;

/// The distance of makeMeshSolid(). Throws the same.
[[nodiscard]] SignedDistance signedDistanceTo(const Mesh& mesh);

/// What is nearer to a mesh, which may be open, than half the thickness. Throws
/// Error(InvalidArgument) as above for the first two.
[[nodiscard]] FieldPtr makeMeshSheet(const Mesh& mesh, double thickness);

}  // namespace tufa::implicit
