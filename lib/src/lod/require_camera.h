#pragma once

#include <tufa/lod.h>

namespace tufa::lod {

/// Throws Error(InvalidArgument) for a camera or a number of pixels that cannot be.
void requireCamera(const Camera& camera, double pixelError);

}  // namespace tufa::lod
