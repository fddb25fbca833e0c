#pragma once

#include <openvdb/openvdb.h>
#include <tufa/contour.h>

#include <numeric>
#include <utility>

#include "base/job.h"
#include "grid/vdb_coord.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "octree/cut_rule.h"
#include "refine/surface_model.h"
#include "support/fields.h"

namespace tufa::test {

/// A cut and its mesh.
struct MeshOfCut {
  octree::Cut cut;
  octree::CutMesh made;
};

/// A grid with its surface model, clusters and all.
class ModelOf {
 public:
  explicit ModelOf(openvdb::FloatGrid::ConstPtr grid, const ContourOptions& options = {})
      : grid_(std::move(grid)),
        job_(1, {}),
        rule_(octree::readRule(options, grid::transformOf(*grid_))),
        model_(grid::openVolume(*grid_, options, job_), options, {}, job_) {
    model_.buildClusters(rule_, job_);
  }

  [[nodiscard]] refine::SurfaceModel& model() { return model_; }
  [[nodiscard]] const refine::SurfaceModel& model() const { return model_; }
  [[nodiscard]] const Mesh& mesh() const { return model_.mesh(); }
  [[nodiscard]] const octree::CutRule& rule() const { return rule_; }
  [[nodiscard]] double voxelSize() const { return model_.affine().voxelSize(); }
  [[nodiscard]] base::Job& job() { return job_; }

  /// The uniform mesh as a cut of level-0 cells.
  [[nodiscard]] MeshOfCut uniformCut() const {
    MeshOfCut uniform;
    const std::size_t count = mesh().positions.size();
    uniform.cut.vertexOf.resize(count);
    std::iota(uniform.cut.vertexOf.begin(), uniform.cut.vertexOf.end(), VertexIndex{0});
    uniform.cut.clusters.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) uniform.cut.clusters[i].cluster = i;
    uniform.made.mesh = mesh();
    uniform.made.quadSources.resize(mesh().quads.size());
    std::iota(uniform.made.quadSources.begin(), uniform.made.quadSources.end(), 0U);
    return uniform;
  }

 private:
  openvdb::FloatGrid::ConstPtr grid_;
  base::Job job_;
  octree::CutRule rule_;
  refine::SurfaceModel model_;
};

/// A level set around the origin, of a distance of index space.
template <class Function>
openvdb::FloatGrid::Ptr levelSetOf(int reach, double voxelSize, const Function& distance) {
  return levelSet<openvdb::FloatGrid>(
      {openvdb::Coord(-reach), openvdb::Coord(reach)}, 3,
      [&](const openvdb::Coord& at) { return distance(Vec3(grid::fromVdb(at))); }, voxelSize);
}

/// A ball around the origin of index space.
inline openvdb::FloatGrid::Ptr ballOf(double radius, double voxelSize = 1) {
  return levelSetOf(static_cast<int>(radius) + 5, voxelSize,
                    [&](const Vec3& p) { return p.length() - radius; });
}

}  // namespace tufa::test
