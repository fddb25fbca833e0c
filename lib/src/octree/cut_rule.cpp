#include "octree/cut_rule.h"

#include <tufa/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/number_text.h"
#include "grid/tolerance_scale.h"

namespace tufa::octree {
namespace {

int levelOf(int size, const char* name) {
  if (size >= 1 && std::has_single_bit(static_cast<unsigned>(size))) {
    return std::countr_zero(static_cast<unsigned>(size));
  }
  throw Error(
      ErrorCode::InvalidArgument,
      std::string(name) + " must be a power of two of 1 or more, not " + std::to_string(size));
}

void requireRange(double value, double least, double greatest, const char* name) {
  if (value >= least && value <= greatest) return;
  throw Error(ErrorCode::InvalidArgument,
              std::string(name) + " must be from " + base::numberText(least) + " to " +
                  base::numberText(greatest) + ", not " + base::numberText(value));
}

}  // namespace

void requireTolerance(double tolerance) {
  requireRange(tolerance, 0, kLargestTolerance, "the tolerance");
}

void requireFactor(double factor) {
  if (factor > 1 && factor <= kLargestTolerance) return;
  throw Error(ErrorCode::InvalidArgument,
              "the factor between the tolerances of two levels must be above 1, to " +
                  base::numberText(kLargestTolerance) + ", not " + base::numberText(factor));
}

bool maySimplify(const ContourOptions& options) {
  const ContourOptions unbounded;
  return options.simplify && options.maxAngle >= unbounded.maxAngle &&
         options.maxCell >= unbounded.maxCell && options.minCell <= unbounded.minCell;
}

CutRule readRule(const ContourOptions& options, const grid::Transform& transform) {
  requireTolerance(options.tolerance);
  requireRange(options.maxAngle, 0, 180, "the largest angle");
  requireRange(options.minAngle, 0, kLargestMinAngle, "the least angle");
  if (options.minAngle > 0 && !maySimplify(options)) {
    throw Error(ErrorCode::InvalidArgument,
                "a least angle is kept by collapsing edges: not without simplifying, or with "
                "bounds on angles or cells");
  }
  CutRule rule;
  rule.minAngle = options.minAngle;
  rule.tolerance = options.tolerance;
  rule.maxAngle =
      options.maxAngle >= 180 ? CutRule::kAnyAngle : options.maxAngle * std::numbers::pi / 180;
  rule.minLevel = levelOf(options.minCell, "the smallest cell size");
  rule.maxLevel = levelOf(options.maxCell, "the largest cell size");
  if (rule.maxLevel < rule.minLevel) {
    throw Error(ErrorCode::InvalidArgument, "the largest cell size must not be below the smallest");
  }
  if (options.toleranceGrid) {
    rule.scale = grid::toleranceScale(options.toleranceGrid, transform);
  }
  return rule;
}

}  // namespace tufa::octree
