#pragma once

#include <tufa/picture.h>

#include "base/vec3.h"
#include "base/view_frame.h"
#include "rays/surface.h"

namespace tufa::rays {

/// Gives the rays of a picture.
class Camera {
 public:
  /// Fits what the view leaves open to a surface, by a few thousand rays. Throws
  /// Error(InvalidArgument) for options out of their range.
  Camera(const RaySurface& surface, const PictureOptions& options);

  /// Through a place of the picture, in pixels from its upper left corner.
  [[nodiscard]] UnitRay ray(double x, double y) const;
  [[nodiscard]] const base::ViewFrame& frame() const { return frame_; }
  /// Half the diagonal of what is seen.
  [[nodiscard]] double radius() const { return radius_; }

 private:
  void fit(const RaySurface& surface, const PictureView& view);
  void placeEye(const RaySurface& surface);

  base::ViewFrame frame_;
  Vec3 centre_{0.0};
  double pixel_ = 1;  ///< world units, at the depth of the centre
  double halfWidth_;  ///< of the picture, in pixels
  double halfHeight_;
  double tangent_ = 0;      ///< of half the field of view
  double eyeDistance_ = 1;  ///< from the centre
  double radius_ = 1;
};

}  // namespace tufa::rays
