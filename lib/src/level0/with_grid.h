#pragma once

#include <openvdb/openvdb.h>

#include <tufa/contour.h>

#include "base/job.h"

namespace tufa::level0 {

/// Throws Error(UnsupportedGrid) unless the grid is a float or double grid with a linear transform.
void requireScalar(const openvdb::GridBase& grid);

/// Throws Error(LimitExceeded) if coordinates beside the grid's own could overflow.
void requireCoordinates(const openvdb::GridBase& grid);

/// Calls work(grid, report, job) with the grid in its own type, under a job with the options'
/// threads and progress, and returns what that returns. `report` may be null.
template <class Result, class Work>
Result withGrid(const openvdb::GridBase& grid, const ContourOptions& options, ContourReport* report,
                const Work& work) {
  requireScalar(grid);
  requireCoordinates(grid);
  ContourReport own;
  ContourReport& out = report != nullptr ? *report : own;
  out = {};
  base::Job job(options.threads, options.progress);
  Result result;
  job.run([&] {
    result = grid.isType<openvdb::FloatGrid>()
                 ? work(static_cast<const openvdb::FloatGrid&>(grid), out, job)
                 : work(static_cast<const openvdb::DoubleGrid&>(grid), out, job);
    out.stages = job.finish();
  });
  return result;
}

}  // namespace tufa::level0
