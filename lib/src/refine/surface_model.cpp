#include "refine/surface_model.h"
#include "octree/build_forest.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/single_precision.h"
#include "refine/rounding.h"
#include "refine/uniform_repair.h"

namespace tufa::refine {
namespace {

constexpr std::size_t kGrain = 4096;

}  // namespace

SurfaceModel::SurfaceModel(grid::Volume volume, const ContourOptions& options,
                           const uniform::StageEnds& ends, base::Job& job)
    : repairs_(options.repair),
      surface_(uniform::makeUniformSurface(std::move(volume), options, ends, job)),
      report_(uniform::reportOf(surface_)) {
  job.beginStage("repair", ends.repair);
  if (!repairs_) return;
  candidates_ = repairUniform(surface_, report_, job);
  if (!options.uniform) settle(job);
}

// Moves what intersects once it is rounded as it will be written: finishMesh() would do so too late
// for a mesh that is measured against this one.
void SurfaceModel::settle(base::Job& job) {
  Mesh& mesh = surface_.mesh;
  const grid::Affine& own = affine();
  Mesh world = mesh;
  job.forRanges(world.positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) world.positions[i] = own.toWorld(mesh.positions[i]);
  });
  const bool single = base::roundToSingle(world, kMostRounding * own.leastHeight(), job);
  const std::vector<Position> before = world.positions;
  Source source = sourceOf(surface_, job);
  source.massPoints = [&own, points = source.massPoints](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> all = points(vertices);
    for (Position& point : all) point = own.toWorld(point);
    return all;
  };
  source.crossings = nullptr;  // fans are not the business of a reference
  source.singlePrecision = single;
  const RepairReport repaired = repairIntersections(world, candidates_, source, job);
  report_.movedVertices += repaired.movedVertices;
  report_.flippedDiagonals += repaired.flippedDiagonals;
  if (repaired.changed.empty()) return;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!(world.positions[i] == before[i])) mesh.positions[i] = own.fromWorld(world.positions[i]);
  }
  mesh.quads = std::move(world.quads);
  std::vector<std::uint32_t> all;
  std::set_union(candidates_.begin(), candidates_.end(), repaired.changed.begin(),
                 repaired.changed.end(), std::back_inserter(all));
  candidates_ = std::move(all);
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
