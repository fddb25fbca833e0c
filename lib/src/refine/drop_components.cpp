#include "refine/drop_components.h"

#include <algorithm>
#include <limits>

#include "base/box.h"
#include "base/polygons.h"
#include "refine/tolerance_scales.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Component {
  base::Box box = base::Box::empty();
  double tolerance = kInfinity;  // the least at one of its uniform vertices, voxels
  std::size_t baseVertices = 0;
  bool present = false;  // has polygons
  bool gone = false;
};

template <class Polygon>
void removeWhere(const std::vector<std::uint8_t>& gone, std::vector<Polygon>& polygons,
                 std::vector<std::uint32_t>& sources) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (gone[polygons[i].vertices[0]] != 0) continue;
    polygons[kept] = polygons[i];
    sources[kept++] = sources[i];
  }
  polygons.resize(kept);
  sources.resize(kept);
}

}  // namespace

double dropComponents(const uniform::SurfaceView& base, const octree::CutRule& rule,
                      const octree::Cut& cut, octree::CutMesh& made,
                      std::vector<Dropped>& dropped) {
  Mesh& own = made.mesh;
  const std::vector<VertexIndex> componentOf = topology::connectedComponentsOf(own);
  std::vector<Component> components(own.positions.size());
  base::forPolygons(own, [&](base::PolygonIndex, base::Corners v) {
    components[componentOf[v[0]]].present = true;
  });
  for (std::size_t i = 0; i < base.mesh.positions.size(); ++i) {
    Component& component = components[componentOf[cut.vertexOf[i]]];
    if (!component.present) continue;
    const Vec3 point = base.mesh.positions[i];
    component.box.add(point);
    component.tolerance = std::min(component.tolerance, toleranceAt(rule, base.affine, point));
    ++component.baseVertices;
  }
  const auto largest = std::max_element(
      components.begin(), components.end(),
      [](const Component& a, const Component& b) { return a.baseVertices < b.baseVertices; });
  double next = 0;
  bool any = false;
  for (auto component = components.begin(); component != components.end(); ++component) {
    if (!component->present || component == largest) continue;
    const double size = component->box.size().length() / base.affine.voxelSize();
    component->gone = size <= component->tolerance;
    any |= component->gone;
    if (component->gone) {
      dropped.push_back({component->box.centre(), size});
    } else if (component->tolerance > 0 && (next == 0 || size < next)) {
      next = size;
    }
  }
  if (!any) return next;
  std::vector<std::uint8_t> gone(own.positions.size());
  for (std::size_t i = 0; i < gone.size(); ++i) gone[i] = components[componentOf[i]].gone ? 1 : 0;
  removeWhere(gone, own.quads, made.quadSources);
  removeWhere(gone, own.triangles, made.triangleSources);
  return next;
}

std::vector<std::uint8_t> removeUnused(Mesh& mesh, std::vector<VertexIndex>& baseVertices) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  base::forCorners(mesh, [&](VertexIndex vertex) { used[vertex] = 1; });
  std::vector<VertexIndex> numbers(used.size());
  VertexIndex count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    mesh.positions[count] = mesh.positions[i];
    mesh.normals[count] = mesh.normals[i];
    baseVertices[count] = baseVertices[i];
    numbers[i] = count++;
  }
  mesh.positions.resize(count);
  mesh.normals.resize(count);
  baseVertices.resize(count);
  base::forCorners(mesh, [&](VertexIndex& vertex) { vertex = numbers[vertex]; });
  return used;
}

}  // namespace tufa::refine
