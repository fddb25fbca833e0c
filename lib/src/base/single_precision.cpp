#include "base/single_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace tufa::base {

double largestCoordinate(std::size_t count, const std::function<Position(std::size_t)>& at,
                         Job& job) {
  double largest = 0;
  std::mutex mutex;
  job.forRanges(count, [&](std::size_t begin, std::size_t end) {
    double own = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Position p = at(i);
      own = std::max({own, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    const std::scoped_lock lock(mutex);
    largest = std::max(largest, own);
  });
  return largest;
}

// A coordinate moves by half the distance of two floats at most.
bool fitsSingle(double largestCoordinate, double most) {
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * largestCoordinate;
  return std::sqrt(3.0) * rounding <= most &&
         largestCoordinate <= std::numeric_limits<float>::max();
}

bool roundToSingle(Mesh& mesh, double most, Job& job) {
  const double largest = largestCoordinate(
      mesh.positions.size(), [&](std::size_t i) { return mesh.positions[i]; }, job);
  if (!fitsSingle(largest, most)) return false;
  job.forRanges(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = toSingle(mesh.positions[i]);
  });
  return true;
}

}  // namespace tufa::base
