#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tufa::base {

inline constexpr std::string_view kBraces = "{}";

/// Whether a file name, not its folder, has a place for a text.
[[nodiscard]] inline bool hasBraces(const std::filesystem::path& path) {
  return path.filename().string().find(kBraces) != std::string::npos;
}

/// The path with the text in the place of all braces of its file name. Braces in the text stay.
[[nodiscard]] inline std::filesystem::path fillBraces(const std::filesystem::path& path,
                                                      std::string_view text) {
  std::string name = path.filename().string();
  for (std::size_t at = name.find(kBraces); at != std::string::npos;
       at = name.find(kBraces, at + text.size())) {
    name.replace(at, kBraces.size(), text);
  }
  return path.parent_path() / name;
}

}  // namespace tufa::base
