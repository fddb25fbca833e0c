#include "standard_streams.h"

#include <CLI/CLI.hpp>

#include <poll.h>
#include <unistd.h>

#include <tufa/error.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <ios>
#include <streambuf>
#include <vector>

#include "console.h"

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
    if (interrupted()) throw Error(ErrorCode::Cancelled, "cancelled while reading");
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

/// Writes to standard output at once, and says why where that fails.
class OutputBuffer final : public std::streambuf {
 protected:
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    for (std::streamsize done = 0; done < size;) {
      const ssize_t written =
          ::write(STDOUT_FILENO, data + done, static_cast<std::size_t>(size - done));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) {
        throw Error(ErrorCode::UnwritableFile,
                    std::string("cannot write standard output: ") + std::strerror(errno));
      }
      done += written;
    }
    return size;
  }

  int_type overflow(int_type character) override {
    const char byte = traits_type::to_char_type(character);
    if (!traits_type::eq_int_type(character, traits_type::eof())) xsputn(&byte, 1);
    return traits_type::not_eof(character);
  }
};

}  // namespace

bool isStandard(const std::string& name) { return name == "-"; }

std::string shownInput(const std::string& name) { return isStandard(name) ? kInput : name; }

FileBytes standardInput() {
  static const std::string bytes = readAll();
  return {bytes, kInput};
}

std::ostream& standardOutput() {
  static OutputBuffer buffer;
  static std::ostream stream(&buffer);
  stream.exceptions(std::ios_base::badbit);
  return stream;
}

void keepApart(const std::string& output) {
  if (!isStandard(output)) return;
  printToStandardError();
  if (::isatty(STDOUT_FILENO) != 1) return;
  throw Error(ErrorCode::InvalidArgument,
              "standard output is a terminal; give it a file or a pipe");
}

CLI::Option* addFormatOption(CLI::App& app, std::optional<std::string>& format,
                             const std::string& help) {
  const auto names = meshFormatNames();
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
  if (!format) return meshFormatOf(name);
  throw Error(
      ErrorCode::InvalidArgument,
      "--format is for standard input and output, -; the ending of " + name + " says its format");
}

Mesh readMeshInput(const std::string& name, const std::optional<std::string>& format) {
  if (isStandard(name)) return readMesh(standardInput(), meshFormat(name, format));
  if (format) static_cast<void>(meshFormat(name, format));  // throws
  return readMesh(name);
}

}  // namespace tufa::tools
