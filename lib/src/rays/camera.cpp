#include "rays/camera.h"

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/number_text.h"

namespace tufa::rays {
namespace {

void requireUsable(const PictureOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::InvalidArgument, what);
  };
  constexpr int kMostPixels = 65535;
  for (const int side : {options.width, options.height}) {
    if (side >= 1 && side <= kMostPixels) continue;
    refuse(std::string("a picture must have 1 to ") + std::to_string(kMostPixels) +
           " pixels along each side, not " + std::to_string(side));
  }
  constexpr int kMostSamples = 65536;
  if (options.samples < 1 || options.samples > kMostSamples) {
    refuse("samples must be from 1 to " + std::to_string(kMostSamples) + ", not " +
           std::to_string(options.samples));
  }
  const PictureView& view = options.view;
  if (!std::isfinite(view.azimuth) || !std::isfinite(view.elevation)) {
    refuse("azimuth and elevation must be finite");
  }
  constexpr double kWidest = 170;
  if (!(view.fieldOfView >= 0 && view.fieldOfView <= kWidest)) {
    refuse("the field of view must be from 0 to " + base::numberText(kWidest) + " degrees, not " +
           base::numberText(view.fieldOfView));
  }
  if (!(view.width >= 0) || !std::isfinite(view.width)) {
    refuse("the width of the view must be 0 or more, and finite");
  }
  if (view.centre && !Vec3(*view.centre).isFinite()) refuse("the centre must be finite");
}

/// What is seen of some points: in the frame's directions.
struct Seen {
  base::Box box = base::Box::empty();
  const base::ViewFrame& frame;
  void add(const Vec3& p) {
    box.add(Vec3(frame.right.dot(p), frame.up.dot(p), frame.toEye.dot(p)));
  }
  [[nodiscard]] Vec3 centre() const {
    const Vec3 middle = box.centre();
    return frame.right * middle[0] + frame.up * middle[1] + frame.toEye * middle[2];
  }
};

}  // namespace

Camera::Camera(const RaySurface& surface, const PictureOptions& options)
    : frame_(base::viewFrame(options.view.azimuth, options.view.elevation, options.view.yUp)),
      halfWidth_(0.5 * options.width),
      halfHeight_(0.5 * options.height) {
  requireUsable(options);
  tangent_ = std::tan(options.view.fieldOfView * std::numbers::pi / 360);
  if (!surface.bounds().isEmpty()) fit(surface, options.view);
}

UnitRay Camera::ray(double x, double y) const {
  const Vec3 offset =
      frame_.right * ((x - halfWidth_) * pixel_) + frame_.up * ((halfHeight_ - y) * pixel_);
  const double infinity = std::numeric_limits<double>::infinity();
  const Vec3 back = frame_.toEye * eyeDistance_;
  if (tangent_ == 0) return {centre_ + offset + back, -frame_.toEye, 0, infinity};
  return {centre_ + back, (offset - back).unitOrX(), 0, infinity};
}

/// The eye of parallel rays lies before all of the surface.
void Camera::placeEye(const RaySurface& surface) {
  if (tangent_ > 0) {
    eyeDistance_ = halfWidth_ * pixel_ / tangent_;
    return;
  }
  const base::Box& box = surface.bounds();
  eyeDistance_ = (centre_ - box.centre()).length() + box.size().length();
}

void Camera::fit(const RaySurface& surface, const PictureView& view) {
  constexpr double kShare = 0.92;
  const base::Box& box = surface.bounds();
  radius_ = box.size().length() / 2;
  // A sphere around the box first; then what some rays find of it.
  const double least = std::max(radius_, std::numeric_limits<double>::min());
  centre_ = view.centre.value_or(Position(box.centre()));
  pixel_ = least / std::min(halfWidth_, halfHeight_) * (1 + tangent_);
  if (view.width > 0) pixel_ = view.width / (2 * halfWidth_);
  placeEye(surface);
  if (view.width > 0 && view.centre) return;

  constexpr int kRays = 64;
  const auto caster = surface.caster();
  Seen seen{.frame = frame_};
  for (int row = 0; row < kRays; ++row) {
    for (int column = 0; column < kRays; ++column) {
      const UnitRay ray =
          this->ray((column + 0.5) * 2 * halfWidth_ / kRays, (row + 0.5) * 2 * halfHeight_ / kRays);
      if (const auto hit = caster->cast(ray)) seen.add(hit->point);
    }
  }
  if (seen.box.isEmpty()) return;
  // Half of the surface between the last ray that met it and the next one may be seen.
  const double between = 2 * std::max(halfWidth_, halfHeight_) / kRays * pixel_;
  if (!view.centre) centre_ = seen.centre();
  if (view.width == 0) {
    Vec3 reach(0.0);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double at = (axis == 0 ? frame_.right : frame_.up).dot(centre_);
      reach[axis] = std::max(seen.box.upper[axis] - at, at - seen.box.lower[axis]) + between / 2;
    }
    // What is nearer than the centre is seen larger.
    const double nearer = (seen.box.upper[2] - frame_.toEye.dot(centre_)) * tangent_;
    pixel_ = std::max((reach[0] + nearer) / halfWidth_,
                      (reach[1] + nearer * halfHeight_ / halfWidth_) / halfHeight_) /
             kShare;
  }
  placeEye(surface);
}

}  // namespace tufa::rays
