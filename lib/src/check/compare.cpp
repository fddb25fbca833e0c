#include <tufa/compare.h>

#include <tufa/error.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <utility>

#include "base/part_of_progress.h"
#include "base/peak_memory.h"
#include "base/run_call.h"
#include "check/surface_reference.h"
#include "grid/non_finite.h"
#include "grid/volume_to_mesh.h"

namespace tufa {
namespace {

// Shares of the progress: finding the isosurface; then of each method its mesh and its check.
constexpr double kReferenceEnd = 0.05, kMeshEnd = 0.2, kCheckEnd = 0.4, kDistanceEnd = 0.9;

constexpr std::string_view kOriginal = "mc-original", kUniform = "dual-uniform",
                           kAdaptiveSquares = "cms-adaptive", kPeer = "volume-to-mesh-0",
                           kAdaptivePeer = "volume-to-mesh-0.25";
constexpr double kPeerAdaptivity = 0.25;

void requireOptions(const CompareOptions& options) {
  base::requireClosedRule(options.extract.contour.ambiguity);
  constexpr int kMostRepeats = 1000;
  if (options.repeats < 1 || options.repeats > kMostRepeats) {
    throw Error(ErrorCode::InvalidArgument, "the number of runs is " +
                                                std::to_string(options.repeats) +
                                                ", must be 1 to " + std::to_string(kMostRepeats));
  }
  checks::requireSamples(options.samplesPerEdge);
  const auto& known = comparedNames();
  for (const std::string& name : options.methods) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string names;
    for (const std::string_view other : known) names.append(" ").append(other);
    throw Error(ErrorCode::InvalidArgument,
                "no method is named \"" + name + "\"; there are" + names);
  }
}

/// How far the distances of each point from the meshes are apart.
class Spread {
 public:
  explicit Spread(std::size_t points) : least_(points, kFar), most_(points, 0) {}

  void add(std::size_t point, double distance) {
    least_[point] = std::min(least_[point], distance);
    most_[point] = std::max(most_[point], distance);
  }

  [[nodiscard]] double at(std::size_t point) const { return most_[point] - least_[point]; }

  /// The first of the points where it is largest; there must be some.
  [[nodiscard]] std::size_t widest() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < most_.size(); ++i) {
      if (at(i) > at(best)) best = i;
    }
    return best;
  }

 private:
  static constexpr double kFar = 1e300;
  std::vector<double> least_, most_;
};

class Comparer {
 public:
  Comparer(const openvdb::GridBase& grid, const CompareOptions& options)
      : grid_(grid),
        options_(options),
        contour_(options.extract.contour),
        frame_(grid),
        iso_(grid::chooseIsovalue(grid, contour_.isovalue, contour_.inside)) {
    for (const std::string_view name : comparedNames()) {
      const auto& asked = options.methods;
      if (asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end()) {
        names_.emplace_back(name);
      }
    }
  }

  Comparison run() {
    out_.isovalue = iso_.isovalue;
    out_.insideIsBelow = iso_.insideIsBelow;
    out_.voxelSize = frame_.voxelSize();
    findTopology();
    runPart(kReferenceEnd / 2, kReferenceEnd,
            [&](base::Job& job) { surface_.emplace(grid_, frame_, iso_, 1, job); });
    spread_.emplace(surface_->points().size());
    const auto at = [&](std::size_t i) {
      return std::lerp(kReferenceEnd, 1.0,
                       static_cast<double>(i) / static_cast<double>(names_.size()));
    };
    for (std::size_t i = 0; i < names_.size(); ++i) {
      begin_ = at(i);
      end_ = at(i + 1);
      out_.methods.push_back(measured(names_[i]));
    }
    findDifference();
    return std::move(out_);
  }

 private:
  /// Work under a job of its own, whose progress is a part of the whole.
  template <class Work>
  void runPart(double begin, double end, const Work& work) {
    base::Job job(contour_.threads, base::partOf(contour_.progress, begin, end));
    job.run([&] { work(job); });
    job.finish();
  }

  [[nodiscard]] ExtractOptions extractOptions(double begin, double end) const {
    ExtractOptions options = options_.extract;
    options.contour.isovalue = iso_.isovalue;
    options.contour.inside = iso_.insideIsBelow ? Inside::Below : Inside::Above;
    options.contour.progress = base::partOf(contour_.progress, begin, end);
    return options;
  }

  void findTopology() {
    ContourReport report;
    const double end = kReferenceEnd / 2;
    const Mesh mesh = extract(grid_, Method::MarchingCubes33, extractOptions(0, end / 2), &report);
    out_.activeVoxels = report.activeVoxels;
    const auto isPeer = [](const std::string& name) {
      return name == kPeer || name == kAdaptivePeer;
    };
    if (report.nonFiniteValues > 0 && std::any_of(names_.begin(), names_.end(), isPeer)) {
      const Inside inside = iso_.insideIsBelow ? Inside::Below : Inside::Above;
      finite_ = grid::finiteCopy(grid_, {contour_.nonFinite, iso_.isovalue, inside});
    }
    out_.trilinearEuler = checked(mesh, end / 2, end, false).eulerCharacteristic;
  }

  CheckReport checked(const Mesh& mesh, double begin, double end, bool intersections) const {
    CheckOptions options;
    options.selfIntersections = intersections;
    options.threads = contour_.threads;
    options.progress = base::partOf(contour_.progress, begin, end);
    return check(mesh, options);
  }

  Mesh meshBy(const std::string& name, double begin, double end) {
    if (name == kPeer || name == kAdaptivePeer) {
      Mesh mesh;
      runPart(begin, end, [&](base::Job& job) {
        job.beginStage("volumeToMesh", 1);
        mesh = grid::volumeToMesh(finite_ ? *finite_ : grid_, iso_,
                                  name == kPeer ? 0 : kPeerAdaptivity);
      });
      return mesh;
    }
    ExtractOptions options = extractOptions(begin, end);
    if (name == kUniform) options.contour.uniform = true;
    if (name == kOriginal) options.contour.ambiguity = Ambiguity::Original;
    options.mergeTolerance = name == kAdaptiveSquares ? options.contour.tolerance : 0;
    const Method method = name == kUniform           ? Method::Dual
                          : name == kOriginal        ? Method::MarchingCubes
                          : name == kAdaptiveSquares ? Method::CubicalMarchingSquares
                                                     : *methodByName(name);
    return extract(grid_, method, options);
  }

  MethodResult measured(const std::string& name) {
    using Clock = std::chrono::steady_clock;
    const auto at = [&](double share) { return std::lerp(begin_, end_, share); };
    MethodResult result;
    result.name = name;
    for (int run = 0; run < options_.repeats; ++run) {
      result.mesh = {};
      std::unique_ptr<const base::PeakMemory> memory;
      if (options_.memory && run == 0) memory = std::make_unique<base::PeakMemory>();
      const auto start = Clock::now();
      const std::clock_t processorStart = std::clock();
      const double each = kMeshEnd / options_.repeats;
      result.mesh = meshBy(name, at(each * run), at(each * (run + 1)));
      const double processor = static_cast<double>(std::clock() - processorStart) / CLOCKS_PER_SEC;
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      if (memory) result.extraBytes = memory->extraBytes();
      if (run == 0 || seconds < result.seconds) result.seconds = seconds;
      if (run == 0 || processor < result.cpuSeconds) result.cpuSeconds = processor;
    }
    result.check = checked(result.mesh, at(kMeshEnd), at(kCheckEnd), true);
    measureDistance(result, at(kCheckEnd), at(options_.truth ? kDistanceEnd : 1));
    if (options_.truth) measureTruth(result, at(kDistanceEnd), at(1));
    if (!options_.keepMeshes) result.mesh = {};
    return result;
  }

  void measureDistance(MethodResult& result, double begin, double end) {
    const auto start = std::chrono::steady_clock::now();
    result.distance.isovalue = iso_.isovalue;
    result.distance.voxelSize = frame_.voxelSize();
    runPart(begin, end, [&](base::Job& job) {
      surface_->measure(
          result.mesh, options_.samplesPerEdge, 0, job,
          [&](std::size_t i, double distance) { spread_->add(i, distance); }, result.distance);
    });
    result.distance.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  void measureTruth(MethodResult& result, double begin, double end) {
    TruthReport& truth = result.truth.emplace();
    std::vector<Vec3> points;
    for (const Position& p : options_.truthPoints) points.push_back(frame_.fromWorld(p));
    std::vector<double> distances(points.size());
    runPart(begin, end, [&](base::Job& job) {
      job.beginStage("mesh tree", 0.2);
      const checks::TriangleSoup soup(result.mesh, frame_, job);
      const auto newMeasure = [&] {
        return [&](const Vec3& point) {
          const double distance = std::abs(options_.truth(frame_.toWorld(point)));
          constexpr double kFarthest = std::numeric_limits<double>::infinity();
          return std::isnan(distance) ? kFarthest : distance / frame_.voxelSize();
        };
      };
      job.beginStage("vertices to truth", 0.4);
      checks::Tally tally = checks::measureVertices(soup, job, newMeasure);
      job.beginStage("triangles to truth", 0.8);
      tally += checks::measureTriangles(soup, options_.samplesPerEdge, job, newMeasure);
      truth.meshToTruth = tally.summary();
      job.beginStage("truth to mesh", 1);
      const auto keep = [&](std::size_t i, double distance) { distances[i] = distance; };
      truth.pointsToMesh = checks::measureToMesh(soup, points, job, keep).summary();
    });
    if (distances.empty()) return;
    const auto share99 =
        distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) * 99 / 100);
    std::nth_element(distances.begin(), share99, distances.end());
    truth.pointsShare99 = *share99;
  }

  void findDifference() {
    if (surface_->points().empty() || out_.methods.empty()) return;
    const std::size_t widest = spread_->widest();
    const Vec3& point = surface_->points()[widest];
    out_.differsAt = frame_.toWorld(point);
    out_.difference = spread_->at(widest);
    const Vec3 growing = surface_->direction(point);
    out_.outward = Normal(iso_.insideIsBelow ? growing : -growing);
  }

  const openvdb::GridBase& grid_;
  std::shared_ptr<const openvdb::GridBase> finite_;  ///< for volumeToMesh(); null: as it is
  const CompareOptions& options_;
  const ContourOptions& contour_;
  grid::VoxelFrame frame_;
  grid::IsoChoice iso_;
  std::vector<std::string> names_;
  std::optional<checks::SurfaceReference> surface_;
  std::optional<Spread> spread_;
  double begin_ = 0, end_ = 0;  ///< of the progress, of the method at hand
  Comparison out_;
};

}  // namespace

const std::vector<std::string_view>& comparedNames() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const std::string_view name : methodNames()) {
      names.push_back(name);
      if (name == "dual") names.push_back(kUniform);
      if (name == "mc") names.push_back(kOriginal);
      if (name == "cms") names.push_back(kAdaptiveSquares);
    }
    names.push_back(kPeer);
    names.push_back(kAdaptivePeer);
    return names;
  }();
  return kNames;
}

Comparison compareMethods(const openvdb::GridBase& grid, const CompareOptions& options) {
  requireOptions(options);
  return Comparer(grid, options).run();
}

}  // namespace tufa
