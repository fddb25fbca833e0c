#include "check/bounds_volume.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

namespace tufa::checks {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// Copies faces with the vertices they use: CGAL takes every vertex for part of the surface. False
/// if a face does not fit the others.
bool copyFaces(const Faces& faces, SurfaceMesh& surface) {
  const std::size_t edges = 3 * faces.proper.size() / 2;
  surface.reserve(static_cast<SurfaceMesh::size_type>(faces.proper.size() / 2 + 2),
                  static_cast<SurfaceMesh::size_type>(edges),
                  static_cast<SurfaceMesh::size_type>(faces.proper.size()));
  std::vector<SurfaceMesh::Vertex_index> copies(faces.positions.size());
  const auto copyOf = [&](VertexIndex v) {
    if (!copies[v].is_valid()) {
      const Position& p = faces.positions[v];
      copies[v] = surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z));
    }
    return copies[v];
  };
  for (const Triangle& face : faces.proper) {
    const auto& v = face.vertices;
    const auto a = copyOf(v[0]);
    const auto b = copyOf(v[1]);
    const auto c = copyOf(v[2]);
    if (surface.add_face(a, b, c) == SurfaceMesh::null_face()) return false;
  }
  return true;
}

}  // namespace

bool cgalBoundsVolume(const Faces& faces) {
  // CGAL tells of violated preconditions by exceptions in builds that test them.
  try {
    SurfaceMesh surface;
    return copyFaces(faces, surface) && CGAL::Polygon_mesh_processing::does_bound_a_volume(surface);
  } catch (const CGAL::Failure_exception&) {
    return false;
  }
}

}  // namespace tufa::checks
