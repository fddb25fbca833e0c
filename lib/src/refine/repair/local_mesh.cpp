#include "refine/repair/local_mesh.h"

#include <algorithm>

#include "base/sort_unique.h"
#include "intersect/triangle_pair.h"

namespace tufa::refine {

LocalMesh::LocalMesh(const intersect::Surface& surface,
                     std::vector<intersect::PolygonIndex> polygons)
    : numbers_(std::move(polygons)),
      polygons_(numbers_.size()),
      counts_(numbers_.size()),
      boxes_(numbers_.size()) {
  for (const intersect::PolygonIndex polygon : numbers_) {
    const intersect::Corners corners = surface.corners(polygon);
    vertices_.insert(vertices_.end(), corners.begin(), corners.end());
  }
  base::sortUnique(vertices_);
  points_.reserve(vertices_.size());
  for (const VertexIndex vertex : vertices_) points_.push_back(surface.mesh().positions[vertex]);
  around_.resize(vertices_.size());
  for (Local polygon = 0; polygon < polygonCount(); ++polygon) {
    const intersect::Corners corners = surface.corners(numbers_[polygon]);
    counts_[polygon] = static_cast<std::uint8_t>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), corners[i]);
      const auto local = static_cast<Local>(found - vertices_.begin());
      polygons_[polygon].vertices[i] = local;
      around_[local].push_back(polygon);
    }
    updateBox(polygon);
  }
}

LocalMesh::Local LocalMesh::find(intersect::PolygonIndex polygon) const {
  return static_cast<Local>(std::lower_bound(numbers_.begin(), numbers_.end(), polygon) -
                            numbers_.begin());
}

void LocalMesh::updateBox(Local polygon) {
  base::Box box = base::Box::empty();
  for (const Local vertex : corners(polygon)) {
    const Position& p = points_[vertex];
    box.add(Vec3(p));
  }
  boxes_[polygon] = box;
}

void LocalMesh::move(Local vertex, const Position& to) {
  points_[vertex] = to;
  for (const Local polygon : around_[vertex]) updateBox(polygon);
}

void LocalMesh::turn(Local quad) {
  auto& v = polygons_[quad].vertices;
  std::rotate(v.begin(), v.begin() + 1, v.end());
}

bool LocalMesh::isFlat(Local polygon) const {
  std::array<Triangle, 2> triangles;
  const int count = intersect::trianglesOf(corners(polygon), triangles);
  for (int i = 0; i < count; ++i) {
    if (intersect::isFlat(points_, triangles[i])) return true;
  }
  return false;
}

void LocalMesh::fan(Local quad, const Position& centre) {
  const auto v = polygons_[quad].vertices;
  const auto middle = static_cast<Local>(points_.size());
  points_.push_back(centre);
  around_.push_back({quad});
  for (int i = 0; i < 4; ++i) {
    Local polygon = quad;
    if (i > 0) {
      polygon = polygonCount();
      polygons_.emplace_back();
      boxes_.emplace_back();
      counts_.push_back(3);
      for (const Local vertex : {middle, v[i], v[(i + 1) % 4]}) around_[vertex].push_back(polygon);
    }
    polygons_[polygon].vertices = {middle, v[i], v[(i + 1) % 4], 0};
    counts_[polygon] = 3;
    updateBox(polygon);
  }
}

void LocalMesh::unfan(Local quad, const Quad& was) {
  for (int i = 3; i > 0; --i) {
    for (const Local vertex : {was.vertices[i], was.vertices[(i + 1) % 4]}) {
      around_[vertex].pop_back();
    }
    polygons_.pop_back();
    boxes_.pop_back();
    counts_.pop_back();
  }
  points_.pop_back();
  around_.pop_back();
  polygons_[quad] = was;
  counts_[quad] = 4;
  updateBox(quad);
}

}  // namespace tufa::refine
