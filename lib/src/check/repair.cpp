#include <tufa/repair.h>

#include <tufa/error.h>
#include <cmath>
#include <string>

#include "base/part_of_progress.h"
#include "check/repair_steps.h"

namespace tufa {
namespace {

// Shares of the call's progress.
constexpr double kBeforeEnd = 0.3, kStepsEnd = 0.7;

void requireOptions(const RepairOptions& options) {
  if (!(options.mergeDistance >= 0) || !std::isfinite(options.mergeDistance)) {
    throw Error(ErrorCode::InvalidArgument, "the merge distance is " +
                                                std::to_string(options.mergeDistance) +
                                                ", must be 0 or a finite number above it");
  }
  if (options.fillEdges < 0) {
    throw Error(ErrorCode::InvalidArgument, "the edges of holes to fill are " +
                                                std::to_string(options.fillEdges) +
                                                ", must be 0 or more");
  }
}

std::size_t faultsOf(const CheckReport& report) {
  return report.boundaryEdges + report.nonManifoldEdges + report.nonManifoldVertices +
         report.misorientedEdges + report.invalidFaces + report.collapsedFaces +
         report.duplicateFaces;
}

CheckReport checked(const Mesh& mesh, const RepairOptions& options, double begin, double end) {
  CheckOptions checks;
  checks.threads = options.threads;
  checks.progress = base::partOf(options.progress, begin, end);
  return check(mesh, checks);
}

}  // namespace

Mesh repair(const Mesh& mesh, const RepairOptions& options, RepairReport* report) {
  requireOptions(options);
  RepairReport own;
  RepairReport& out = report != nullptr ? *report : own;
  out = {};
  out.before = checked(mesh, options, 0, kBeforeEnd);
  const Progress tell = base::partOf(options.progress, kBeforeEnd, kStepsEnd);
  Mesh repaired = checks::runRepairSteps(mesh, options, out, [&](double done) {
    if (tell && !tell("repair", done)) throw Error(ErrorCode::Cancelled, "cancelled by the caller");
  });
  out.after = checked(repaired, options, kStepsEnd, 1);
  // Never a worse mesh than the input; nor an empty one in place of faces. What was closed may
  // touch itself, which merging vertices makes a fault of another kind.
  const bool worse = faultsOf(out.after) > faultsOf(out.before) ||
                     (out.before.watertight() && !out.after.watertight()) ||
                     (repaired.triangles.empty() && mesh.triangleCount() > 0);
  if (!worse) return repaired;
  const CheckReport before = out.before;
  out = {};
  out.before = out.after = before;
  out.keptInput = true;
  return mesh;
}

}  // namespace tufa
