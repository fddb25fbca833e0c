// What is seen of two surfaces.

#include <tufa/picture.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "base/job.h"
#include "base/number_text.h"
#include "rays/camera.h"
#include "rays/surface.h"

namespace tufa {
namespace rays {
namespace {

/// How a pixel shows two surfaces.
enum class Verdict { Nothing, Same, Silhouette, Depth };

class Comparer {
 public:
  Comparer(const RaySurface& a, const RaySurface& b, const Camera& camera, double tolerance)
      : a_(a.caster()), b_(b.caster()), camera_(camera), tolerance_(tolerance) {}

  [[nodiscard]] Verdict at(double x, double y) {
    const UnitRay ray = camera_.ray(x, y);
    const auto a = a_->cast(ray);
    const auto b = b_->cast(ray);
    if (!a && !b) return Verdict::Nothing;
    if (a && b && isNear(ray, *a, *b)) return Verdict::Same;
    // Of a rim it counts how far aside the other one is, of a place how far away.
    if (!a) return isAnyBeside(ray, *a_) ? Verdict::Same : Verdict::Silhouette;
    if (!b) return isAnyBeside(ray, *b_) ? Verdict::Same : Verdict::Silhouette;
    const bool same = isBeside(ray, *a, *b_) && isBeside(ray, *b, *a_);
    return same ? Verdict::Same : Verdict::Depth;
  }

 private:
  /// Across the surface: of the two angles, the one that it is seen under more steeply.
  [[nodiscard]] bool isNear(const UnitRay& ray, const RayHit& a, const RayHit& b) const {
    const double slant = std::max(std::abs(Vec3(a.normal).dot(ray.direction)),
                                  std::abs(Vec3(b.normal).dot(ray.direction)));
    return std::abs(a.distance - b.distance) * slant <= tolerance_;
  }

  /// Through different rays: as points, or across both surfaces.
  [[nodiscard]] bool isNear(const RayHit& a, const RayHit& b) const {
    const Vec3 between = Vec3(a.point) - Vec3(b.point);
    const double length = between.length();
    if (length <= tolerance_) return true;
    return length <= 2 * tolerance_ && std::abs(between.dot(Vec3(a.normal))) <= tolerance_ &&
           std::abs(between.dot(Vec3(b.normal))) <= tolerance_;
  }

  [[nodiscard]] bool isAnyBeside(const UnitRay& ray, Caster& other) const {
    return anyBeside(ray, other, [](const RayHit& /*found*/) { return true; });
  }
  /// Whether a surface is seen near a place, through rays beside the one that it was seen by.
  [[nodiscard]] bool isBeside(const UnitRay& ray, const RayHit& hit, Caster& other) const {
    return anyBeside(ray, other, [&](const RayHit& found) { return isNear(hit, found); });
  }

  template <class Accept>
  [[nodiscard]] bool anyBeside(const UnitRay& ray, Caster& other, const Accept& accept) const {
    constexpr int kDirections = 8;
    constexpr std::array<double, 4> kRings = {0.25, 0.5, 0.75, 1};
    const base::ViewFrame& frame = camera_.frame();
    for (const double ring : kRings) {
      for (int n = 0; n < kDirections; ++n) {
        const double angle = 2 * std::numbers::pi * n / kDirections;
        UnitRay moved = ray;
        moved.origin +=
            (frame.right * std::cos(angle) + frame.up * std::sin(angle)) * (ring * tolerance_);
        const auto found = other.cast(moved);
        if (found && accept(*found)) return true;
      }
    }
    return false;
  }

  std::unique_ptr<Caster> a_;
  std::unique_ptr<Caster> b_;
  const Camera& camera_;
  double tolerance_;
};

}  // namespace
}  // namespace rays

SurfaceComparison compareSurfaces(const RaySurface& a, const RaySurface& b, double tolerance,
                                  const PictureOptions& options) {
  if (!(tolerance > 0) || !std::isfinite(tolerance)) {
    throw Error(ErrorCode::InvalidArgument,
                "the tolerance must be above 0, not " + base::numberText(tolerance));
  }
  base::Job job(options.threads, options.progress);
  std::array<std::atomic<std::size_t>, 4> counts{};
  job.run([&] {
    const rays::Camera camera(a.bounds().isEmpty() ? b : a, options);
    job.beginStage("rays", 1);
    const auto rows = static_cast<std::size_t>(options.height);
    job.forRanges(rows, 1, [&](std::size_t begin, std::size_t end) {
      rays::Comparer comparer(a, b, camera, tolerance);
      for (std::size_t y = begin; y < end; ++y) {
        for (int x = 0; x < options.width; ++x) {
          const auto verdict = comparer.at(x + 0.5, static_cast<double>(y) + 0.5);
          ++counts[static_cast<std::size_t>(verdict)];
        }
      }
    });
  });
  job.finish();
  SurfaceComparison comparison;
  comparison.silhouette = counts[static_cast<std::size_t>(rays::Verdict::Silhouette)];
  comparison.depth = counts[static_cast<std::size_t>(rays::Verdict::Depth)];
  comparison.pixels = comparison.silhouette + comparison.depth +
                      counts[static_cast<std::size_t>(rays::Verdict::Same)];
  return comparison;
}

}  // namespace tufa
