#include <tufa/contour.h>

#include "base/job.h"
#include "base/run_call.h"
#include "octree/cut_rule.h"
#include "refine/adapt.h"
#include "refine/finish.h"
#include "refine/surface_model.h"
#include "uniform/uniform_surface.h"

namespace tufa {
namespace {

// Shares of the time that stages took on the sample volumes.
constexpr uniform::StageEnds kUniformEnds = {0.03, 0.06, 0.4, 0.45, 0.5, 0.9};
constexpr uniform::StageEnds kAdaptiveEnds = {0.01, 0.02, 0.07, 0.08, 0.09, 0.15};
constexpr double kForestEnd = 0.18;
constexpr double kCutEnd = 0.96;

Mesh contourGrid(const openvdb::GridBase& grid, const ContourOptions& options,
                 ContourReport& report, base::Job& job) {
  const uniform::StageEnds& ends = options.uniform ? kUniformEnds : kAdaptiveEnds;
  const octree::CutRule rule = octree::readRule(options, grid::transformOf(grid));
  job.beginStage("blocks", ends.blocks);
  refine::SurfaceModel model(grid::openVolume(grid, options, job), options, ends, job);
  report = model.report();
  refine::ExtractedMesh extracted;
  if (options.uniform || model.mesh().positions.empty()) {
    extracted.candidates = model.candidates();
    extracted.mesh = model.takeMesh();
  } else {
    job.beginStage("forest", kForestEnd);
    model.buildClusters(rule, job);
    job.beginStage("cut", kCutEnd, base::Length::Unknown);
    const auto repair = model.repair(job);
    refine::AdaptiveMesh adaptive = refine::adapt(
        model, rule, {repair ? &*repair : nullptr, octree::maySimplify(options)}, job);
    report.certificate =
        refine::certificateOf(adaptive, model.affine().voxelSize(), options.keepLeaves);
    report.intersectionsFound += adaptive.repaired.pairsFound;
    report.movedVertices += adaptive.repaired.movedVertices;
    report.flippedDiagonals += adaptive.repaired.flippedDiagonals;
    extracted = std::move(adaptive.extracted);
  }
  job.beginStage("finish", 1.0);
  refine::finishMesh(model, options, extracted, report, job);
  return std::move(extracted.mesh);
}

}  // namespace

Mesh contour(const openvdb::GridBase& grid, const ContourOptions& options, ContourReport* report) {
  grid::requireMeshable(grid);
  return base::runCall(options, report, [&](ContourReport& out, base::Job& job) {
    return contourGrid(grid, options, out, job);
  });
}

}  // namespace tufa
