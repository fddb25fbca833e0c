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
// Triangles of a level fall at least with this power of its tolerance, up to this many times that
// of the level before.
constexpr double kLeastSlope = -0.3;
constexpr double kMostRatio = 4;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What a level must keep: one or the other.
struct Target {
  double tolerance = 0;
  std::size_t triangles = 0;  ///< 0: none
};

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::InvalidArgument, why); }

std::vector<Target> budgetsOf(const LodOptions& options) {
  if (!options.tolerances.empty()) refuse("tolerances and triangles exclude each other");
  if (!cut::maySimplify(options.contour)) {
    refuse(
        "numbers of triangles are met by collapsing edges: not without simplifying, or with "
        "bounds on angles or cells");
  }
  std::vector<Target> targets;
  for (std::size_t i = 0; i < options.triangles.size(); ++i) {
    if (options.triangles[i] < 4) refuse("a level needs at least 4 triangles");
    if (i > 0 && options.triangles[i] >= options.triangles[i - 1]) {
      refuse("numbers of triangles must fall from level to level");
    }
    targets.push_back({options.contour.tolerance, options.triangles[i]});
  }
  return targets;
}

std::vector<Target> targetsOf(const LodOptions& options) {
  if (!options.triangles.empty()) return budgetsOf(options);
  std::vector<Target> targets;
  for (const double tolerance : options.tolerances) targets.push_back({tolerance});
  if (targets.empty()) {
    if (options.levels < 1) {
      refuse("a chain needs at least 1 level, not " + std::to_string(options.levels));
    }
    if (!(options.factor > 1 && std::isfinite(options.factor))) {
      refuse("the factor between the tolerances of two levels must be above 1");
    }
    double tolerance = options.contour.tolerance;
    for (int i = 0; i < options.levels; ++i, tolerance *= options.factor) {
      targets.push_back({tolerance});
    }
  }
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (!(std::isfinite(targets[i].tolerance) && targets[i].tolerance >= 0)) {
      refuse("tolerances must be finite and not negative");
    }
    if (i > 0 && !(targets[i].tolerance > targets[i - 1].tolerance)) {
      refuse("tolerances must rise from level to level");
    }
  }
  return targets;
}

// Why a level is no coarser, or not as coarse as asked for, and was left out.
std::string stopOf(std::size_t level, const Target& target, std::size_t triangles) {
  if (target.triangles > 0) {
    return "level " + std::to_string(level) + " cannot have " + std::to_string(target.triangles) +
           " triangles: the surface allows no fewer than " + std::to_string(triangles) +
           ", and that level was left out";
  }
  return "level " + std::to_string(level) + " at a tolerance of " +
         std::to_string(target.tolerance) + " voxels has " + std::to_string(triangles) +
         " triangles, hardly fewer than level " + std::to_string(level - 1) +
         ", and was left out: the surface's topology allows no coarser mesh";
}

// A level with so many triangles or more is not worth its error: at four times the tolerance there
// should be a third fewer. Else what is left is needed for the topology.
std::size_t tooMany(const Target& target, const Lod& before) {
  const std::size_t most = before.mesh.triangleCount();
  if (target.triangles > 0 || !(before.tolerance > 0)) return most;
  const double ratio = std::min(target.tolerance / before.tolerance, kMostRatio);
  return static_cast<std::size_t>(
      std::ceil(static_cast<double>(most) * std::pow(ratio, kLeastSlope)));
}

void setBounds(LodChain& chain) {
  if (chain.levels.empty()) return;
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
  const std::vector<Target> targets = targetsOf(options);
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
  const certify::BaseSurface<TreeT> surface(base, forest.levels[0], job);
  chain.sharedSeconds = secondsSince(start);

  const bool collapses = cut::maySimplify(contour);
  certify::Measured kept;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Clock::time_point begin = Clock::now();
    const double share = static_cast<double>(i + 1) / static_cast<double>(targets.size());
    job.beginStage("level " + std::to_string(i), kForestEnd + (1 - kForestEnd) * share);
    const Target& target = targets[i];
    const std::size_t most = i > 0 ? tooMany(target, chain.levels.back()) : 0;
    const certify::Goal goal{target.triangles, target.triangles > 0 ? 0 : most};
    const certify::AdaptOptions how{contour.repair ? &repair : nullptr, collapses, goal,
                                    options.allowTopologyChange};
    rule.tolerance = target.triangles > 0 && i > 0 ? rule.tolerance : target.tolerance;
    certify::AdaptiveMesh adaptive = i > 0 && collapses
                                         ? coarsen(base, surface, rule, how, job, kept)
                                         : adapt(base, forest, surface, rule, how, job, &kept);
    rule.tolerance = adaptive.tolerance;
    const std::size_t triangles = adaptive.mesh.triangleCount();
    const bool coarser = i == 0 || triangles < most;
    if (!coarser || (target.triangles > 0 && triangles > target.triangles)) {
      chain.stopped = stopOf(i, target, triangles);
      break;
    }
    Lod lod;
    lod.certificate = certify::certificateOf(adaptive, chain.voxelSize, contour.keepLeaves);
    lod.tolerance = target.triangles > 0 ? lod.certificate.maxErrorVoxels : target.tolerance;
    for (const certify::Dropped& piece : adaptive.dropped) {
      lod.dropped.push_back(
          {level0.affine().toWorld(Position(piece.centre[0], piece.centre[1], piece.centre[2])),
           piece.size});
      if (target.triangles > 0) lod.tolerance = std::max(lod.tolerance, piece.size);
    }
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
