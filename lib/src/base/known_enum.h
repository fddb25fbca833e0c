#pragma once

#include <tufa/error.h>

#include <string>

namespace tufa::base {

/// Throws Error(InvalidArgument) unless the value is one of an enum's, which count from 0 to
/// `last`: a caller may have made any number into one.
template <class Enum>
void requireKnown(Enum value, Enum last, const char* what) {
  const auto number = static_cast<long long>(value);
  if (number >= 0 && number <= static_cast<long long>(last)) return;
  throw Error(ErrorCode::InvalidArgument,
              std::string(what) + " has no meaning: " + std::to_string(number));
}

}  // namespace tufa::base
