#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "io/input_bytes.h"

namespace tufa::io {

/// Throws Error(UnreadableFile) if objects and arrays of a JSON text lie more than 100 deep in each
/// other: documents are copied and freed by functions that call themselves, once for each level.
void requireShallowJson(std::string_view text, const InputBytes& input);

/// Throws Error(UnreadableFile) for a text that is no JSON, by what nlohmann::json says of it.
[[noreturn]] void failAsNoJson(std::string_view message, const InputBytes& input);

/// Parses a text that is a file, or part of one. Throws Error(UnreadableFile) if it is too deep, or
/// no JSON.
template <class Json>
Json parseJson(std::string_view text, const InputBytes& input) {
  requireShallowJson(text, input);
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    failAsNoJson(error.what(), input);
  }
}

/// A count or an index: a whole number from 0 up, which a JSON text may write as 3 or 3.0. Converts
/// nothing that has no such value; throws Error(UnreadableFile).
template <class Json>
std::size_t countIn(const Json& json, const InputBytes& input) {
  constexpr double kMostExact = 9007199254740992.0;  // 2^53
  if (json.is_number_unsigned()) return json.template get<std::size_t>();
  if (json.is_number_float()) {
    const auto number = json.template get<double>();
    if (number >= 0 && number <= kMostExact && number == std::floor(number)) {
      return static_cast<std::size_t>(number);
    }
  }
  input.fail("its JSON has " + (json.is_number() ? json.dump() : std::string(json.type_name())) +
             " where a whole number from 0 up is due");
}

/// The count of that name in an object, or `otherwise` if there is none.
template <class Json>
std::size_t countAt(const Json& object, const char* name, std::size_t otherwise,
                    const InputBytes& input) {
  return object.contains(name) ? countIn(object.at(name), input) : otherwise;
}

/// The array of that name in an object, as it lies there; an empty one if there is none. Throws
/// Error(UnreadableFile) if it is no array.
template <class Json>
const Json& arrayAt(const Json& object, const char* name, const InputBytes& input) {
  static const Json kNone = Json::array();
  if (!object.is_object() || !object.contains(name)) return kNone;
  const Json& array = object.at(name);
  if (!array.is_array()) input.fail("\"" + std::string(name) + "\" in its JSON is no array");
  return array;
}

}  // namespace tufa::io
