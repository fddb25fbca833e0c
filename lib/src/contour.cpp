#include <tufa/contour.h>

#include "base/job.h"
#include "certify/adapt.h"
#include "cut/cut_rule.h"
#include "forest/forest.h"
#include "level0/finish.h"
#include "level0/level0.h"
#include "level0/with_grid.h"

namespace tufa {
namespace {

constexpr level0::StageEnds kUniformEnds = {0.15, 0.3, 0.7, 0.85, 0.9, 0.95};
constexpr level0::StageEnds kAdaptiveEnds = {0.08, 0.15, 0.36, 0.46, 0.48, 0.5};

template <class TreeT>
Mesh contourGrid(const openvdb::Grid<TreeT>& grid, const ContourOptions& options,
                 ContourReport& report, base::Job& job) {
  const cut::CutRule rule = cut::readRule(options, grid.transform());
  level0::Level0<TreeT> level0(grid, options, options.uniform ? kUniformEnds : kAdaptiveEnds, job);
  report = level0.report();
  Mesh mesh;
  level0::Origins origins;
  std::vector<mend::PolygonIndex> suspects;
  if (options.uniform || level0.mesh().positions.empty()) {
    mesh = level0.takeMesh();
    suspects = level0.suspects();
  } else {
    const forest::Base<TreeT> base = level0.base(options.maxAngle < 180);
    job.beginStage("forest", 0.7);
    const forest::Forest forest = forest::buildForest(base, rule.maxLevel, job);
    job.beginStage("cut", 0.95);
    const certify::Repair repair{level0.suspects(), level0.source(job)};
    const certify::BaseSurface<TreeT> surface(base, forest.levels[0], job);
    certify::AdaptiveMesh adaptive =
        certify::adapt(base, forest, surface, rule,
                       {options.repair ? &repair : nullptr, cut::maySimplify(options)}, job);
    report.certificate =
        certify::certificateOf(adaptive, level0.affine().voxelSize(), options.keepLeaves);
    report.intersectionsFound += adaptive.mended.pairsFound;
    report.movedVertices += adaptive.mended.movedVertices;
    report.turnedQuads += adaptive.mended.turnedQuads;
    mesh = std::move(adaptive.mesh);
    origins = {std::move(adaptive.baseVertices), std::move(adaptive.baseQuads)};
    suspects = std::move(adaptive.suspects);
  }
  job.beginStage("finish", 1.0);
  level0::finishMesh(level0, options, origins, suspects, mesh, report, job);
  return mesh;
}

}  // namespace

Mesh contour(const openvdb::GridBase& grid, const ContourOptions& options, ContourReport* report) {
  return level0::withGrid<Mesh>(grid, options, report,
                                [&](const auto& own, ContourReport& out, base::Job& job) {
                                  return contourGrid(own, options, out, job);
                                });
}

}  // namespace tufa
