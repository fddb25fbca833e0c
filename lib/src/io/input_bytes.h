#pragma once

#include <tufa/memory.h>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace tufa::io {

/// Whether so many bytes are less than the machine's memory. A sparse file may claim any size, and
/// the system may promise any.
[[nodiscard]] bool fitsMemory(std::uint64_t bytes);

/// A whole file in memory.
class InputBytes {
 public:
  /// Throws Error(UnreadableFile) for all but regular files that can be read.
  explicit InputBytes(const std::filesystem::path& path);
  /// Of bytes that outlive it. Throws Error(UnreadableFile) if there are none.
  explicit InputBytes(const FileBytes& file);

  [[nodiscard]] std::string_view view() const { return view_; }
  [[nodiscard]] std::size_t size() const { return view_.size(); }

  /// The file's name.
  [[nodiscard]] std::string name() const { return path_.string(); }

  /// Throws Error(UnreadableFile) that names the file and the cause.
  [[noreturn]] void fail(const std::string& cause) const;
  [[noreturn]] void failAtByte(std::size_t offset, const std::string& cause) const;
  [[noreturn]] void failAtLine(std::size_t line, const std::string& cause) const;

 private:
  std::filesystem::path path_;
  std::unique_ptr<char[]> bytes_;  ///< of a file
  std::string_view view_;
};

/// A text without the mark that says that it is UTF-8.
[[nodiscard]] std::string_view withoutMark(std::string_view text);

/// Reads text line by line and word by word, and knows the number of the line.
class TextCursor {
 public:
  /// Lines end in \n or \r\n, or in \r where the text has no \n.
  TextCursor(const InputBytes& input, std::size_t offset, std::size_t firstLine);

  /// Moves to the next line; false at the end of the file. `continued` joins lines that end in a
  /// backslash with the ones below, but comments.
  bool nextLine(bool continued = false);

  /// Moves to the next line that has words before any '#'.
  bool nextContentLine();

  /// The next word of the line, empty at its end.
  std::string_view nextWord();

  /// The next word of this line or, if it has no more, of the lines below; fails at the end of
  /// file.
  std::string_view nextWordAnywhere();

  /// Words as numbers. Fail where there is none, and numbers that are not finite.
  double parseNumber(std::string_view word) const;
  std::int64_t parseInteger(std::string_view word) const;
  double nextNumber();
  std::int64_t nextInteger();

  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::size_t bytesLeft() const { return rest_.size() + words_.size(); }
  [[noreturn]] void fail(const std::string& cause) const { input_.failAtLine(line_, cause); }

 private:
  const InputBytes& input_;
  std::string_view rest_;  ///< below the current line
  char lineEnd_;
  std::string_view words_;  ///< of the current line, not read yet
  std::string joined_;      ///< holds a line that was continued
  std::size_t nextLine_;
  std::size_t line_;
};

/// Whether two words are equal up to the case of ASCII letters.
[[nodiscard]] bool sameWord(std::string_view a, std::string_view b);

}  // namespace tufa::io
