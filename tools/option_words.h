#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace tufa::tools {

// What manual pages and completions know of the command's options.

/// The options of a subcommand, either those by name or those by place.
[[nodiscard]] inline std::vector<const CLI::Option*> optionsOf(const CLI::App& app,
                                                               bool positional) {
  return app.get_options(
      [positional](const CLI::Option* option) { return option->get_positional() == positional; });
}

[[nodiscard]] inline std::vector<const CLI::App*> subcommandsOf(const CLI::App& app) {
  return app.get_subcommands({});
}

/// The values that an option takes, where they are a list; CLI11 tells it as TEXT:{a,b}.
[[nodiscard]] inline std::vector<std::string> choicesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{');
  const auto close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// Whether a value stands behind an option.
[[nodiscard]] inline bool takesValue(const CLI::Option& option) {
  return option.get_expected_max() != 0;
}

}  // namespace tufa::tools
