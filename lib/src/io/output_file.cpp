#include "io/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace tufa::io {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

[[noreturn]] void throwUnwritable(const std::filesystem::path& path, const std::string& what,
                                  int errorNumber) {
  const std::string cause = errorNumber != 0 ? std::string(": ") + std::strerror(errorNumber) : "";
  throw Error(ErrorCode::UnwritableFile, "cannot write " + path.string() + ": " + what + cause);
}

/// The file that a path leads to, so that a symbolic link survives the renaming.
std::filesystem::path resolve(const std::filesystem::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return path;
  std::error_code error;
  const auto resolved = std::filesystem::weakly_canonical(path, error);
  return error ? path : resolved;
}

std::filesystem::path folderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// Whether the path names something that bytes are sent to rather than kept in.
bool isPipeOrDevice(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return false;
  return S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode) ||
         S_ISSOCK(status.st_mode);
}

}  // namespace

void requireWritablePath(const std::filesystem::path& path) {
  if (path.empty()) throwUnwritable(path, "the name is empty", 0);
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throwUnwritable(path, "it is a folder", 0);
    if (::access(path.c_str(), W_OK) != 0) throwUnwritable(path, "it may not be replaced", errno);
    if (!S_ISREG(status.st_mode)) return;
  } else if (::lstat(path.c_str(), &status) == 0 && S_ISLNK(status.st_mode)) {
    throwUnwritable(path, "it is a link that leads nowhere", 0);
  }
  const auto folder = folderOf(resolve(path));
  if (::stat(folder.c_str(), &status) != 0) {
    throwUnwritable(path, "no folder " + folder.string(), errno);
  }
  if (!S_ISDIR(status.st_mode)) throwUnwritable(path, folder.string() + " is not a folder", 0);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throwUnwritable(path, "no file can be made in " + folder.string(), errno);
  }
}

OutputFile::OutputFile() { buffer_.reserve(kBufferBytes); }

OutputFile::OutputFile(const std::filesystem::path& path) : OutputFile() {
  target_ = path;
  requireWritablePath(path);
  if (isPipeOrDevice(path)) {
    openDirect();
  } else {
    openTemporary();
    keepMode();
  }
}

OutputFile::OutputFile(std::ostream& stream) : OutputFile() {
  target_ = "the stream";
  stream_ = &stream;
  direct_ = true;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::openDirect() {
  direct_ = true;
  descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail("cannot open it", errno);
}

void OutputFile::openTemporary() {
  static std::atomic<unsigned> counter{0};
  target_ = resolve(target_);
  const std::string stem = ".tufa-" + std::to_string(::getpid()) + "-";
  constexpr int kAttempts = 1000;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto candidate = folderOf(target_) / (stem + std::to_string(counter++) + ".tmp");
    // O_EXCL: never write into a file that someone else made under that name.
    descriptor_ = ::open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) {
      temporary_ = candidate;
      return;
    }
    if (errno != EEXIST) break;
  }
  fail("no file can be made in " + folderOf(target_).string(), errno);
}

/// A file that is replaced stays as closed, or open, to others as it was.
void OutputFile::keepMode() const {
  struct stat status {};
  if (::stat(target_.c_str(), &status) != 0) return;
  constexpr mode_t kPermissions = 0777;
  if (::fchmod(descriptor_, status.st_mode & kPermissions) != 0) {
    fail("the file cannot be given the mode of the one that it replaces", errno);
  }
}

void OutputFile::fail(const std::string& what, int errorNumber) const {
  throwUnwritable(target_, what, errorNumber);
}

void OutputFile::writeAll(const char* data, std::size_t size) {
  if (stream_ != nullptr) {
    if (!stream_->write(data, static_cast<std::streamsize>(size))) fail("writing failed", 0);
    flushed_ += size;
    return;
  }
  while (size > 0) {
    const ssize_t written = ::write(descriptor_, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("writing failed", written < 0 ? errno : ENOSPC);
    data += written;
    size -= static_cast<std::size_t>(written);
    flushed_ += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::flush() {
  writeAll(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void OutputFile::write(const void* data, std::size_t size) {
  const char* const bytes = static_cast<const char*>(data);
  if (buffer_.size() + size > kBufferBytes) {
    flush();
    if (size >= kBufferBytes) {
      writeAll(bytes, size);
      return;
    }
  }
  buffer_.insert(buffer_.end(), bytes, bytes + size);
}

void OutputFile::seek(std::uint64_t offset) {
  flush();
  if (::lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) < 0) fail("seeking failed", errno);
  flushed_ = offset;
}

void OutputFile::commit() {
  flush();
  if (stream_ != nullptr) {
    if (!stream_->flush()) fail("writing failed", 0);
    return;
  }
  const int descriptor = descriptor_;
  descriptor_ = -1;
  // Some file systems report a full disk only here.
  if (::close(descriptor) != 0) fail("closing failed", errno);
  if (direct_) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("renaming failed", errno);
  temporary_.clear();
}

OutputFileBuffer::int_type OutputFileBuffer::overflow(int_type character) {
  if (!traits_type::eq_int_type(character, traits_type::eof())) {
    const char byte = traits_type::to_char_type(character);
    file_.write(&byte, 1);
  }
  return traits_type::not_eof(character);
}

std::streamsize OutputFileBuffer::xsputn(const char* data, std::streamsize size) {
  file_.write(data, static_cast<std::size_t>(size));
  return size;
}

OutputFileBuffer::pos_type OutputFileBuffer::seekoff(off_type offset,
                                                     std::ios_base::seekdir direction,
                                                     std::ios_base::openmode /*mode*/) {
  const off_type position = static_cast<off_type>(file_.position());
  if (direction == std::ios_base::cur && offset == 0) return position;  // tellp(), also on pipes
  if (!file_.seekable() || direction == std::ios_base::end) return pos_type(off_type(-1));
  const off_type target = direction == std::ios_base::cur ? position + offset : offset;
  file_.seek(static_cast<std::uint64_t>(target));
  return target;
}

OutputFileBuffer::pos_type OutputFileBuffer::seekpos(pos_type position,
                                                     std::ios_base::openmode mode) {
  return seekoff(position, std::ios_base::beg, mode);
}

}  // namespace tufa::io

namespace tufa {

void writeFile(std::string_view bytes, const std::filesystem::path& path) {
  io::OutputFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

void writeFile(const std::function<void(std::ostream&)>& writeTo,
               const std::filesystem::path& path) {
  if (!writeTo) throw Error(ErrorCode::InvalidArgument, "there is nothing that writes the file");
  io::OutputFile file(path);
  io::OutputFileBuffer buffer(file);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios::badbit);
  writeTo(stream);
  // As after a seek that the file does not know: what came then was not written.
  if (!stream) {
    throw Error(ErrorCode::UnwritableFile,
                "cannot write " + path.string() + ": something failed on the stream");
  }
  file.commit();
}

}  // namespace tufa
