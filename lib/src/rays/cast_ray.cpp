#include <tufa/rays.h>

#include <tufa/error.h>
#include <cmath>

#include "rays/surface.h"

namespace tufa {

implicit::Box boundsOf(const RaySurface& surface) {
  const base::Box& box = surface.bounds();
  if (box.isEmpty()) return {};
  return {box.lower, box.upper};
}

std::optional<RayHit> castRay(const RaySurface& surface, const Ray& ray) {
  const Vec3 direction = ray.direction;
  const double length = direction.length();
  if (!Vec3(ray.origin).isFinite() || !(length > 0) || !std::isfinite(length)) {
    throw Error(ErrorCode::InvalidArgument,
                "a ray needs an origin and a direction that are finite, and a direction that is "
                "not 0");
  }
  if (!(ray.least >= 0) || std::isnan(ray.greatest)) {
    throw Error(ErrorCode::InvalidArgument, "a ray must begin at a distance of 0 or more");
  }
  return surface.caster()->cast({ray.origin, direction / length, ray.least, ray.greatest});
}

}  // namespace tufa
