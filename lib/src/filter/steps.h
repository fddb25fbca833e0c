#pragma once

#include <openvdb/openvdb.h>
#include <tufa/error.h>
#include <tufa/filter.h>
#include <string>
#include <string_view>

#include "grid/isovalue.h"
#include "grid/progress_interrupter.h"

namespace tufa::filter {

// One kind of filter each, for float and double grids. The grid may be changed, or another one
// returned. All throw Error(UnsupportedGrid) for grids that the filter has no meaning for, and
// Error(InvalidArgument) for options out of their range. A step that was interrupted may leave
// anything: who calls asks the interrupter.

using grid::ProgressInterrupter;

/// Calls work(progress). What OpenVDB throws in it comes out as Error(UnsupportedGrid), which
/// begins with `what`; what the caller's own progress throws comes out as it is, OpenVDB's kinds
/// too.
template <class Work>
void translatingErrors(const Progress& callers, const std::string& what, const Work& work) {
  bool isCallers = false;
  Progress progress;
  if (callers) {
    progress = [&](std::string_view stage, double fraction) {
      try {
        return callers(stage, fraction);
      } catch (...) {
        isCallers = true;
        throw;
      }
    };
  }
  try {
    work(progress);
  } catch (const openvdb::Exception& error) {
    if (isCallers) throw;
    throw Error(ErrorCode::UnsupportedGrid, what + ": " + error.what());
  }
}

template <class GridT>
void smooth(GridT& grid, const Smooth& step, ProgressInterrupter& interrupter);

/// Moves the surface by some distances in world units, one after the other: outward above 0.
template <class GridT>
void offset(GridT& grid, const std::vector<double>& distances, ProgressInterrupter& interrupter);

/// Fills an empty grid, of the class and the background that it is to have, with the values of
/// another one at its places in world space.
template <class GridT>
void sampleOnto(const GridT& source, GridT& result, ProgressInterrupter& interrupter);

template <class GridT>
typename GridT::Ptr resample(const GridT& grid, const Resample& step, double mostVoxels,
                             ProgressInterrupter& interrupter);

template <class GridT>
void clipToBox(GridT& grid, const ClipBox& step, ProgressInterrupter& interrupter);

/// Keeps what lies where the active voxels of another grid are or, if `inside`, where that is a
/// level set, what lies in its inside.
template <class GridT>
void clipToGrid(GridT& grid, const openvdb::GridBase* mask, bool inside,
                ProgressInterrupter& interrupter);

/// How many components there were, and how many are left.
struct Components {
  std::size_t found = 0;
  std::size_t kept = 0;
};

/// Which components stay: those of the most voxels, and of these the ones that have enough.
struct ComponentRule {
  std::size_t most = 0;    ///< components
  std::size_t voxels = 1;  ///< of the smallest
};

template <class GridT>
Components keepComponents(GridT& grid, const ComponentRule& rule, const grid::IsoChoice& iso,
                          ProgressInterrupter& interrupter);

}  // namespace tufa::filter
