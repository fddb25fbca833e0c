#pragma once

#include <tufa/compare.h>
#include <string>
#include <vector>

namespace tufa::tools {

/// Names of the shapes of `tufa make` whose true surface is known.
[[nodiscard]] std::vector<std::string> namesOfTruths();

/// Has a comparison measure against one of these shapes, and along its creases, if it has some, at
/// points a quarter of a voxel apart.
void setTruth(const std::string& shape, double voxelSize, CompareOptions& options);

}  // namespace tufa::tools
