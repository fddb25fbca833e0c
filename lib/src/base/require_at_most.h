#pragma once

#include <tufa/error.h>

#include <cstdint>
#include <string>

namespace tufa::base {

/// Throws Error(LimitExceeded) that names the format, what there is too much of, and the limit.
inline void requireAtMost(std::uint64_t limit, std::uint64_t count, const char* what,
                          const char* format) {
  if (count <= limit) return;
  throw Error(ErrorCode::LimitExceeded, std::to_string(count) + " " + what + " are more than the " +
                                            std::to_string(limit) + " that " + format +
                                            " can hold");
}

}  // namespace tufa::base
