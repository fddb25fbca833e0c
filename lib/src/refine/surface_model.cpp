#include "refine/surface_model.h"

#include <utility>

#include "base/shrink.h"
#include "base/triangulate.h"
#include "octree/build_forest.h"
#include "refine/repair_rounded.h"
#include "refine/uniform_repair.h"

namespace tufa::refine {
SurfaceModel::SurfaceModel(grid::Volume volume, const ContourOptions& options,
                           const uniform::StageEnds& ends, base::Job& job)
    : repairs_(options.repair),
      ambiguity_(options.ambiguity),
      cap_(options.cap),
      surface_(uniform::makeUniformSurface(std::move(volume), options, ends, job)),
      report_(uniform::reportOf(surface_)) {
  job.beginStage("repair", ends.repair);
  if (!repairs_) return;
  closePairs_ = repairUniform(surface_, report_, job);
  // What intersects once it is rounded as it will be written moves now: finishMesh() would do so
  // too late for a mesh that is measured against this one, which is what is written of it, too.
  repairRounded(surface_, closePairs_, report_, job);
}

base::TriangleArray SurfaceModel::takeFaces(base::Job& job) {
  hasCells_ = false;
  surface_.topology = {};
  surface_.sheets = uniform::VertexSheets();
  Mesh& mesh = surface_.mesh;
  if (mesh.triangles.empty()) return std::exchange(mesh.quads, {});
  std::vector<Triangle> faces = base::triangulate(mesh, job);
  base::release(mesh.quads), base::release(mesh.triangles);
  return faces;
}

void SurfaceModel::releasePositions() { base::release(surface_.mesh.positions); }

const uniform::UniformSurface& SurfaceModel::withCells(base::Job& job) {
  if (!std::exchange(hasCells_, true)) {
    const grid::Volume& volume = surface_.volume;
    surface_.topology =
        uniform::buildCellTopology(volume.blocks, volume.scale, ambiguity_, cap_, job);
  }
  return surface_;
}

void SurfaceModel::buildClusters(const octree::CutRule& rule, base::Job& job) {
  forest_ = octree::buildForest(view(), rule.maxLevel, rule.boundsAngle(), job);
}

}  // namespace tufa::refine
