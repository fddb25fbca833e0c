#pragma once

#include <tufa/mesh.h>

namespace tufa::base {

/// Throws Error(InvalidArgument) if a face names a vertex that there is not.
void requireFaces(const Mesh& mesh);

/// Throws Error(InvalidArgument) if there are normals, and not one for each position.
void requireNormals(const Mesh& mesh);

/// Throws Error(InvalidArgument) for a position that is not finite.
void requireFinite(const Mesh& mesh);

}  // namespace tufa::base
