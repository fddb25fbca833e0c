#pragma once

#include <tufa/check.h>
#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "check/mesh_samples.h"
#include "check/surface_distance.h"

namespace tufa::checks {

/// The trilinear isosurface of a grid, found once, and how far meshes are from it. Keeps references
/// to its arguments.
class SurfaceReference {
 public:
  /// Two stages of the job: the second ends at `endFraction`.
  SurfaceReference(const openvdb::GridBase& grid, const grid::VoxelFrame& frame,
                   const grid::IsoChoice& iso, double endFraction, base::Job& job)
      : frame_(frame) {
    job.beginStage("isosurface samples", endFraction / 2);
    surface_ = grid::isosurfaceOf(grid, frame, iso);
    std::vector<Vec3> points = surface_->samples(job);
    job.beginStage("sample tree", endFraction);
    std::vector<base::Box> boxes(points.size());
    std::transform(points.begin(), points.end(), boxes.begin(), [](const Vec3& p) {
      return base::Box{p, p};
    });
    Bvh tree(std::move(boxes), job);
    cloud_.emplace(PointCloud{std::move(points), std::move(tree)});
  }

  /// Points on the surface, in voxel space.
  [[nodiscard]] const std::vector<Vec3>& points() const { return cloud_->points; }

  /// The direction in which the field grows there, as a unit vector of voxel space; 0 for none.
  [[nodiscard]] Vec3 direction(const Vec3& point) const {
    return surface_->field()->direction(point);
  }

  /// Measures both ways; four stages of the job, from `beginFraction` on to its end. `visit` is
  /// told the distance of each of points() from the mesh, see measureToMesh().
  template <class Visit>
  void measure(const Mesh& mesh, int samplesPerEdge, double beginFraction, base::Job& job,
               const Visit& visit, DistanceReport& report) const {
    const auto at = [&](double share) { return beginFraction + (1 - beginFraction) * share; };
    job.beginStage("mesh tree", at(0.1));
    const TriangleSoup soup(mesh, frame_, job);
    job.beginStage("surface to mesh", at(0.4));
    report.surfaceToMesh = measureToMesh(soup, cloud_->points, job, visit).summary();
    const auto newDistance = [&] { return SurfaceDistance(surface_->field(), *cloud_); };
    job.beginStage("vertices to surface", at(0.5));
    Tally tally = measureVertices(soup, job, newDistance);
    job.beginStage("triangles to surface", 1);
    tally += measureTriangles(soup, samplesPerEdge, job, newDistance);
    report.meshToSurface = tally.summary();
  }

 private:
  const grid::VoxelFrame& frame_;
  std::unique_ptr<const grid::Isosurface> surface_;
  std::optional<PointCloud> cloud_;
};

}  // namespace tufa::checks
