#pragma once

#include <tufa/io.h>
#include <tufa/memory.h>
#include <optional>
#include <ostream>
#include <string>

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

/// Standard output, for data: from the first call on print() writes to standard error. Throws
/// Error(UnwritableFile) where it is full or closed, and InvalidArgument if it is a terminal.
[[nodiscard]] std::ostream& standardOutput();

/// To be called before anything is printed, with the name of the output.
void keepApart(const std::string& output);

/// Declares `--format`, one of the names of mesh formats.
CLI::Option* addFormatOption(CLI::App& app, std::optional<std::string>& format,
                             const std::string& help);
/// The same for meshes in standard input, of the formats that are read.
CLI::Option* addInputFormatOption(CLI::App& app, std::optional<std::string>& format);

/// The format of a mesh: what `--format` says for "-", and the ending for a file. Throws
/// Error(InvalidArgument) if "-" has no format, a file has one beside its ending, or the ending is
/// unknown.
[[nodiscard]] MeshFormat meshFormat(const std::string& name,
                                    const std::optional<std::string>& format);

/// readMesh() of a file or standard input.
[[nodiscard]] Mesh readMeshInput(const std::string& name, const std::optional<std::string>& format);

}  // namespace tufa::tools
