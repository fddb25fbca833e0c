#include "standard_streams.h"

#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <tufa/error.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <ios>
#include <streambuf>
#include <vector>

#include "console.h"
#include "paths.h"

namespace tufa::tools {
namespace {

constexpr const char* kInput = "standard input";

[[noreturn]] void failToRead(const std::string& cause) {
  throw Error(ErrorCode::UnreadableFile, std::string("cannot read ") + kInput + ": " + cause);
}

/// Waits until there is something to read, or its end. Ctrl-C ends the wait.
void awaitInput() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  constexpr int kMilliseconds = 200;
  int ready = 0;
  while (ready == 0 || (ready < 0 && errno == EINTR)) {
    stopIfAsked();
    ready = ::poll(&input, 1, kMilliseconds);
  }
}

std::string readAll() {
  if (::isatty(STDIN_FILENO) == 1) failToRead("it is a terminal; give it a file or a pipe");
  constexpr std::size_t kChunk = std::size_t{1} << 20;
  std::string bytes;
  std::vector<char> chunk(kChunk);
  while (true) {
    awaitInput();
    const ssize_t count = ::read(STDIN_FILENO, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failToRead(std::strerror(errno));
    if (count == 0) return bytes;
    bytes.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

/// Opens a pipe or a device without blocking, a pipe once it has a reader; below 0 if that fails.
/// Ctrl-C ends the wait.
int openForWriting(const std::string& name) {
  constexpr int kMilliseconds = 50;
  while (true) {
    const int descriptor = ::open(name.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    const int error = errno;
    if (descriptor >= 0 || error != ENXIO || !std::filesystem::is_fifo(name)) {
      errno = error;
      return descriptor;
    }
    stopIfAsked();
    ::poll(nullptr, 0, kMilliseconds);
  }
}

/// Writes to standard output, a pipe or a device at once, and says why where that fails.
class OutputBuffer final : public std::streambuf {
 public:
  explicit OutputBuffer(const std::string& name) : name_(name) {
    if (isStandard(name)) {
      name_ = "standard output";
      return;
    }
    descriptor_ = openForWriting(name);
    if (descriptor_ < 0) {
      throw Error(ErrorCode::UnwritableFile, "cannot write " + name + ": " + std::strerror(errno));
    }
  }
  ~OutputBuffer() override {
    if (descriptor_ != STDOUT_FILENO) ::close(descriptor_);
  }
  OutputBuffer(const OutputBuffer&) = delete;
  OutputBuffer& operator=(const OutputBuffer&) = delete;

 protected:
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    writeBytes(descriptor_, {data, static_cast<std::size_t>(size)}, name_);
    return size;
  }

  int_type overflow(int_type character) override {
    const char byte = traits_type::to_char_type(character);
    if (!traits_type::eq_int_type(character, traits_type::eof())) xsputn(&byte, 1);
    return traits_type::not_eof(character);
  }

 private:
  std::string name_;
  int descriptor_ = STDOUT_FILENO;
};

/// Throws Error(InvalidArgument): `--format` was given for a file.
[[noreturn]] void refuseFormat(const std::string& purpose, const std::string& name) {
  throw Error(ErrorCode::InvalidArgument,
              "--format is for " + purpose + "; " +
                  (std::filesystem::path(name).has_extension()
                       ? "the ending of " + name + " says its format"
                       : name + " is a file, whose name needs an ending that says its format"));
}

}  // namespace

bool isStandard(const std::string& name) { return name == "-"; }

std::string shownInput(const std::string& name) {
  return isStandard(name) ? kInput : shownFile(name);
}

FileBytes standardInput() {
  static const std::string bytes = readAll();
  return {bytes, kInput};
}

bool isDirect(const std::string& name) { return isStandard(name) || isPipeOrDevice(name); }

void writeDirect(const std::string& name, const std::function<void(std::ostream&)>& writeTo) {
  OutputBuffer buffer(name);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios_base::badbit);
  writeTo(stream);
}

void keepApart(const std::string& output) {
  if (!isStandard(output)) return;
  printToStandardError();
  if (::isatty(STDOUT_FILENO) != 1) return;
  throw Error(ErrorCode::InvalidArgument,
              "standard output is a terminal; give it a file or a pipe");
}

CLI::Option* addFormatOption(CLI::App& app, std::optional<std::string>& format,
                             const std::string& help, std::span<const std::string_view> names) {
  return app.add_option("--format", format, help)
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
}

CLI::Option* addInputFormatOption(CLI::App& app, std::optional<std::string>& format) {
  return app.add_option("--format", format, "of the mesh in standard input")
      ->check(CLI::IsMember({"ply", "obj", "stl", "off", "glb"}));
}

MeshFormat meshFormat(const std::string& name, const std::optional<std::string>& format) {
  if (isStandard(name)) {
    if (format) return meshFormatOf("-." + *format);
    throw Error(ErrorCode::InvalidArgument, "the format of - has no ending to tell it: --format");
  }
  const bool hasEnding = std::filesystem::path(name).has_extension();
  if (isPipeOrDevice(name)) {
    if (format) return meshFormatOf("-." + *format);
    if (!hasEnding) return MeshFormat::Ply;  // as the library writes it
  }
  if (!format) return meshFormatOf(name);
  refuseFormat("standard input and output, -, pipes and devices", name);
}

Mesh readMeshInput(const std::string& name, const std::optional<std::string>& format) {
  if (isStandard(name)) return readMesh(standardInput(), meshFormat(name, format));
  if (format) refuseFormat("standard input, -", name);
  return namingPipes(name, [&] { return readMesh(name); });
}

}  // namespace tufa::tools
