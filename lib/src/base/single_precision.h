#pragma once

#include <tufa/mesh.h>

#include "base/job.h"

namespace tufa::base {

/// A coordinate as it is after a way through single precision. Volatile, because GCC 12 drops the
/// two conversions where it makes one vector instruction of a pair of them.
inline double toSingle(double x) {
  const volatile float single = static_cast<float>(x);
  return double{single};
}

/// A position as it is after a way through single precision.
inline Position toSingle(const Position& p) {
  return {toSingle(p.x), toSingle(p.y), toSingle(p.z)};
}

/// Rounds all positions to single precision if none moves by more than `most`; returns whether it
/// did. What is then said of the mesh, that it does not meet itself for one, holds for files of
/// single precision too.
bool roundToSingle(Mesh& mesh, double most, Job& job);

}  // namespace tufa::base
