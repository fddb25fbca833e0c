#include "support/uniform_mesh.h"

#include <openvdb/openvdb.h>

namespace tufa::test {

Mesh uniformMesh(const openvdb::GridBase& grid, ContourOptions options, ContourReport* report) {
  options.uniform = true;
  return contour(grid, options, report);
}

std::size_t edgesOf(const Mesh& mesh) { return mesh.quads.size() + mesh.triangles.size() / 4; }

}  // namespace tufa::test
