#include "base/single_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace tufa::base {

bool roundToSingle(Mesh& mesh, double most, Job& job) {
  double largest = 0;
  std::mutex mutex;
  job.forRanges(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    double own = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Position& p = mesh.positions[i];
      own = std::max({own, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    const std::scoped_lock lock(mutex);
    largest = std::max(largest, own);
  });
  // A coordinate moves by half the distance of two floats at most.
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * largest;
  if (!(std::sqrt(3.0) * rounding <= most) || largest > std::numeric_limits<float>::max())
    return false;
  job.forRanges(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = toSingle(mesh.positions[i]);
  });
  return true;
}

}  // namespace tufa::base
