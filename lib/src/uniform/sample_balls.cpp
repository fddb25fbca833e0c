#include "uniform/sample_balls.h"

#include <algorithm>
#include <cmath>

namespace tufa::uniform {
bool SampleBalls::admit(const Vec3& point) const {
  const int low[3] = {static_cast<int>(std::floor(point[0])) - 1,
                      static_cast<int>(std::floor(point[1])) - 1,
                      static_cast<int>(std::floor(point[2])) - 1};
  for (int i = 0; i < 64; ++i) {
    const int x = low[0] + i / 16, y = low[1] + i / 4 % 4, z = low[2] + i % 4;
    const double value = accessor_.value(origin_.offsetBy(x, y, z));
    if (!std::isfinite(value)) continue;
    const double distance = std::abs((value - scale_.isovalue) * scale_.factor);
    const double radius =
        std::min(distance, static_cast<double>(scale_.bandOutside)) - double{kSlack};
    if (radius > 0 && (Vec3(x, y, z) - point).squaredLength() < radius * radius) return false;
  }
  return true;
}

}  // namespace tufa::uniform
