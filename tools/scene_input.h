#pragma once

#include <tufa/implicit.h>
#include <optional>
#include <string>

namespace tufa::tools {

/// readScene() of a file or standard input; `bounds` is what `--bounds` says.
[[nodiscard]] implicit::Scene readSceneInput(const std::string& name,
                                             const std::optional<std::string>& bounds);

/// What neither the command line nor a scene says: a hundred voxels along the longest side. 1 for a
/// field that has none.
[[nodiscard]] double voxelSizeFor(const implicit::Field& field);

}  // namespace tufa::tools
