// Rays to the triangles of meshes.

#include <tufa/rays.h>

#include <tufa/error.h>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/box_ray.h"
#include "base/bvh.h"
#include "base/job.h"
#include "base/require_mesh.h"
#include "base/sheared_ray.h"
#include "rays/surface.h"

namespace tufa {
namespace rays {
namespace {

base::Box boundsOfAll(const Mesh& mesh, const std::vector<Triangle>& triangles) {
  base::requireFaces(mesh);
  base::Box all = base::Box::empty();
  for (const Triangle& triangle : triangles) {
    for (const VertexIndex vertex : triangle.vertices) {
      const Vec3 point = mesh.positions[vertex];
      if (!point.isFinite()) {
        throw Error(ErrorCode::InvalidArgument,
                    "vertex " + std::to_string(vertex) + " of the mesh is not finite");
      }
      all.add(point);
    }
  }
  return all;
}

class MeshSurface final : public RaySurface {
 public:
  MeshSurface(const Mesh& mesh, std::vector<Triangle> triangles, const base::Box& bounds,
              base::Job& job)
      : RaySurface(bounds, 1e-6 * bounds.size().length()),
        positions_(mesh.positions),
        triangles_(std::move(triangles)),
        tree_(boxesOf(*this), job) {}

  [[nodiscard]] std::unique_ptr<Caster> caster() const override;

  [[nodiscard]] std::array<Vec3, 3> corners(std::size_t triangle) const {
    const auto& v = triangles_[triangle].vertices;
    return {positions_[v[0]], positions_[v[1]], positions_[v[2]]};
  }
  [[nodiscard]] const base::Bvh& tree() const { return tree_; }

 private:
  static std::vector<base::Box> boxesOf(const MeshSurface& mesh) {
    std::vector<base::Box> boxes(mesh.triangles_.size(), base::Box::empty());
    for (std::size_t n = 0; n < boxes.size(); ++n) {
      for (const Vec3& corner : mesh.corners(n)) boxes[n].add(corner);
    }
    return boxes;
  }

  std::vector<Position> positions_;
  std::vector<Triangle> triangles_;
  base::Bvh tree_;
};

class MeshCaster final : public Caster {
 public:
  explicit MeshCaster(const MeshSurface& mesh) : mesh_(mesh) {}

  [[nodiscard]] std::optional<RayHit> cast(const UnitRay& ray) override {
    const base::ShearedRay sheared(ray.origin, ray.direction);
    double to = ray.greatest;
    std::optional<std::uint32_t> nearest;
    mesh_.tree().itemsAlong({ray.origin, ray.direction, ray.least}, to, [&](std::uint32_t n) {
      const auto distance = sheared.passes(mesh_.corners(n));
      if (!distance || !(*distance >= ray.least && *distance <= to)) return;
      // Of two at one edge the first in the mesh, whatever the order of the tree.
      if (*distance == to && nearest && *nearest < n) return;
      to = *distance;
      nearest = n;
    });
    if (!nearest) return std::nullopt;
    const auto corners = mesh_.corners(*nearest);
    Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!normal.normalize(0)) normal = Vec3(0.0);
    return RayHit{to, ray.at(to), static_cast<Normal>(normal), *nearest};
  }

 private:
  const MeshSurface& mesh_;
};

std::unique_ptr<Caster> MeshSurface::caster() const { return std::make_unique<MeshCaster>(*this); }

}  // namespace
}  // namespace rays

std::shared_ptr<const RaySurface> makeRaySurface(const Mesh& mesh,
                                                 const RaySurfaceOptions& options) {
  std::vector<Triangle> triangles = triangulate(mesh);
  const base::Box bounds = rays::boundsOfAll(mesh, triangles);
  base::Job job(options.threads, options.progress);
  std::shared_ptr<const RaySurface> surface;
  job.run([&] {
    job.beginStage("tree", 1);
    surface = std::make_shared<rays::MeshSurface>(mesh, std::move(triangles), bounds, job);
  });
  job.finish();
  return surface;
}

}  // namespace tufa
