#pragma once

#include <tufa/mesh.h>
#include <functional>

#include "base/vec3.h"
#include "implicit/fields.h"

namespace tufa::implicit {

/// The exact signed distance to a closed mesh that does not intersect itself. Throws
/// Error(InvalidArgument) for meshes without faces, with vertices that are no numbers, open ones,
/// such as have edges of more than two faces or of faces that turn both ways, those that face
/// inward, and those with parts that have no area.
[[nodiscard]] FieldPtr makeMeshSolid(const Mesh& mesh);

/// The signed distance at a point that is no farther than `most` from the mesh.
using SignedDistance = std::function<double(const Vec3& p, double most)>;

/// That of makeMeshSolid(), for points that are near ones before. Throws the same.
[[nodiscard]] SignedDistance signedDistanceTo(const Mesh& mesh);

/// What is nearer to a mesh, which may be open, than half the thickness. Throws
/// Error(InvalidArgument) as above for the first two.
[[nodiscard]] FieldPtr makeMeshSheet(const Mesh& mesh, double thickness);

}  // namespace tufa::implicit
