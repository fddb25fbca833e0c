#pragma once

#include <tufa/export.h>

namespace tufa {

/// The version of the library that the program runs with, as "major.minor.patch".
[[nodiscard]] TUFA_API const char* version() noexcept;

}  // namespace tufa
