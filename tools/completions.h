#pragma once

#include <iosfwd>

namespace CLI {
class App;
}

namespace tufa::tools {

// Completions of the command for shells: names of subcommands and options, values where they are a
// list, and files.

void writeBashCompletion(std::ostream& out, const CLI::App& app);
void writeZshCompletion(std::ostream& out, const CLI::App& app);
void writeFishCompletion(std::ostream& out, const CLI::App& app);

}  // namespace tufa::tools
