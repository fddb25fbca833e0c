#include "refine/surface_model.h"
#include "octree/build_forest.h"

#include <utility>

#include "refine/uniform_repair.h"

namespace tufa::refine {

SurfaceModel::SurfaceModel(grid::Volume volume, const ContourOptions& options,
                           const uniform::StageEnds& ends, base::Job& job)
    : repairs_(options.repair),
      surface_(uniform::makeUniformSurface(std::move(volume), options, ends, job)),
      report_(uniform::reportOf(surface_)) {
  job.beginStage("repair", ends.repair);
  if (repairs_) candidates_ = repairUniform(surface_, report_, job);
}

void SurfaceModel::buildClusters(const octree::CutRule& rule, base::Job& job) {
  forest_ = octree::buildForest(view(), rule.maxLevel, rule.boundsAngle(), job);
  reference_.emplace(view(), forest_, job);
}

std::optional<Repair> SurfaceModel::repair(base::Job& job) const {
  if (!repairs_) return std::nullopt;
  return Repair{candidates_, sourceOf(surface_, job)};
}

}  // namespace tufa::refine
