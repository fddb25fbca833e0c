#include "fuzz/mutate/mutations.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace tufa::fuzz {
namespace {

constexpr std::size_t kLongestStretch = 4096;
constexpr std::size_t kLargestFile = std::size_t{1} << 20;

/// Where sizes, counts and indices go wrong.
constexpr std::array<std::uint64_t, 18> kNumbers{0,
                                                 1,
                                                 2,
                                                 0x7F,
                                                 0x80,
                                                 0xFF,
                                                 0x7FFF,
                                                 0x8000,
                                                 0xFFFF,
                                                 0x7FFFFFFF,
                                                 0x80000000,
                                                 0xFFFFFFFF,
                                                 0x7F800000,  // infinity as float
                                                 0x7FC00000,  // NaN as float
                                                 0x7FFFFFFFFFFFFFFF,
                                                 0x8000000000000000,
                                                 0x7FF0000000000000,  // infinity as double
                                                 0xFFFFFFFFFFFFFFFF};

constexpr std::array<const char*, 14> kWords{"0",    "-1",  "1e300",      "-1e300",     "nan",
                                             "inf",  "1e9", "4294967295", "2147483648", "0.5",
                                             "null", "[[",  "{\"a\":",    "\"\\u0000\""};

}  // namespace

std::string Mutations::mutated(std::string bytes, const std::string& other) {
  // Mostly one: what is damaged twice is seldom read far.
  const std::size_t count = below(3) != 0 ? 1 : 2 + below(3);
  for (std::size_t n = 0; n < count; ++n) {
    if (bytes.empty()) bytes = other.substr(0, 1);
    mutate(bytes, other);
  }
  if (bytes.size() > kLargestFile) bytes.resize(kLargestFile);
  return bytes;
}

void Mutations::mutate(std::string& bytes, const std::string& other) {
  switch (below(10)) {
    case 0:
    case 1:
      return flipBit(bytes);
    case 2:
      return setByte(bytes);
    case 3:
      return setNumber(bytes);
    case 4:
      return changeNumberInText(bytes);
    case 5:
      return cut(bytes);
    case 6:
      return erase(bytes);
    case 7:
      return repeat(bytes);
    case 8:
      return splice(bytes, other);
    default:
      return insertText(bytes);
  }
}

std::size_t Mutations::placeIn(const std::string& bytes) {
  constexpr std::size_t kFront = 1024;
  return below(below(2) == 0 ? std::min(kFront, bytes.size()) : bytes.size());
}

void Mutations::flipBit(std::string& bytes) {
  bytes[placeIn(bytes)] ^= static_cast<char>(1U << below(8));
}

void Mutations::setByte(std::string& bytes) {
  bytes[placeIn(bytes)] = static_cast<char>(below(256));
}

void Mutations::setNumber(std::string& bytes) {
  const std::uint64_t number = kNumbers[below(kNumbers.size())];
  const std::size_t size = std::size_t{1} << below(4);
  const std::size_t place = placeIn(bytes);
  std::memcpy(bytes.data() + place, &number, std::min(size, bytes.size() - place));
}

void Mutations::changeNumberInText(std::string& bytes) {
  const auto isDigit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto begin = std::find_if(bytes.begin() + static_cast<std::ptrdiff_t>(placeIn(bytes)),
                                  bytes.end(), isDigit);
  const auto end = std::find_if_not(begin, bytes.end(), isDigit);
  if (begin != end) bytes.replace(begin, end, kWords[below(kWords.size())]);
}

void Mutations::cut(std::string& bytes) { bytes.resize(below(bytes.size()) + 1); }

void Mutations::erase(std::string& bytes) {
  bytes.erase(placeIn(bytes), 1 + below(std::size_t{1} << below(12)));
}

void Mutations::repeat(std::string& bytes) {
  const std::size_t place = placeIn(bytes);
  const std::string piece = bytes.substr(place, 1 + below(kLongestStretch));
  bytes.insert(place, piece);
}

void Mutations::splice(std::string& bytes, const std::string& other) {
  if (other.empty()) return;
  const std::string piece = other.substr(below(other.size()), 1 + below(kLongestStretch));
  const std::size_t place = placeIn(bytes);
  if (below(2) == 0) {
    bytes.insert(place, piece);
  } else {
    bytes.replace(place, piece.size(), piece);
  }
}

void Mutations::insertText(std::string& bytes) {
  bytes.insert(placeIn(bytes), kWords[below(kWords.size())]);
}

}  // namespace tufa::fuzz
