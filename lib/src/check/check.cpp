#include <tufa/check.h>
#include <tufa/error.h>
#include <chrono>
#include <limits>
#include <string>

#include "base/job.h"
#include "check/bounds_volume.h"
#include "check/faces.h"
#include "check/intersections.h"
#include "check/measures.h"
#include "check/nesting.h"
#include "check/topology.h"

namespace tufa {
namespace {

/// CGAL compares components in pairs, so meshes of more components than this get the answer of the
/// nesting test, which has the same definition and takes time proportional to their number.
constexpr std::size_t kMostPiecesForCgal = 1000;

void refuseTooLarge(const Mesh& mesh) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  if (mesh.triangleCount() > kMost || mesh.positions.size() > kMost) {
    throw Error(ErrorCode::LimitExceeded,
                "the mesh has " + std::to_string(mesh.triangleCount()) + " triangles and " +
                    std::to_string(mesh.positions.size()) + " positions; check() takes up to " +
                    std::to_string(kMost) + " of each");
  }
}

void countFaces(const checks::Faces& faces, CheckReport& report) {
  report.triangles = faces.triangleCount;
  report.invalidFaces = faces.invalidCount;
  report.collapsedFaces = faces.collapsedCount;
  report.degenerateFaces = faces.collapsedCount + faces.collinearCount;
}

/// Decides outward and boundsVolume, both of which need a closed, oriented surface.
void judgeVolume(const checks::Faces& faces, const checks::Pieces& pieces, const base::Bvh& tree,
                 const CheckOptions& options, base::Job& job, CheckReport& report) {
  if (!report.closed || !report.oriented) return;
  job.beginStage("nesting", 0.85);
  const checks::Nesting nesting = checks::studyNesting(faces, pieces, tree, job);
  report.outward = nesting.outward;
  const bool isSimple = report.manifold && report.selfIntersectingPairs == 0U;
  if (!options.boundsVolume || !isSimple) return;
  job.beginStage("volume", 1);
  report.boundsVolume =
      pieces.count > kMostPiecesForCgal ? nesting.alternates : checks::cgalBoundsVolume(faces);
}

void fillReport(const Mesh& mesh, const CheckOptions& options, base::Job& job,
                CheckReport& report) {
  job.beginStage("faces", 0.1);
  const checks::Faces faces = checks::sortFaces(mesh, options.weld, job);
  countFaces(faces, report);
  job.beginStage("topology", 0.2);
  const checks::Pieces pieces = checks::analyseTopology(faces, job, report);
  job.beginStage("measures", 0.25);
  checks::measure(faces, job, report);
  job.beginStage("tree", 0.35);
  const base::Bvh tree = checks::buildFaceTree(faces, job);
  if (options.selfIntersections) {
    job.beginStage("intersections", 0.8);
    report.selfIntersectingPairs = checks::countIntersectingPairs(faces, tree, job);
  }
  judgeVolume(faces, pieces, tree, options, job, report);
}

}  // namespace

bool CheckReport::watertight() const {
  return closed && manifold && oriented && outward && invalidFaces == 0 && collapsedFaces == 0 &&
         duplicateFaces == 0;
}

CheckReport check(const Mesh& mesh, const CheckOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  refuseTooLarge(mesh);
  CheckReport report;
  base::Job job(options.threads, options.progress);
  job.run([&] { fillReport(mesh, options, job, report); });
  job.finish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace tufa
