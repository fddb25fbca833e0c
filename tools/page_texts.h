#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tufa::tools {

/// What a manual page says beside the options.
struct PageText {
  std::string description;
  std::vector<std::pair<std::string, std::string>> examples;  ///< commands, and what they do
};

/// Of a subcommand. Throws std::out_of_range for one without a text.
[[nodiscard]] const PageText& pageText(const std::string& subcommand);

}  // namespace tufa::tools
