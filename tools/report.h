#pragma once

#include <tufa/check.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tufa::tools {

/// What check() found, for programs. Lists at most the first 100 components and says so; figures
/// that are not finite become null.
[[nodiscard]] nlohmann::ordered_json toJson(const CheckReport& report);

/// What checkAgainst() measured, for programs.
[[nodiscard]] nlohmann::ordered_json toJson(const DistanceSummary& side);
[[nodiscard]] nlohmann::ordered_json toJson(const DistanceReport& report);

/// The same for people: some lines of text, the verdict last.
[[nodiscard]] std::string describe(const CheckReport& report);
[[nodiscard]] std::string describe(const DistanceReport& report);

}  // namespace tufa::tools
