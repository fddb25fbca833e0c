#pragma once

namespace tufa::uniform {

/// Voxels by which a vertex may leave its cell onto an acute edge: cells hold crossings of both its
/// sheets still where these are a voxel apart.
inline constexpr double kFarthestAcute = 2.0;

/// Whether two sheets make an acute edge, of 34 to 72 degrees. `cosine`: of the angle between their
/// outward normals. Sharper edges would count as folds.
constexpr bool isAcute(double cosine) { return cosine < -0.3 && cosine > -0.83; }

}  // namespace tufa::uniform
