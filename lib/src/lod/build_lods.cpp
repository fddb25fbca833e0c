#include <tufa/error.h>
#include <tufa/lod.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/job.h"
#include "certify/adapt.h"
#include "cut/cut_rule.h"
#include "forest/forest.h"
#include "level0/finish.h"
#include "level0/level0.h"
#include "level0/with_grid.h"

namespace tufa {
namespace {

constexpr level0::StageEnds kEnds = {0.08, 0.15, 0.33, 0.4, 0.42, 0.45};
constexpr double kForestEnd = 0.55;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<double> tolerancesOf(const LodOptions& options) {
  std::vector<double> tolerances = options.tolerances;
  if (tolerances.empty()) {
    if (options.levels < 1) {
      throw Error(ErrorCode::InvalidArgument,
                  "a chain needs at least 1 level, not " + std::to_string(options.levels));
    }
    if (!(options.factor > 1 && std::isfinite(options.factor))) {
      throw Error(ErrorCode::InvalidArgument,
                  "the factor between the tolerances of two levels must be above 1");
    }
    double tolerance = options.contour.tolerance;
    for (int i = 0; i < options.levels; ++i, tolerance *= options.factor) {
      tolerances.push_back(tolerance);
    }
  }
  for (std::size_t i = 0; i < tolerances.size(); ++i) {
    if (!(std::isfinite(tolerances[i]) && tolerances[i] >= 0)) {
      throw Error(ErrorCode::InvalidArgument, "tolerances must be finite and not negative");
    }
    if (i > 0 && !(tolerances[i] > tolerances[i - 1])) {
      throw Error(ErrorCode::InvalidArgument, "tolerances must rise from level to level");
    }
  }
  return tolerances;
}

void setBounds(LodChain& chain) {
  openvdb::BBoxd box;
  for (const Position& p : chain.levels.front().mesh.positions) {
    box.expand(openvdb::Vec3d(p.x, p.y, p.z));
  }
  const openvdb::Vec3d centre = box.empty() ? openvdb::Vec3d(0) : box.getCenter();
  chain.centre = {centre[0], centre[1], centre[2]};
  double squared = 0;
  for (const Position& p : chain.levels.front().mesh.positions) {
    squared = std::max(squared, (openvdb::Vec3d(p.x, p.y, p.z) - centre).lengthSqr());
  }
  chain.radius = std::sqrt(squared);
}

void setCoverage(LodChain& chain, const LodOptions& options) {
  for (std::size_t i = 0; i + 1 < chain.levels.size(); ++i) {
    const double error = chain.levels[i + 1].certificate.maxErrorWorld;
    const double pixels = options.pixelError / options.screenHeight;
    chain.levels[i].screenCoverage =
        error > 0 ? std::min(1.0, pixels * 2 * chain.radius / error) : 1.0;
  }
}

template <class TreeT>
LodChain buildChain(const openvdb::Grid<TreeT>& grid, const LodOptions& options,
                    ContourReport& report, base::Job& job) {
  const Clock::time_point start = Clock::now();
  const std::vector<double> tolerances = tolerancesOf(options);
  ContourOptions contour = options.contour;
  contour.uniform = false;
  cut::CutRule rule = cut::readRule(contour, grid.transform());
  const level0::Level0<TreeT> level0(grid, contour, kEnds, job);
  report = level0.report();
  LodChain chain;
  chain.voxelSize = level0.affine().voxelSize();
  if (level0.mesh().positions.empty()) return chain;
  const forest::Base<TreeT> base = level0.base(contour.maxAngle < 180);
  job.beginStage("forest", kForestEnd);
  const forest::Forest forest = forest::buildForest(base, rule.maxLevel, job);
  const certify::Repair repair{level0.suspects(), level0.source(job)};
  chain.sharedSeconds = secondsSince(start);

  for (std::size_t i = 0; i < tolerances.size(); ++i) {
    const Clock::time_point begin = Clock::now();
    const double share = static_cast<double>(i + 1) / static_cast<double>(tolerances.size());
    job.beginStage("level " + std::to_string(i), kForestEnd + (1 - kForestEnd) * share);
    rule.tolerance = tolerances[i];
    certify::AdaptiveMesh adaptive = certify::adapt(
        base, forest, rule, {contour.repair ? &repair : nullptr, cut::maySimplify(contour)}, job);
    if (i > 0 && adaptive.mesh.triangleCount() >= chain.levels.back().mesh.triangleCount()) {
      chain.stopped = "level " + std::to_string(i) + " at a tolerance of " +
                      std::to_string(tolerances[i]) + " voxels has no fewer triangles than level " +
                      std::to_string(i - 1) + ": the surface's topology allows no coarser mesh";
      break;
    }
    Lod lod;
    lod.tolerance = tolerances[i];
    lod.certificate = certify::certificateOf(adaptive, chain.voxelSize, contour.keepLeaves);
    lod.mesh = std::move(adaptive.mesh);
    const level0::Origins origins{std::move(adaptive.baseVertices), std::move(adaptive.baseQuads)};
    level0::finishMesh(level0, contour, origins, adaptive.suspects, lod.mesh, report, job);
    lod.intersectionsLeft = report.intersectionsLeft;
    lod.seconds = secondsSince(begin);
    chain.levels.push_back(std::move(lod));
  }
  setBounds(chain);
  setCoverage(chain, options);
  return chain;
}

}  // namespace

LodChain buildLods(const openvdb::GridBase& grid, const LodOptions& options,
                   ContourReport* report) {
  if (!(options.pixelError > 0) || options.screenHeight < 1) {
    throw Error(ErrorCode::InvalidArgument, "pixelError and screenHeight must be above 0");
  }
  return level0::withGrid<LodChain>(grid, options.contour, report,
                                    [&](const auto& own, ContourReport& out, base::Job& job) {
                                      return buildChain(own, options, out, job);
                                    });
}

std::size_t selectLod(const LodChain& chain, const Camera& camera, double pixelError) {
  const openvdb::Vec3d way(camera.eye.x - chain.centre.x, camera.eye.y - chain.centre.y,
                           camera.eye.z - chain.centre.z);
  const double distance = way.length() - chain.radius;
  if (!(distance > 0)) return 0;
  const double pixelsPerUnit =
      camera.screenHeight / (2 * std::tan(camera.verticalAngle / 2) * distance);
  std::size_t level = 0;
  for (std::size_t i = 1; i < chain.levels.size(); ++i) {
    if (chain.levels[i].certificate.maxErrorWorld * pixelsPerUnit <= pixelError) level = i;
  }
  return level;
}

}  // namespace tufa
