#include "checker.h"

namespace tufa::tools {

void requireChecker() {}

std::string checkerHelp(const std::string& help) { return help; }

}  // namespace tufa::tools
