#pragma once

#include <tufa/mesh.h>

#include <cstddef>
#include <functional>

#include "base/job.h"

namespace tufa::base {

/// A coordinate rounded to single precision. Volatile, because GCC 12 drops both conversions where
/// it vectorizes a pair of them.
inline double toSingle(double x) {
  const volatile float single = static_cast<float>(x);
  return double{single};
}

/// A position rounded to single precision.
inline Position toSingle(const Position& p) {
  return {toSingle(p.x), toSingle(p.y), toSingle(p.z)};
}

/// The largest of the coordinates, without signs, of the positions at(i) for i below `count`.
[[nodiscard]] double largestCoordinate(std::size_t count,
                                       const std::function<Position(std::size_t)>& at, Job& job);

/// Whether rounding to single precision moves no position by more than `most`, given the largest
/// coordinate.
[[nodiscard]] bool fitsSingle(double largestCoordinate, double most);

/// Rounds all positions to single precision if none moves by more than `most`. Whether it did: then
/// what is found about the mesh, such as that it does not intersect itself, holds for files of
/// single precision too.
bool roundToSingle(Mesh& mesh, double most, Job& job);

}  // namespace tufa::base
