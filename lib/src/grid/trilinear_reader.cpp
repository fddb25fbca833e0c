#include "grid/trilinear_reader.h"

#include <cmath>

namespace tufa::grid {
namespace {

double mix(double a, double b, double t) { return a + (b - a) * t; }

}  // namespace

void TrilinearReader::load(const Coord& cell) {
  if (isLoaded_ && cell == cell_) return;
  isLoaded_ = true;
  cell_ = cell;
  const FieldScale& scale = volume_.scale;
  for (int n = 0; n < 8; ++n) {
    const double raw =
        accessor_->value((cell + volume_.affine.origin()).offsetBy(n >> 2, (n >> 1) & 1, n & 1));
    // As in SampleReader: a sample that is not finite counts as outside.
    corners_[n] = std::isfinite(raw) ? (raw - scale.isovalue) * scale.factor : 1;
  }
}

double TrilinearReader::value(const Vec3& point) {
  load(floorCoord(point));
  const double x = point[0] - cell_[0], y = point[1] - cell_[1], z = point[2] - cell_[2];
  const auto& v = corners_;
  return mix(mix(mix(v[0], v[1], z), mix(v[2], v[3], z), y),
             mix(mix(v[4], v[5], z), mix(v[6], v[7], z), y), x);
}

Vec3 TrilinearReader::gradient(const Vec3& point) {
  load(floorCoord(point));
  const double x = point[0] - cell_[0], y = point[1] - cell_[1], z = point[2] - cell_[2];
  const auto& v = corners_;
  return {mix(mix(v[4] - v[0], v[5] - v[1], z), mix(v[6] - v[2], v[7] - v[3], z), y),
          mix(mix(v[2] - v[0], v[3] - v[1], z), mix(v[6] - v[4], v[7] - v[5], z), x),
          mix(mix(v[1] - v[0], v[3] - v[2], y), mix(v[5] - v[4], v[7] - v[6], y), x)};
}

double TrilinearReader::slope(const Vec3& gradient) const {
  const auto single = [&](int axis) { return static_cast<float>(gradient[axis]); };
  return std::sqrt(
      static_cast<double>(volume_.scale.squaredLength(single(0), single(1), single(2))));
}

}  // namespace tufa::grid
