#pragma once

#include <tufa/contour.h>
#include <tufa/error.h>

#include "base/job.h"
#include "base/known_enum.h"

namespace tufa::base {

/// Which rules for ambiguous faces a call takes.
enum class Rules {
  Closed,  ///< those that give closed meshes
  All,     ///< Ambiguity::Original too
};

/// Throws Error(InvalidArgument) for the rule that leaves holes.
inline void requireClosedRule(Ambiguity rule) {
  if (rule != Ambiguity::Original) return;
  throw Error(ErrorCode::InvalidArgument,
              "the rule \"original\" for ambiguous faces may leave holes: only marching cubes "
              "(Method::MarchingCubes) take it, to show them; choose another");
}

/// Runs the work of one public call: work(report, job) under a job with the options' threads and
/// progress. Returns what that returns. `report` may be null.
template <class Work>
auto runCall(const ContourOptions& options, ContourReport* report, const Work& work,
             Rules rules = Rules::Closed) {
  requireKnown(options.inside, Inside::Above, "the side that is inside");
  requireKnown(options.ambiguity, Ambiguity::Original, "the rule for ambiguous faces");
  if (rules == Rules::Closed) requireClosedRule(options.ambiguity);
  requireKnown(options.normals, Normals::None, "the kind of normals");
  requireKnown(options.nonFinite, NonFinite::Outside, "the treatment of values not finite");
  ContourReport own;
  ContourReport& out = report != nullptr ? *report : own;
  out = {};
  Job job(options.threads, options.progress);
  decltype(work(out, job)) result;
  job.run([&] {
    result = work(out, job);
    out.stages = job.finish();
  });
  return result;
}

}  // namespace tufa::base
