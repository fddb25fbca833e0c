#pragma once

#include <filesystem>

#include "implicit/fields.h"
#include "implicit/scene_value.h"

namespace tufa::implicit {

/// Balls from the scene, or from a file beside it.
[[nodiscard]] FieldPtr readMetaballs(SceneObject& object, const std::filesystem::path& folder);

[[nodiscard]] FieldPtr readConvolution(SceneObject& object);

}  // namespace tufa::implicit
