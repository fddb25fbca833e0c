#pragma once

#include <tufa/contour.h>

#include "base/job.h"

namespace tufa::base {

/// Runs the work of one public call: work(report, job) under a job with the options' threads and
/// progress. Returns what that returns. `report` may be null.
template <class Work>
auto runCall(const ContourOptions& options, ContourReport* report, const Work& work) {
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
