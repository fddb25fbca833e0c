#include <openvdb/openvdb.h>
#include <tufa/filter.h>

#include <tufa/error.h>
#include <array>
#include <chrono>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/job.h"
#include "base/known_enum.h"
#include "base/number_text.h"
#include "base/parallel.h"
#include "filter/steps.h"
#include "grid/non_finite.h"
#include "grid/volume.h"

namespace tufa {
namespace {

using filter::ComponentRule;
using filter::Components;
using filter::ProgressInterrupter;

std::string nameOf(const Filter& filter) {
  constexpr std::array kNames = {"smooth", "offset", "open", "close",        "resample",
                                 "clip",   "clip",   "mask", "keep-largest", "min-component"};
  static_assert(kNames.size() == std::variant_size_v<Filter>);
  return kNames[filter.index()];
}

double requireAbove0(double distance, const char* what) {
  if (distance > 0) return distance;
  throw Error(ErrorCode::InvalidArgument,
              std::string(what) + " needs a distance above 0, not " + base::numberText(distance));
}

/// Applies one filter to a grid of a known type.
template <class GridT>
class Step {
 public:
  Step(typename GridT::Ptr grid, const FilterOptions& options, ProgressInterrupter& interrupter)
      : grid_(std::move(grid)), options_(options), interrupter_(interrupter) {}

  void operator()(const Smooth& step) {
    base::requireKnown(step.smoothing, Smoothing::Curvature, "the kind of smoothing");
    filter::smooth(*grid_, step, interrupter_);
  }
  void operator()(const Offset& step) { filter::offset(*grid_, {step.distance}, interrupter_); }
  void operator()(const Open& step) {
    const double distance = requireAbove0(step.distance, "opening");
    filter::offset(*grid_, {-distance, distance}, interrupter_);
  }
  void operator()(const Close& step) {
    const double distance = requireAbove0(step.distance, "closing");
    filter::offset(*grid_, {distance, -distance}, interrupter_);
  }
  void operator()(const Resample& step) {
    grid_ = filter::resample(*grid_, step, options_.mostVoxels, interrupter_);
  }
  void operator()(const ClipBox& step) { filter::clipToBox(*grid_, step, interrupter_); }
  void operator()(const ClipGrid& step) {
    filter::clipToGrid(*grid_, step.grid.get(), false, interrupter_);
  }
  void operator()(const Mask& step) {
    filter::clipToGrid(*grid_, step.grid.get(), true, interrupter_);
  }
  void operator()(const KeepLargest& step) {
    if (step.count == 0) {
      throw Error(ErrorCode::InvalidArgument, "at least one component must be kept");
    }
    keep({step.count, 1});
  }
  void operator()(const MinComponent& step) {
    keep({std::numeric_limits<std::size_t>::max(), step.voxels});
  }

  [[nodiscard]] const typename GridT::Ptr& grid() const { return grid_; }
  [[nodiscard]] const Components& components() const { return components_; }

 private:
  void keep(const ComponentRule& rule) {
    const auto iso = grid::chooseIsovalue(*grid_, options_.isovalue, options_.inside);
    components_ = filter::keepComponents(*grid_, rule, iso, interrupter_);
  }

  typename GridT::Ptr grid_;
  const FilterOptions& options_;
  ProgressInterrupter& interrupter_;
  Components components_;
};

template <class GridT>
openvdb::GridBase::Ptr applyAll(const GridT& source, const std::vector<Filter>& filters,
                                const FilterOptions& options, const Progress& progress,
                                std::vector<FilterReport>& reports) {
  typename GridT::Ptr grid = source.deepCopy();
  const std::size_t nonFinite =
      grid::takeAsOutside(*grid, {options.nonFinite, options.isovalue, options.inside});
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    FilterReport report;
    report.filter = nameOf(filters[i]);
    report.voxelsBefore = grid->activeVoxelCount();
    const auto share = [&](std::size_t done) {
      return static_cast<double>(done) / static_cast<double>(filters.size());
    };
    ProgressInterrupter interrupter(progress, report.filter, share(i), share(i + 1));
    Step<GridT> step(std::move(grid), options, interrupter);
    // An interrupted tracking of level sets cancels the tasks around it, and with them the error.
    if (!interrupter.wasInterrupted(0)) base::runIsolated([&] { std::visit(step, filters[i]); });
    if (interrupter.cancelled() || interrupter.wasInterrupted(100)) {
      throw Error(ErrorCode::Cancelled, "cancelled while filtering");
    }
    grid = step.grid();
    report.voxelsAfter = grid->activeVoxelCount();
    report.components = step.components().found;
    report.componentsKept = step.components().kept;
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (i == 0) report.nonFiniteValues = nonFinite;
    reports.push_back(std::move(report));
  }
  return grid;
}

}  // namespace

openvdb::GridBase::Ptr applyFilters(const openvdb::GridBase& grid,
                                    const std::vector<Filter>& filters,
                                    const FilterOptions& options,
                                    std::vector<FilterReport>* reports) {
  grid::requireMeshable(grid);
  base::requireKnown(options.inside, Inside::Above, "the side that is inside");
  base::requireKnown(options.nonFinite, NonFinite::Outside, "what to do with NaN");
  openvdb::GridBase::Ptr result;
  std::vector<FilterReport> found;
  base::Job(options.threads, {}).run([&] {
    const std::string what = "OpenVDB cannot filter grid \"" + grid.getName() + '"';
    filter::translatingErrors(options.progress, what, [&](const Progress& progress) {
      grid.apply<openvdb::RealGridTypes>(
          [&](const auto& typed) { result = applyAll(typed, filters, options, progress, found); });
    });
  });
  if (filters.empty()) (void)base::Job(options.threads, options.progress).finish();
  if (reports != nullptr) *reports = std::move(found);
  return result;
}

}  // namespace tufa
