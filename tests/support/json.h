#pragma once

#include <nlohmann/json.hpp>
#include <string>

// Compiled in one source file alone: every file that reads JSON would take seconds for it.
extern template class nlohmann::basic_json<>;

namespace tufa::test {

/// What a text says. Throws as nlohmann::json::parse() does.
[[nodiscard]] nlohmann::json parseJson(const std::string& text);

}  // namespace tufa::test
