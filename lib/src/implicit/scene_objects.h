#pragma once

#include <cstddef>
#include <filesystem>

#include "implicit/fields.h"
#include "implicit/scene_value.h"

namespace tufa::implicit {

/// A field read from a scene, how many fields it is made of, and how deep they lie in it.
struct ReadField {
  FieldPtr field;
  std::size_t nodes = 1;
  std::size_t depth = 0;
};

/// Reads the objects of a scene that have no objects in them, by the name of their type. Null if
/// there is none of that name. Files that they name are sought in `folder`.
[[nodiscard]] FieldPtr readPrimitive(const std::string& type, SceneObject& object,
                                     const std::filesystem::path& folder);

/// The names of these types, with commas between them.
[[nodiscard]] std::string primitiveNames();

}  // namespace tufa::implicit
