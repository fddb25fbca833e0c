#pragma once

#include <tufa/error.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tufa::tools {

/// The exit code for an error.
[[nodiscard]] int exitCodeOf(const Error& error);

/// What an error says, with options of the command where the library names its own.
[[nodiscard]] std::string messageOf(const Error& error);

/// The name of an error's code, for programs.
[[nodiscard]] std::string nameOf(ErrorCode code);

/// An error as programs see it: {"code": ..., "message": ...}.
[[nodiscard]] nlohmann::ordered_json errorToJson(const std::string& code,
                                                 const std::string& message);

}  // namespace tufa::tools
