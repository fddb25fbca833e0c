#include "io/input_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tufa/error.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

namespace tufa::io {
namespace {

/// Closes a file descriptor at the end of its scope.
struct Descriptor {
  int number;
  explicit Descriptor(int opened) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

constexpr std::string_view kBlanks = " \t\r\v\f";

/// A word as it may be shown in a message: short, and printable.
std::string shown(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text(word.substr(0, kLongest));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "\"" + text + (word.size() > kLongest ? "...\"" : "\"");
}

std::string_view withoutPlus(std::string_view word) {
  return word.size() > 1 && word.front() == '+' ? word.substr(1) : word;
}

}  // namespace

bool fitsMemory(std::uint64_t bytes) {
  return bytes < static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                     static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

InputBytes::InputBytes(const std::filesystem::path& path) : path_(path) {
  // O_NONBLOCK: a pipe without a writer is refused, not waited for.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.number < 0) fail(std::strerror(errno));
  struct stat status {};
  if (::fstat(file.number, &status) != 0) fail(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) fail("it is a folder");
  if (!S_ISREG(status.st_mode)) fail("it is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) fail("the file is empty");
  if (fitsMemory(size)) bytes_.reset(new (std::nothrow) char[size]);
  if (!bytes_) fail("its " + std::to_string(size) + " bytes do not fit into memory");
  for (std::size_t done = 0; done < size;) {
    const ssize_t count = ::read(file.number, bytes_.get() + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(std::strerror(errno));
    if (count == 0) fail("the file became shorter while it was read");
    done += static_cast<std::size_t>(count);
  }
  view_ = {bytes_.get(), size};
}

InputBytes::InputBytes(const FileBytes& file) : path_(file.name), view_(file.bytes) {
  if (view_.empty()) fail("the file is empty");
}

void InputBytes::fail(const std::string& cause) const {
  throw Error(ErrorCode::UnreadableFile, "cannot read " + path_.string() + ": " + cause);
}

void InputBytes::failAtByte(std::size_t offset, const std::string& cause) const {
  fail("byte " + std::to_string(offset) + ": " + cause);
}

void InputBytes::failAtLine(std::size_t line, const std::string& cause) const {
  fail("line " + std::to_string(line) + ": " + cause);
}

std::string_view withoutMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

TextCursor::TextCursor(const InputBytes& input, std::size_t offset, std::size_t firstLine)
    : input_(input),
      rest_(offset == 0 ? withoutMark(input.view()) : input.view().substr(offset)),
      lineEnd_(rest_.find('\n') == std::string_view::npos ? '\r' : '\n'),
      nextLine_(firstLine),
      line_(firstLine) {}

bool TextCursor::nextLine(bool continued) {
  if (rest_.empty()) {
    words_ = {};
    return false;
  }
  line_ = nextLine_;
  joined_.clear();
  const std::size_t start = rest_.find_first_not_of(kBlanks);
  if (start != std::string_view::npos && rest_[start] == '#') continued = false;
  while (true) {
    const std::size_t length = std::min(rest_.find(lineEnd_), rest_.size());
    std::string_view line = rest_.substr(0, length);
    rest_.remove_prefix(std::min(length + 1, rest_.size()));
    ++nextLine_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (continued && !line.empty() && line.back() == '\\' && !rest_.empty()) {
      line.remove_suffix(1);
      joined_.append(line).append(" ");
      continue;
    }
    if (joined_.empty()) {
      words_ = line;
    } else {
      joined_.append(line);
      words_ = joined_;
    }
    return true;
  }
}

bool TextCursor::nextContentLine() {
  while (nextLine()) {
    words_ = words_.substr(0, words_.find('#'));
    if (words_.find_first_not_of(kBlanks) != std::string_view::npos) return true;
  }
  return false;
}

std::string_view TextCursor::nextWord() {
  const std::size_t start = words_.find_first_not_of(kBlanks);
  if (start == std::string_view::npos) {
    words_ = {};
    return {};
  }
  words_.remove_prefix(start);
  const std::string_view word = words_.substr(0, words_.find_first_of(kBlanks));
  words_.remove_prefix(word.size());
  return word;
}

std::string_view TextCursor::nextWordAnywhere() {
  while (true) {
    const std::string_view word = nextWord();
    if (!word.empty()) return word;
    if (!nextLine()) fail("the file ends too early");
  }
}

double TextCursor::parseNumber(std::string_view word) const {
  if (word.empty()) fail("a number is missing");
  const std::string_view digits = withoutPlus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) {
    value = std::strtod(std::string(digits).c_str(), nullptr);  // tells 0 from infinity
  } else if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(shown(word) + " is not a number");
  }
  if (!std::isfinite(value)) fail(shown(word) + " is not finite");
  return value;
}

std::int64_t TextCursor::parseInteger(std::string_view word) const {
  if (word.empty()) fail("an integer is missing");
  const std::string_view digits = withoutPlus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(shown(word) + " is not an integer");
  }
  return value;
}

double TextCursor::nextNumber() { return parseNumber(nextWord()); }

std::int64_t TextCursor::nextInteger() { return parseInteger(nextWord()); }

bool sameWord(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace tufa::io
