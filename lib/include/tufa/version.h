#pragma once

namespace tufa {

/// The version of the library that the program runs with, as "major.minor.patch".
[[nodiscard]] const char* version() noexcept;

}  // namespace tufa
