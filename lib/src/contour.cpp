#include <tufa/contour.h>

#include "base/job.h"
#include "base/run_call.h"
#include "octree/cut_rule.h"
#include "refine/adapt.h"
#include "refine/finish.h"
#include "refine/surface_model.h"
#include "refine/surface_reduction.h"
#include "uniform/uniform_surface.h"

namespace tufa {
namespace {

// Shares of the time that stages took on the sample volumes.
constexpr uniform::StageEnds kUniformEnds = {0.03, 0.06, 0.4, 0.45, 0.5, 0.9};
constexpr uniform::StageEnds kAdaptiveEnds = {0.02, 0.05, 0.14, 0.17, 0.18, 0.22};
constexpr double kForestEnd = 0.25;
constexpr double kAdaptiveEnd = 0.96;

refine::AdaptiveMesh makeAdaptive(refine::SurfaceModel& model, const octree::CutRule& rule,
                                  const ContourOptions& options, base::Job& job) {
  if (octree::maySimplify(options)) {
    job.beginStage("reduce", kAdaptiveEnd, base::Length::Unknown);
    return refine::SurfaceReduction(model, rule, job).toTolerance(rule.tolerance, false);
  }
  job.beginStage("forest", kForestEnd);
  model.buildClusters(rule, job);
  job.beginStage("cut", kAdaptiveEnd, base::Length::Unknown);
  return refine::adapt(model, rule, false, job);
}

Mesh contourGrid(const openvdb::GridBase& grid, const ContourOptions& options,
                 ContourReport& report, base::Job& job) {
  const uniform::StageEnds& ends = options.uniform ? kUniformEnds : kAdaptiveEnds;
  const octree::CutRule rule = octree::readRule(options, grid::transformOf(grid));
  job.beginStage("blocks", ends.blocks);
  refine::SurfaceModel model(grid::openVolume(grid, options, job), options, ends, job);
  report = model.report();
  refine::ExtractedMesh extracted;
  if (options.uniform || model.mesh().positions.empty()) {
    extracted.closePairs = model.closePairs();
    extracted.mesh = model.takeMesh();
  } else {
    refine::AdaptiveMesh adaptive = makeAdaptive(model, rule, options, job);
    report.certificate =
        refine::certificateOf(adaptive, model.affine().voxelSize(), options.keepLeaves, job);
    extracted = std::move(adaptive.extracted);
  }
  job.beginStage("finish", 1.0);
  const double moved = refine::finishMesh(model, options, extracted, report, job);
  if (report.certificate) {
    refine::widen(*report.certificate, moved, model.affine().voxelSize());
    refine::setAngles(*report.certificate, extracted.mesh, options.minAngle);
  }
  if (options.keepCells) {
    Mesh& mesh = extracted.mesh;
    mesh.cells = grid::cellsOf(mesh.positions, grid::transformOf(grid), job);
  }
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
