#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "io/input_bytes.h"

namespace tufa::io {

/// The bytes of a buffer view that EXT_meshopt_compression packed: `description` is the extension's
/// object, `packed` what it names. Throws as input.fail() if they do not fit each other.
[[nodiscard]] std::string unpackView(const nlohmann::json& description, std::string_view packed,
                                     const InputBytes& input);

}  // namespace tufa::io
