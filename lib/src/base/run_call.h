#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "base/known_enum.h"

namespace tufa::base {

/// Runs the work of one public call: work(report, job) under a job with the options' threads and
/// progress. Returns what that returns. `report` may be null.
template <class Work>
auto runCall(const ContourOptions& options, ContourReport* report, const Work& work) {
  requireKnown(options.inside, Inside::Above, "the side that is inside");
  requireKnown(options.ambiguity, Ambiguity::Chord, "the rule for ambiguous faces");
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
