#include <tufa/error.h>
#include <tufa/lod.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "base/box.h"
#include "base/job.h"
#include "base/number_text.h"
#include "base/run_call.h"
#include "lod/require_camera.h"
#include "octree/cut_rule.h"
#include "refine/adapt.h"
#include "refine/finish.h"
#include "refine/surface_model.h"
#include "refine/surface_reduction.h"

namespace tufa {
namespace {

// Shares of the time that stages took on the sample volumes.
constexpr uniform::StageEnds kEnds = {0.01, 0.02, 0.07, 0.08, 0.09, 0.14};
constexpr double kForestEnd = 0.16;
constexpr double kFirstLevelEnd = 0.85;
constexpr std::size_t kMostLevels = 100;
// The triangles of an LOD must fall at least with this power of its tolerance, for tolerances up to
// this many times that of the LOD before.
constexpr double kLeastSlope = -0.25;
constexpr double kMostRatio = 4;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What an LOD must keep: one or the other.
struct Target {
  double tolerance = 0;
  std::size_t triangles = 0;  ///< 0: none
};

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::InvalidArgument, why); }

std::vector<Target> budgetsOf(const LodOptions& options) {
  if (!options.tolerances.empty()) refuse("tolerances and triangles exclude each other");
  if (!octree::maySimplify(options.contour)) {
    refuse(
        "numbers of triangles are met by collapsing edges: not without simplifying, or with "
        "bounds on angles or cells");
  }
  std::vector<Target> targets;
  for (std::size_t i = 0; i < options.triangles.size(); ++i) {
    if (options.triangles[i] < 4) {
      refuse("a level needs at least 4 triangles, not " + std::to_string(options.triangles[i]));
    }
    if (i > 0 && options.triangles[i] >= options.triangles[i - 1]) {
      refuse("numbers of triangles must fall from level to level: " +
             std::to_string(options.triangles[i]) + " follows " +
             std::to_string(options.triangles[i - 1]));
    }
    targets.push_back({options.contour.tolerance, options.triangles[i]});
  }
  return targets;
}

std::vector<Target> targetsOf(const LodOptions& options) {
  if (std::max(options.triangles.size(), options.tolerances.size()) > kMostLevels) {
    refuse("a chain has " + std::to_string(kMostLevels) + " levels at most");
  }
  if (!options.triangles.empty()) return budgetsOf(options);
  std::vector<Target> targets;
  for (const double tolerance : options.tolerances) targets.push_back({tolerance});
  if (targets.empty()) {
    if (options.levels < 1 || static_cast<std::size_t>(options.levels) > kMostLevels) {
      refuse("a chain has 1 to " + std::to_string(kMostLevels) + " levels, not " +
             std::to_string(options.levels));
    }
    octree::requireFactor(options.factor);
    double tolerance = options.contour.tolerance;
    if (tolerance == 0 && options.levels > 1) {
      refuse(
          "no level can follow one of tolerance 0, as each level's tolerance is a multiple of "
          "that before: give the tolerances of all levels, or one level");
    }
    // Nothing is coarser than what the largest tolerance gives.
    for (int i = 0; i < options.levels && (i == 0 || tolerance <= octree::kLargestTolerance); ++i) {
      targets.push_back({tolerance});
      tolerance *= options.factor;
    }
  }
  for (std::size_t i = 0; i < targets.size(); ++i) {
    octree::requireTolerance(targets[i].tolerance);
    if (i > 0 && !(targets[i].tolerance > targets[i - 1].tolerance)) {
      refuse("tolerances must rise from level to level: " + base::numberText(targets[i].tolerance) +
             " follows " + base::numberText(targets[i - 1].tolerance));
    }
  }
  return targets;
}

// That a number of triangles was left out, as the LOD before has no more.
std::string leftOut(const Target& target, const std::vector<Lod>& before) {
  return "a level of " + std::to_string(target.triangles) + " triangles was left out: level " +
         std::to_string(before.size() - 1) + " has " +
         std::to_string(before.back().mesh.triangleCount()) + " already";
}

// Why an LOD is no coarser, or not as coarse as asked for, and was left out: `worthwhile` is what
// it had to stay below.
std::string stopOf(std::size_t level, const Target& target, std::size_t triangles,
                   std::size_t worthwhile, const std::vector<Lod>& before) {
  if (target.triangles > 0) {
    return "level " + std::to_string(level) + " cannot have " + std::to_string(target.triangles) +
           " triangles: " + std::to_string(triangles) + " are the fewest that were reached" +
           (level > 0 ? ", and that level was left out" : "");
  }
  return "a level at a tolerance of " + base::numberText(target.tolerance) +
         " voxels was left out: " + std::to_string(triangles) +
         " triangles were reached, and a level is kept with fewer than " +
         std::to_string(worthwhile) + ", of the " +
         std::to_string(before.back().mesh.triangleCount()) + " of level " +
         std::to_string(level - 1);
}

// Whether no LOD can follow one that was not worth its error, or out of reach: what is left is
// needed for the topology. A list of tolerances need not rise as fast as that is judged by, and
// where components may go, they do so at some larger tolerance.
bool endsAt(const Target& target, const LodOptions& options) {
  return target.triangles > 0 || (options.tolerances.empty() && !options.allowTopologyChange);
}

// Adds a reason why there are fewer LODs than asked for.
void tell(LodChain& chain, const std::string& reason) {
  chain.stopped += (chain.stopped.empty() ? "" : "; ") + reason;
}

// Of a chain by a factor: that it has got to the largest tolerance.
void tellOfLargest(LodChain& chain, const std::vector<Target>& targets, const LodOptions& options) {
  const bool byFactor = options.triangles.empty() && options.tolerances.empty();
  if (!byFactor || targets.size() == static_cast<std::size_t>(options.levels)) return;
  const double last = targets.back().tolerance;
  tell(chain, "no level follows the tolerance of " + base::numberText(last) +
                  " voxels: the next, of " + base::numberText(last * options.factor) +
                  ", would be above the largest, " + base::numberText(octree::kLargestTolerance));
}

// An LOD with so many triangles or more is not worth its error: at four times the tolerance three
// in ten fewer are expected. Otherwise what is left is needed for the topology.
std::size_t tooMany(const Target& target, const Lod& before) {
  const std::size_t most = before.mesh.triangleCount();
  if (target.triangles > 0 || !(before.tolerance > 0)) return most;
  const double ratio = std::min(target.tolerance / before.tolerance, kMostRatio);
  return static_cast<std::size_t>(
      std::ceil(static_cast<double>(most) * std::pow(ratio, kLeastSlope)));
}

void setBounds(LodChain& chain) {
  if (chain.levels.empty()) return;
  base::Box box = base::Box::empty();
  for (const Position& p : chain.levels.front().mesh.positions) box.add(p);
  const Vec3 centre = box.isEmpty() ? Vec3(0) : box.centre();
  chain.centre = centre;
  double squared = 0;
  for (const Position& p : chain.levels.front().mesh.positions) {
    squared = std::max(squared, (p - centre).squaredLength());
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

// Makes the LODs one after the other: by reducing the one before, or each by a cut of its own.
class ChainMaker {
 public:
  ChainMaker(refine::SurfaceModel& model, const octree::CutRule& rule, const LodOptions& options,
             base::Job& job)
      : model_(model), rule_(rule), drops_(options.allowTopologyChange), job_(job) {
    if (octree::maySimplify(options.contour)) {
      job.beginStage("reference", kForestEnd);
      reduction_.emplace(model, rule_, job);
    } else {
      job.beginStage("forest", kForestEnd);
      model.buildClusters(rule, job);
    }
  }

  refine::AdaptiveMesh next(const Target& target) {
    if (!reduction_) {
      rule_.tolerance = target.tolerance;
      return refine::adapt(model_, rule_, drops_, job_);
    }
    return target.triangles > 0 ? reduction_->toCount(target.triangles, drops_)
                                : reduction_->toTolerance(target.tolerance, drops_);
  }

 private:
  refine::SurfaceModel& model_;
  octree::CutRule rule_;
  bool drops_;
  base::Job& job_;
  std::optional<refine::SurfaceReduction> reduction_;
};

// Makes an LOD of a mesh that keeps its target.
Lod finished(refine::SurfaceModel& model, const ContourOptions& contour, const Target& target,
             refine::AdaptiveMesh& adaptive, ContourReport& report, base::Job& job) {
  const double voxelSize = model.affine().voxelSize();
  Lod lod;
  lod.certificate = refine::certificateOf(adaptive, voxelSize, contour.keepLeaves, job);
  const double moved = refine::finishMesh(model, contour, adaptive.extracted, report, job);
  refine::widen(lod.certificate, moved, voxelSize);
  lod.tolerance = target.triangles > 0 ? lod.certificate.maxErrorVoxels : target.tolerance;
  for (const refine::Dropped& piece : adaptive.dropped) {
    lod.dropped.push_back({model.affine().toWorld(piece.centre), piece.size});
    if (target.triangles > 0) lod.tolerance = std::max(lod.tolerance, piece.size);
  }
  refine::setAngles(lod.certificate, adaptive.extracted.mesh, contour.minAngle);
  lod.mesh = std::move(adaptive.extracted.mesh);
  lod.intersectionsLeft = report.intersectionsLeft;
  return lod;
}

LodChain buildChain(const openvdb::GridBase& grid, const LodOptions& options, ContourReport& report,
                    base::Job& job) {
  const Clock::time_point start = Clock::now();
  const std::vector<Target> targets = targetsOf(options);
  ContourOptions contour = options.contour;
  contour.uniform = false;
  const octree::CutRule rule = octree::readRule(contour, grid::transformOf(grid));
  job.beginStage("blocks", kEnds.blocks);
  refine::SurfaceModel model(grid::openVolume(grid, contour, job), contour, kEnds, job);
  report = model.report();
  LodChain chain;
  chain.voxelSize = model.affine().voxelSize();
  if (model.mesh().positions.empty()) return chain;
  ChainMaker maker(model, rule, options, job);
  chain.sharedSeconds = secondsSince(start);

  bool ended = false;
  for (std::size_t i = 0; i < targets.size() && !ended; ++i) {
    const Clock::time_point begin = Clock::now();
    const double share = static_cast<double>(i + 1) / static_cast<double>(targets.size());
    const std::size_t level = chain.levels.size();
    job.beginStage("level " + std::to_string(level), kFirstLevelEnd + (1 - kFirstLevelEnd) * share,
                   base::Length::Unknown);
    const Target& target = targets[i];
    const std::size_t most = level > 0 ? tooMany(target, chain.levels.back()) : 0;
    if (level > 0 && target.triangles > 0 && most <= target.triangles) {
      tell(chain, leftOut(target, chain.levels));
      continue;
    }
    refine::AdaptiveMesh adaptive = maker.next(target);
    const std::size_t triangles = adaptive.extracted.mesh.triangleCount();
    const bool coarser = level == 0 || triangles < most || !adaptive.dropped.empty();
    if (!coarser || (target.triangles > 0 && triangles > target.triangles)) {
      tell(chain, stopOf(level, target, triangles, most, chain.levels));
      ended = endsAt(target, options);
      continue;
    }
    Lod lod = finished(model, contour, target, adaptive, report, job);
    if (contour.keepCells) {
      lod.mesh.cells = grid::cellsOf(lod.mesh.positions, grid::transformOf(grid), job);
    }
    lod.seconds = secondsSince(begin);
    chain.levels.push_back(std::move(lod));
  }
  if (!ended) tellOfLargest(chain, targets, options);
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
  grid::requireMeshable(grid);
  return base::runCall(options.contour, report, [&](ContourReport& out, base::Job& job) {
    return buildChain(grid, options, out, job);
  });
}

std::size_t selectLod(const LodChain& chain, const Camera& camera, double pixelError) {
  lod::requireCamera(camera, pixelError);
  const double distance = (Vec3(camera.eye) - chain.centre).length() - chain.radius;
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
