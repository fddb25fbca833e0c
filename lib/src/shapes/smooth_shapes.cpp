// Sphere, torus and gyroid: shapes with a closed formula.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "shapes/fields.h"

namespace tufa::shapes {
namespace {

class Sphere final : public DistanceField {
 public:
  [[nodiscard]] double halfExtent() const override { return 1; }
  [[nodiscard]] double distance(const Vec3& point) const override { return point.length() - 1; }
};

class Torus final : public DistanceField {
 public:
  [[nodiscard]] double halfExtent() const override { return kRingRadius + kTubeRadius; }

  [[nodiscard]] double distance(const Vec3& point) const override {
    const Vec3 p = toShapeFrame(point);
    return std::hypot(std::hypot(p.x(), p.y()) - kRingRadius, p.z()) - kTubeRadius;
  }

 private:
  static constexpr double kRingRadius = 1;
  static constexpr double kTubeRadius = 0.35;
};

/// The shell |g| / |grad g| < kThickness / 2 around Schoen's gyroid g = 0, cut by the unit sphere.
/// The quotient is the distance to g = 0 to first order.
class Gyroid final : public DistanceField {
 public:
  [[nodiscard]] double halfExtent() const override { return 1; }

  [[nodiscard]] double distance(const Vec3& point) const override {
    const Vec3 p = point * kWaveNumber;
    const Vec3 s(std::sin(p.x()), std::sin(p.y()), std::sin(p.z()));
    const Vec3 c(std::cos(p.x()), std::cos(p.y()), std::cos(p.z()));
    const double g = s.x() * c.y() + s.y() * c.z() + s.z() * c.x();
    const Vec3 gradient(c.x() * c.y() - s.z() * s.x(), c.y() * c.z() - s.x() * s.y(),
                        c.z() * c.x() - s.y() * s.z());
    // The gradient vanishes only where |g| is large, far outside the shell.
    const double slope = kWaveNumber * std::max(gradient.length(), kLeastGradient);
    return std::max(std::abs(g) / slope - 0.5 * kThickness, point.length() - 1);
  }

  [[nodiscard]] ValueRange range(const Vec3& center, double radius) const override {
    const Vec3 p = center * kWaveNumber;
    const double g = std::sin(p.x()) * std::cos(p.y()) + std::sin(p.y()) * std::cos(p.z()) +
                     std::sin(p.z()) * std::cos(p.x());
    // No component of the gradient exceeds 1, so |g| falls by at most sqrt(3) times the wave
    // number.
    const double steepest = std::numbers::sqrt3 * kWaveNumber;
    const double shell = std::abs(g) / steepest - radius - 0.5 * kThickness;
    const double sphere = center.length() - 1;
    // The shell is too thin for a bound from above to spare any work.
    return {std::max(shell, sphere - radius), std::numeric_limits<double>::infinity()};
  }

 private:
  static constexpr double kThickness = 0.06;
  static constexpr double kWaveNumber = 2 * std::numbers::pi / 0.5;  ///< a period of 0.5
  static constexpr double kLeastGradient = 0.1;
};

}  // namespace

std::unique_ptr<DistanceField> makeSphere() { return std::make_unique<Sphere>(); }
std::unique_ptr<DistanceField> makeTorus() { return std::make_unique<Torus>(); }
std::unique_ptr<DistanceField> makeGyroid() { return std::make_unique<Gyroid>(); }

}  // namespace tufa::shapes
