#pragma once

#include <tufa/rays.h>

#include <memory>
#include <optional>

#include "base/box.h"
#include "base/vec3.h"

namespace tufa {

namespace rays {

/// A ray whose direction has length 1.
struct UnitRay {
  Vec3 origin;
  Vec3 direction;
  double least = 0;
  double greatest = 0;
  [[nodiscard]] Vec3 at(double distance) const { return origin + direction * distance; }
};

/// Casts rays, for one thread: keeps what it needs from one to the next.
class Caster {
 public:
  Caster() = default;
  virtual ~Caster() = default;
  Caster(const Caster&) = delete;
  Caster& operator=(const Caster&) = delete;

  /// The first place where the ray passes the surface.
  [[nodiscard]] virtual std::optional<RayHit> cast(const UnitRay& ray) = 0;
};

}  // namespace rays

class RaySurface {
 public:
  explicit RaySurface(const base::Box& bounds, double skin) : bounds_(bounds), skin_(skin) {}
  virtual ~RaySurface() = default;
  RaySurface(const RaySurface&) = delete;
  RaySurface& operator=(const RaySurface&) = delete;

  [[nodiscard]] virtual std::unique_ptr<rays::Caster> caster() const = 0;

  /// Holds the surface; empty if there is none.
  [[nodiscard]] const base::Box& bounds() const { return bounds_; }
  /// So far from a hit, along the normal, a ray that begins does not meet the same place again.
  [[nodiscard]] double skin() const { return skin_; }

 private:
  base::Box bounds_;
  double skin_;
};

}  // namespace tufa
