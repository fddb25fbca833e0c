#include "check/repair_steps.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/copy_face_graph.h>
#include <CGAL/property_map.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace tufa::checks {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using Polygon = std::vector<std::size_t>;

struct Soup {
  std::vector<Point> points;
  std::vector<Polygon> polygons;
};

/// The faces that have three vertices at finite places.
Soup soupOf(const Mesh& mesh, RepairReport& report) {
  Soup soup;
  for (const Position& p : mesh.positions) {
    const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    soup.points.emplace_back(finite ? p.x : 0, finite ? p.y : 0, finite ? p.z : 0);
  }
  const auto isUsable = [&](VertexIndex v) {
    if (v >= mesh.positions.size()) return false;
    const Position& p = mesh.positions[v];
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  for (const Triangle& triangle : triangulate(mesh)) {
    const auto& v = triangle.vertices;
    if (isUsable(v[0]) && isUsable(v[1]) && isUsable(v[2])) {
      soup.polygons.push_back({v[0], v[1], v[2]});
    } else {
      ++report.degenerateFaces;
    }
  }
  return soup;
}

/// Makes each vertex one with the first of those nearer than the distance, in the order of indices.
void mergeNear(Soup& soup, double distance) {
  using Item = std::pair<Point, std::size_t>;
  using Traits = CGAL::Search_traits_adapter<Item, CGAL::First_of_pair_property_map<Item>,
                                             CGAL::Search_traits_3<Kernel>>;
  std::vector<Item> items;
  for (std::size_t i = 0; i < soup.points.size(); ++i) items.emplace_back(soup.points[i], i);
  const CGAL::Kd_tree<Traits> tree(items.begin(), items.end());
  std::vector<bool> merged(soup.points.size(), false);
  const std::vector<Point> before = soup.points;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (merged[i]) continue;
    std::vector<Item> near;
    tree.search(std::back_inserter(near),
                CGAL::Fuzzy_sphere<Traits>(before[i], distance, 0, tree.traits()));
    for (const Item& item : near) {
      if (item.second <= i || merged[item.second]) continue;
      merged[item.second] = true;
      soup.points[item.second] = before[i];
    }
  }
}

void dropUnused(Soup& soup, RepairReport& report) {
  report.unusedVertices += pmp::remove_isolated_points_in_polygon_soup(soup.points, soup.polygons);
}

/// Drops faces with a repeated vertex or three vertices on a line.
void dropDegenerate(Soup& soup, RepairReport& report) {
  const auto isDegenerate = [&](const Polygon& face) {
    return CGAL::collinear(soup.points[face[0]], soup.points[face[1]], soup.points[face[2]]);
  };
  const auto end = std::remove_if(soup.polygons.begin(), soup.polygons.end(), isDegenerate);
  report.degenerateFaces += static_cast<std::size_t>(soup.polygons.end() - end);
  soup.polygons.erase(end, soup.polygons.end());
}

/// The parts of a surface whose faces are joined by edges.
struct Parts {
  SurfaceMesh::Property_map<SurfaceMesh::Face_index, std::size_t> ofFace;
  std::size_t count = 0;
};

Parts partsOf(SurfaceMesh& surface) {
  Parts parts{surface.add_property_map<SurfaceMesh::Face_index, std::size_t>("f:part").first};
  parts.count = pmp::connected_components(surface, parts.ofFace);
  return parts;
}

/// Drops the parts that have a border, or those that have none; returns how many.
std::size_t dropParts(SurfaceMesh& surface, bool areOpen) {
  const Parts parts = partsOf(surface);
  std::vector<bool> open(parts.count, false);
  for (const auto halfedge : surface.halfedges()) {
    if (!surface.is_border(halfedge)) continue;
    open[parts.ofFace[surface.face(surface.opposite(halfedge))]] = true;
  }
  std::vector<std::size_t> dropped;
  for (std::size_t part = 0; part < parts.count; ++part) {
    if (open[part] == areOpen) dropped.push_back(part);
  }
  pmp::remove_connected_components(surface, dropped, parts.ofFace);
  surface.collect_garbage();
  return dropped.size();
}

/// The faces' normals, as long as their areas twice.
std::vector<Kernel::Vector_3> areasOf(const Soup& soup) {
  std::vector<Kernel::Vector_3> areas;
  for (const Polygon& face : soup.polygons) {
    const Point& a = soup.points[face[0]];
    areas.push_back(CGAL::cross_product(soup.points[face[1]] - a, soup.points[face[2]] - a));
  }
  return areas;
}

/// The surface of a soup of faces, all of each part on the side that most of its area is on.
SurfaceMesh orientedSurface(Soup& soup) {
  const auto before = areasOf(soup);
  pmp::orient_polygon_soup(soup.points, soup.polygons);
  const auto after = areasOf(soup);
  SurfaceMesh surface;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.polygons, surface);
  const Parts parts = partsOf(surface);
  std::vector<double> kept(parts.count, 0);  // area that was not turned less area that was
  for (const auto face : surface.faces()) {
    const double length = std::sqrt(after[face].squared_length());
    kept[parts.ofFace[face]] += std::copysign(length, before[face] * after[face]);
  }
  std::vector<SurfaceMesh::Face_index> turned;
  for (const auto face : surface.faces()) {
    if (kept[parts.ofFace[face]] < 0) turned.push_back(face);
  }
  pmp::reverse_face_orientations(turned, surface);
  return surface;
}

std::size_t borderEdges(const SurfaceMesh& surface, SurfaceMesh::Halfedge_index start) {
  std::size_t count = 0;
  auto halfedge = start;
  do {
    ++count;
    halfedge = surface.next(halfedge);
  } while (halfedge != start);
  return count;
}

void fillHoles(SurfaceMesh& surface, int mostEdges, RepairReport& report) {
  const Parts parts = partsOf(surface);
  std::vector<std::size_t> faces(parts.count, 0);
  for (const auto face : surface.faces()) ++faces[parts.ofFace[face]];
  std::vector<SurfaceMesh::Halfedge_index> holes;
  pmp::extract_boundary_cycles(surface, std::back_inserter(holes));
  for (const auto hole : holes) {
    const std::size_t edges = borderEdges(surface, hole);
    if (edges > static_cast<std::size_t>(mostEdges)) continue;
    // The outline of a sheet without vertices inside is no hole: it is filled already.
    if (faces[parts.ofFace[surface.face(surface.opposite(hole))]] + 2 <= edges) continue;
    std::vector<SurfaceMesh::Face_index> patch;
#if CGAL_VERSION_NR >= CGAL_VERSION_NUMBER(5, 6, 0)
    pmp::triangulate_hole(surface, hole,
                          CGAL::parameters::face_output_iterator(std::back_inserter(patch)));
#else
    pmp::triangulate_hole(surface, hole, std::back_inserter(patch));
#endif
    report.filledHoles += patch.empty() ? 0 : 1;
  }
}

void dropOpenParts(SurfaceMesh& surface, RepairReport& report) {
  SurfaceMesh closed = surface;
  const std::size_t dropped = dropParts(closed, true);
  if (closed.is_empty()) return;
  surface = std::move(closed);
  report.droppedParts = dropped;
}

/// Turns closed parts so that they bound a volume. Which side is out is known of closed surfaces
/// that do not pass through themselves.
void orientClosedParts(SurfaceMesh& surface) {
  SurfaceMesh closed = surface;
  const std::size_t open = dropParts(closed, true);
  if (closed.is_empty() || pmp::does_self_intersect(closed)) return;
  pmp::orient_to_bound_a_volume(closed);
  if (open == 0) {
    surface = std::move(closed);
    return;
  }
  dropParts(surface, false);
  CGAL::copy_face_graph(closed, surface);
}

Mesh meshOf(const SurfaceMesh& surface) {
  Mesh mesh;
  std::vector<VertexIndex> number(surface.number_of_vertices() +
                                  surface.number_of_removed_vertices());
  for (const auto vertex : surface.vertices()) {
    if (surface.is_isolated(vertex)) continue;
    number[vertex] = static_cast<VertexIndex>(mesh.positions.size());
    const Point& p = surface.point(vertex);
    mesh.positions.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto face : surface.faces()) {
    std::array<VertexIndex, 3> v{};
    int count = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face))) {
      v[count++] = number[vertex];
    }
    mesh.triangles.emplace_back(v[0], v[1], v[2]);
  }
  return mesh;
}

}  // namespace

Mesh runRepairSteps(const Mesh& mesh, const RepairOptions& options, RepairReport& report,
                    const std::function<void(double)>& step) {
  step(0);
  Soup soup = soupOf(mesh, report);
  dropUnused(soup, report);
  if (options.mergeDistance > 0) mergeNear(soup, options.mergeDistance);
  report.mergedVertices = pmp::merge_duplicate_points_in_polygon_soup(soup.points, soup.polygons);
  step(0.2);
  dropDegenerate(soup, report);
  report.duplicateFaces = pmp::merge_duplicate_polygons_in_polygon_soup(
      soup.points, soup.polygons, CGAL::parameters::erase_all_duplicates(false));
  dropUnused(soup, report);
  if (soup.polygons.empty()) return {};  // CGAL's functions want one
  step(0.4);
  const std::size_t whole = soup.points.size();
  SurfaceMesh surface = orientedSurface(soup);
  pmp::stitch_borders(surface);
  pmp::duplicate_non_manifold_vertices(surface);
  surface.collect_garbage();
  if (surface.number_of_vertices() > whole) {
    report.splitVertices = surface.number_of_vertices() - whole;
  }
  step(0.6);
  if (options.fillEdges > 0) fillHoles(surface, options.fillEdges, report);
  if (options.dropOpen) dropOpenParts(surface, report);
  surface.collect_garbage();
  step(0.8);
  orientClosedParts(surface);
  return meshOf(surface);
}

}  // namespace tufa::checks
