#pragma once

#include <tufa/mesh.h>

#include <cstddef>
#include <string>

namespace tufa::tools {

/// The edges of one face only, where vertices at one place count as one.
[[nodiscard]] std::size_t countOpenEdges(const Mesh& mesh);

/// Tells on standard error that a mesh that should be closed is open, if it is. `what` is uncertain
/// then.
void noteOpenMesh(const Mesh& mesh, const std::string& what);

}  // namespace tufa::tools
