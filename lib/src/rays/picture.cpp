// Shaded pictures by rays.

#include <tufa/picture.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include "base/job.h"
#include "rays/camera.h"
#include "rays/surface.h"

namespace tufa {
namespace rays {
namespace {

using Color = std::array<float, 3>;

constexpr Color kGround = {0.93F, 0.94F, 0.955F};
constexpr Color kSurface = {0.27F, 0.40F, 0.56F};
/// Side of the squares of pixels that are handed out.
constexpr int kTile = 16;

std::uint64_t mixed(std::uint64_t x) {
  // The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9U;
  x = (x ^ x >> 27) * 0x94d049bb133111ebU;
  return x ^ x >> 31;
}

/// The numbers of a sample, 0 to 1: an additive sequence that fills six dimensions evenly (Roberts
/// 2018), moved by an offset of the pixel's own. The same for any order of pixels.
class SampleNumbers {
 public:
  SampleNumbers(std::uint64_t pixel, int sample) : sample_(sample), state_(mixed(pixel)) {}

  double next() {
    // Powers of the inverse of the root of x⁷ = x + 1.
    constexpr double kStep = 0.89653393287646;
    power_ *= kStep;
    state_ = mixed(state_);
    const double offset = static_cast<double>(state_ >> 11) * 0x1p-53;
    const double at = offset + power_ * sample_;
    return at - std::floor(at);
  }

 private:
  int sample_;
  std::uint64_t state_;
  double power_ = 1;
};

/// A direction around `axis`: at an angle whose sine squared is `spread`, turned by `turn`.
Vec3 around(const Vec3& axis, double spread, double turn) {
  const Vec3 other = std::abs(axis[0]) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 u = axis.cross(other).unitOrX();
  const Vec3 v = axis.cross(u);
  const double angle = 2 * std::numbers::pi * turn;
  const double sine = std::sqrt(spread);
  return axis * std::sqrt(1 - spread) + (u * std::cos(angle) + v * std::sin(angle)) * sine;
}

/// Lamps and sky of a view.
class Light {
 public:
  Light(const Camera& camera, const RaySurface& surface, const PictureOptions& options)
      : frame_(camera.frame()),
        options_(options),
        skin_(surface.skin()),
        reach_(surface.bounds().isEmpty() ? 1 : surface.bounds().size().length()) {
    key_ = (0.75 * frame_.toEye + 0.8 * frame_.up - 0.75 * frame_.right).unitOrX();
    fill_ = (frame_.toEye + 0.1 * frame_.up + 1.1 * frame_.right).unitOrX();
  }

  [[nodiscard]] Color shade(const UnitRay& ray, const RayHit& hit, Caster& caster,
                            SampleNumbers& numbers) const {
    // Four numbers for each sample, used or not.
    const double lampSpread = numbers.next(), lampTurn = numbers.next();
    const double skySpread = numbers.next(), skyTurn = numbers.next();
    Vec3 normal(hit.normal);
    if (normal.dot(ray.direction) > 0) normal = -normal;
    const Vec3 start = Vec3(hit.point) + normal * skin_;

    // The lamp is a disc, some 9 degrees wide.
    constexpr double kLampSpread = 0.006;
    const Vec3 toLamp = around(key_, kLampSpread * lampSpread, lampTurn);
    double key = std::max(0.0, normal.dot(toLamp));
    if (options_.shadows && key > 0 && isHidden(caster, start, toLamp, reach_)) key = 0;

    // By the cosine of the angle with the normal, so that all have one weight.
    double open = 1;
    if (options_.occlusion && normal.squaredLength() > 0) {
      const Vec3 toSky = around(normal, skySpread, skyTurn);
      constexpr double kShare = 0.35;
      if (isHidden(caster, start, toSky, kShare * reach_)) open = kInOcclusion;
    }
    const double sky = (0.5 + 0.5 * normal.dot(frame_.up)) * open;
    const double fill = std::max(0.0, normal.dot(fill_)) * open;
    const double light = 0.14 * open + 0.34 * sky + 0.62 * key + 0.22 * fill;
    const double gloss =
        key > 0 ? std::pow(std::max(0.0, normal.dot((key_ - ray.direction).unitOrX())), 40) : 0;
    Color color = kSurface;
    for (float& c : color) {
      c = c * static_cast<float>(light) + 0.07F * static_cast<float>(gloss);
    }
    return color;
  }

 private:
  /// What is left of the sky's light where something stands before it: some is thrown back.
  static constexpr double kInOcclusion = 0.15;

  static bool isHidden(Caster& caster, const Vec3& from, const Vec3& direction, double reach) {
    return caster.cast({from, direction, 0, reach}).has_value();
  }

  base::ViewFrame frame_;
  const PictureOptions& options_;
  double skin_;
  double reach_;  ///< longer than any way through the surface's box
  Vec3 key_, fill_;
};

class Painter {
 public:
  Painter(const RaySurface& surface, const PictureOptions& options)
      : surface_(surface),
        options_(options),
        camera_(surface, options),
        light_(camera_, surface, options) {
    picture_.width = options.width;
    picture_.height = options.height;
    picture_.pixels.resize(static_cast<std::size_t>(options.width) *
                           static_cast<std::size_t>(options.height));
  }

  Picture paint(base::Job& job) {
    const int columns = (options_.width + kTile - 1) / kTile;
    const int rows = (options_.height + kTile - 1) / kTile;
    job.beginStage("rays", 1);
    job.forRanges(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 1,
                  [&](std::size_t begin, std::size_t end) {
                    const auto caster = surface_.caster();
                    for (std::size_t tile = begin; tile < end; ++tile) {
                      const int place = static_cast<int>(tile);
                      paintTile(place % columns * kTile, place / columns * kTile, *caster);
                    }
                  });
    const double rays = static_cast<double>(picture_.pixels.size()) * options_.samples;
    picture_.covered = static_cast<double>(hits_.load()) / rays;
    return std::move(picture_);
  }

 private:
  void paintTile(int left, int top, Caster& caster) {
    std::size_t hits = 0;
    for (int y = top; y < std::min(top + kTile, options_.height); ++y) {
      for (int x = left; x < std::min(left + kTile, options_.width); ++x) {
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(options_.width) +
            static_cast<std::size_t>(x);
        picture_.pixels[pixel] = pixelAt(x, y, pixel, caster, hits);
      }
    }
    hits_.fetch_add(hits, std::memory_order_relaxed);
  }

  [[nodiscard]] Color pixelAt(int x, int y, std::size_t pixel, Caster& caster,
                              std::size_t& hits) const {
    Color sum{};
    for (int sample = 0; sample < options_.samples; ++sample) {
      SampleNumbers numbers(pixel, sample);
      // One sample is that of the middle.
      const double dx = numbers.next(), dy = numbers.next();
      const bool one = options_.samples == 1;
      const UnitRay ray = camera_.ray(x + (one ? 0.5 : dx), y + (one ? 0.5 : dy));
      const auto hit = caster.cast(ray);
      if (hit) ++hits;
      const Color color = hit ? light_.shade(ray, *hit, caster, numbers) : kGround;
      for (std::size_t i = 0; i < 3; ++i) sum[i] += color[i];
    }
    for (float& c : sum) c /= static_cast<float>(options_.samples);
    return sum;
  }

  const RaySurface& surface_;
  const PictureOptions& options_;
  Camera camera_;
  Light light_;
  Picture picture_;
  std::atomic<std::size_t> hits_{0};
};

}  // namespace
}  // namespace rays

Picture takePicture(const RaySurface& surface, const PictureOptions& options) {
  base::Job job(options.threads, options.progress);
  Picture picture;
  job.run([&] { picture = rays::Painter(surface, options).paint(job); });
  job.finish();
  return picture;
}

}  // namespace tufa
