#pragma once

#include <tufa/contour.h>

namespace tufa::test {

/// contour() with every cell meshed on its own.
inline Mesh uniformMesh(const openvdb::GridBase& grid, ContourOptions options = {},
                        ContourReport* report = nullptr) {
  options.uniform = true;
  return contour(grid, options, report);
}

/// The crossed lattice edges that a uniform mesh stands for: a quad each, or the four triangles
/// that the repair put in its place.
inline std::size_t edgesOf(const Mesh& mesh) {
  return mesh.quads.size() + mesh.triangles.size() / 4;
}

}  // namespace tufa::test
