#pragma once

#if __cplusplus < 202002L
#error "Tufa's headers need C++20: compile with -std=c++20, or link the CMake target Tufa::tufa"
#endif

/// Marks what the shared libraries show; everything else is hidden.
#if defined(__GNUC__)
#define TUFA_API __attribute__((visibility("default")))
#else
#define TUFA_API
#endif
