#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace tufa::tools {

/// Has the help of an application and of the subcommands it gets from then on name flags as they
/// are typed, where CLI11 puts "{false}" behind those that switch something off.
void nameFlagsAsTyped(CLI::App& app);

/// What is wrong with a command line, in one line that ends with the help to look at. `words` are
/// its arguments.
[[nodiscard]] std::string describeMisuse(const CLI::App& app, const CLI::ParseError& error,
                                         const std::vector<std::string>& words);

/// The help text of a subcommand, or of the whole command for an empty name. Throws
/// Error(InvalidArgument) if there is none of that name.
[[nodiscard]] std::string helpOf(const CLI::App& app, const std::string& subcommand);

}  // namespace tufa::tools
