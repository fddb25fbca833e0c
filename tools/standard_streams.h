#pragma once

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/memory.h>
#include <functional>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tufa::tools {

// Standard input and output in the place of files, by the name "-".

/// Whether a name stands for standard input or output.
[[nodiscard]] bool isStandard(const std::string& name);

/// The name of an input as messages have it.
[[nodiscard]] std::string shownInput(const std::string& name);

/// All bytes of standard input, read at the first call. Throws Error: UnreadableFile, Cancelled.
[[nodiscard]] FileBytes standardInput();

/// Whether bytes are sent to an output at once, rather than kept under its name once all are there:
/// standard output, a pipe or a device.
[[nodiscard]] bool isDirect(const std::string& name);

/// Calls writeTo() with a stream to an output that isDirect(). Throws Error: UnwritableFile where
/// it is full or closed, Cancelled where nobody takes the bytes and the user asks to stop.
void writeDirect(const std::string& name, const std::function<void(std::ostream&)>& writeTo);

/// To be called before anything is printed, with the name of the output: print() writes to standard
/// error where standard output is for data. Throws Error(InvalidArgument) if that is a terminal.
void keepApart(const std::string& output);

/// Declares `--format`, one of some names of mesh formats.
CLI::Option* addFormatOption(CLI::App& app, std::optional<std::string>& format,
                             const std::string& help,
                             std::span<const std::string_view> names = meshFormatNames());
/// The same for meshes in standard input, of the formats that are read.
CLI::Option* addInputFormatOption(CLI::App& app, std::optional<std::string>& format);

/// The format of a mesh: what `--format` says for "-", a pipe or a device, and the ending for a
/// file. Throws Error(InvalidArgument) if "-" has no format, a file has one beside its ending, or
/// the ending is unknown.
[[nodiscard]] MeshFormat meshFormat(const std::string& name,
                                    const std::optional<std::string>& format);

/// Calls read(), and says of a pipe or a device, which is not read by its name, what to do.
template <class Read>
auto namingPipes(const std::string& name, Read&& read) {
  try {
    return read();
  } catch (const Error& error) {
    if (!isDirect(name)) throw;
    throw Error(error.code(), std::string(error.what()) + "; give it as -, standard input");
  }
}

/// readMesh() of a file or standard input.
[[nodiscard]] Mesh readMeshInput(const std::string& name, const std::optional<std::string>& format);

}  // namespace tufa::tools
