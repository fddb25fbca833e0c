#include "lod/require_camera.h"

#include <tufa/error.h>
#include <cmath>
#include <numbers>
#include <string>

#include "base/number_text.h"
#include "base/vec3.h"

namespace tufa::lod {

void requireCamera(const Camera& camera, double pixelError) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::InvalidArgument, what);
  };
  if (!Vec3(camera.eye).isFinite()) refuse("the camera's eye must be at a finite place");
  if (!(camera.verticalAngle > 0 && camera.verticalAngle < std::numbers::pi)) {
    refuse("the camera's angle of view must be above 0 and below pi, not " +
           base::numberText(camera.verticalAngle));
  }
  if (camera.screenHeight < 1) {
    refuse("the screen must have a height of a pixel or more, not " +
           std::to_string(camera.screenHeight));
  }
  if (!(pixelError > 0) || !std::isfinite(pixelError)) {
    refuse("the error in pixels must be above 0 and finite, not " + base::numberText(pixelError));
  }
}

}  // namespace tufa::lod
