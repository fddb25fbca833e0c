#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "chunks/cut/cut_mesh.h"

namespace tufa::chunks {

/// Some triangles of a cut mesh, with the same chunks and planes.
struct SubMesh {
  CutMesh cut;
  std::vector<VertexIndex> vertices;     ///< of the mesh: those of its triangles, rising
  std::vector<std::uint32_t> triangles;  ///< of the mesh, rising
};

/// Takes the marks, other than 0, from all triangles at vertices where the marked ones are no
/// single fan, until there are no such vertices: what is marked then is manifold where the mesh is.
/// Cost: linear in the marked triangles, for each of a few passes.
void keepManifold(const CutMesh& mesh, std::vector<std::uint8_t>& marks, base::Job& job);

/// The triangles t of a mesh for which isWanted[t] is not 0.
[[nodiscard]] SubMesh subMesh(const CutMesh& mesh, const std::vector<std::uint8_t>& isWanted,
                              base::Job& job);

}  // namespace tufa::chunks
