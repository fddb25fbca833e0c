#pragma once

namespace tufa::refine {

/// The farthest that the rounding of world positions to single precision may move them, in voxels.
inline constexpr double kMostRounding = 5e-4;

}  // namespace tufa::refine
