#include "frames.h"

#include <tufa/error.h>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <regex>
#include <string_view>
#include <system_error>

#include "number.h"

namespace tufa::tools {
namespace {

constexpr int kMostFrames = 1000000;

/// Where the last part of a name has its first run of #.
struct Place {
  std::size_t begin = std::string::npos;
  std::size_t length = 0;
};

Place placeIn(const std::string& file) {
  Place place;
  place.begin = file.find('#');
  if (place.begin == std::string::npos) return place;
  place.length = std::min(file.find_first_not_of('#', place.begin), file.size()) - place.begin;
  return place;
}

[[noreturn]] void refuse(std::string_view part) {
  throw Error(
      ErrorCode::InvalidArgument,
      "--frames takes numbers and ranges such as 1-240, -10-240 or 1-240x2, with commas between, "
      "not \"" +
          std::string(part) + "\"");
}

int readNumber(std::string_view text, std::string_view part) {
  const auto number = numberIn<int>(text);
  if (!number) refuse(part);
  return *number;
}

void addRange(std::string_view part, std::vector<int>& frames) {
  const std::size_t dash = part.find('-', 1);  // behind a sign
  if (dash == std::string_view::npos) {
    frames.push_back(readNumber(part, part));
    return;
  }
  const std::size_t times = part.find('x', dash);
  const int first = readNumber(part.substr(0, dash), part);
  const int last = readNumber(part.substr(dash + 1, times - std::min(times, dash + 1)), part);
  const int step = times == std::string_view::npos ? 1 : readNumber(part.substr(times + 1), part);
  if (step < 1 || last < first) refuse(part);
  if ((static_cast<long long>(last) - first) / step >= kMostFrames) {
    throw Error(ErrorCode::InvalidArgument,
                "--frames " + std::string(part) + " has more than a million frames");
  }
  for (long long frame = first; frame <= last; frame += step) {
    frames.push_back(static_cast<int>(frame));
  }
}

/// Calls visit(number, digits, isMeant) for the files that have digits in the place of #, or a sign
/// and digits: a number with other zeros in front than the name asks for is not meant.
template <class Visit>
void forFrames(const std::string& name, const Visit& visit) {
  const std::filesystem::path path = name;
  const std::string file = path.filename().string();
  const Place place = placeIn(file);
  const std::string before = file.substr(0, place.begin);
  const std::string after = file.substr(place.begin + place.length);
  std::error_code error;
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string found = entry.path().filename().string();
    if (found.size() <= before.size() + after.size()) continue;
    if (!found.starts_with(before) || !found.ends_with(after)) continue;
    const auto digits =
        std::string_view(found).substr(before.size(), found.size() - before.size() - after.size());
    const auto number = numberIn<int>(digits);
    if (!number) continue;
    visit(*number, digits, frameFile(name, *number) == (path.parent_path() / found));
  }
}

void sortOnce(std::vector<int>& frames) {
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
}

}  // namespace

bool namesFrames(const std::string& name) {
  return placeIn(std::filesystem::path(name).filename().string()).length > 0;
}

std::string framesInAnotherWay(const std::string& name) {
  static const std::regex place("%(0?)([1-9]?)d|\\$F([1-9]?)");
  std::smatch found;
  if (!std::regex_search(name, found, place)) return "";
  const std::string digits = found[2].str() + found[3].str();
  const std::size_t count = digits.empty() ? 1 : static_cast<std::size_t>(digits[0] - '0');
  return found.prefix().str() + std::string(count, '#') + found.suffix().str();
}

std::string frameFile(const std::string& name, int frame) {
  const std::filesystem::path path = name;
  std::string file = path.filename().string();
  const Place place = placeIn(file);
  std::string digits = std::to_string(frame);
  const std::size_t sign = frame < 0 ? 1 : 0;  // as of printf's %04d
  if (digits.size() < place.length) digits.insert(sign, place.length - digits.size(), '0');
  file.replace(place.begin, place.length, digits);
  return (path.parent_path() / file).string();
}

void requireOnePlace(const std::string& name) {
  const std::string file = std::filesystem::path(name).filename().string();
  const Place place = placeIn(file);
  if (place.length == 0 || file.find('#', place.begin + place.length) == std::string::npos) return;
  throw Error(ErrorCode::InvalidArgument,
              name + " has # in several places, and a frame's number goes to one");
}

std::vector<int> readFrames(const std::string& text) {
  std::vector<int> frames;
  for (std::string_view rest = text; true;) {
    const std::size_t comma = rest.find(',');
    addRange(rest.substr(0, comma), frames);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  sortOnce(frames);
  return frames;
}

std::vector<int> findFrames(const std::string& name) {
  std::vector<int> frames;
  forFrames(name, [&](int number, std::string_view /*digits*/, bool isMeant) {
    if (isMeant) frames.push_back(number);
  });
  sortOnce(frames);
  return frames;
}

std::string withDigitsOfFiles(const std::string& name) {
  std::size_t digits = 0;
  forFrames(name, [&](int number, std::string_view text, bool isMeant) {
    if (!isMeant && number >= 0 && (digits == 0 || text.size() < digits)) digits = text.size();
  });
  if (digits == 0) return "";
  const std::filesystem::path path = name;
  std::string file = path.filename().string();
  const Place place = placeIn(file);
  file.replace(place.begin, place.length, digits, '#');
  return (path.parent_path() / file).string();
}

}  // namespace tufa::tools
