#pragma once

#include <string>

namespace tufa::tools {

// Tufa::check, which needs CGAL, can be left out of the command: with_check.cpp and
// without_check.cpp are the two ways to build it.

/// Throws Error(InvalidArgument) if the command was built without the checker: before the work that
/// its report would be of.
void requireChecker();

/// The help text of a command or an option that needs the checker; says so if there is none.
[[nodiscard]] std::string checkerHelp(const std::string& help);

}  // namespace tufa::tools
