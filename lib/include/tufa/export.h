#pragma once

#if __cplusplus < 202002L
#error "Tufa's headers need C++20: compile with -std=c++20, or link the CMake target Tufa::tufa"
#endif

/// Marks what the shared libraries show. It keeps these names visible in programs that are compiled
/// with hidden ones; what is not in lib/exports.map is hidden when the libraries are linked.
#if defined(__GNUC__)
#define TUFA_API __attribute__((visibility("default")))
#else
#define TUFA_API
#endif
