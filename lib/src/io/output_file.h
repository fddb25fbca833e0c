#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

namespace tufa::io {

/// A file that appears complete or not at all: bytes go to a temporary file in the target's folder,
/// which commit() renames and the destructor removes otherwise. A pipe, a device or a stream is
/// written to directly. All members throw Error(UnwritableFile).
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  /// Writes to a stream that outlives it. What the stream throws passes through.
  explicit OutputFile(std::ostream& stream);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t size);

  /// Moves the place of the next write. Only where seekable().
  void seek(std::uint64_t offset);
  [[nodiscard]] std::uint64_t position() const { return flushed_ + buffer_.size(); }
  [[nodiscard]] bool seekable() const { return !direct_; }

  /// Gives the file its name. Nothing can be written afterwards.
  void commit();

 private:
  OutputFile();  ///< nothing is open yet: what fails from then on is cleaned up
  void openDirect();
  void openTemporary();
  void keepMode() const;
  void flush();
  void writeAll(const char* data, std::size_t size);
  [[noreturn]] void fail(const std::string& what, int errorNumber) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::vector<char> buffer_;
  std::uint64_t flushed_ = 0;
  int descriptor_ = -1;
  std::ostream* stream_ = nullptr;  ///< in place of a descriptor
  bool direct_ = false;             ///< the target is a pipe, a device or a stream
};

/// Throws Error(UnwritableFile) if it is certain already that OutputFile could not write there.
void requireWritablePath(const std::filesystem::path& path);

/// Lets an std::ostream write to an OutputFile. Errors pass through as Error where the stream's
/// exception mask holds badbit.
class OutputFileBuffer final : public std::streambuf {
 public:
  explicit OutputFileBuffer(OutputFile& file) : file_(file) {}

 protected:
  int_type overflow(int_type character) override;
  std::streamsize xsputn(const char* data, std::streamsize size) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                   std::ios_base::openmode mode) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override;

 private:
  OutputFile& file_;
};

}  // namespace tufa::io
