#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tufa::tools {

// What is refused of the names of files before anything is read.

/// Whether a name is that of something that bytes are sent to or come from rather than kept in.
[[nodiscard]] bool isPipeOrDevice(const std::filesystem::path& path);

/// Whether two names lead to one file, be it there or not. Pipes and devices can be shared,
/// standard input and output too.
[[nodiscard]] bool sameFile(const std::filesystem::path& a, const std::filesystem::path& b);

/// Throws Error(InvalidArgument) if the output is one of the inputs, be it through links or another
/// way to spell its name.
void requireDistinct(const std::filesystem::path& output,
                     const std::vector<std::filesystem::path>& inputs);

/// Throws Error(InvalidArgument) unless the name of a volume to write ends in .vdb, or is that of
/// standard output, a pipe or a device; UnwritableFile if nothing can be written there.
void requireVolumeOutput(const std::string& output);

/// The same of a picture, which ends in .png.
void requirePictureOutput(const std::string& output);

/// Throws Error(InvalidArgument) if a mesh cannot be written in the format that a name and
/// `--format` say; UnwritableFile if nothing can be written there.
void requireMeshOutput(const std::string& output, const std::optional<std::string>& format);

/// Throws Error(InvalidArgument) for standard output, where `what` is written to files only.
void requireFile(const std::string& output, const std::string& what);

/// Throws Error(InvalidArgument) unless the name of a page to write ends in .html or .htm.
void requirePageEnding(const std::filesystem::path& path);

/// The ending of a file name in small letters, with its point.
[[nodiscard]] std::string endingOf(const std::filesystem::path& path);

/// The last line of a summary: "wrote OUT, 12,345 bytes, in 0.1 s", or how many files and which. No
/// size for pipes and devices.
[[nodiscard]] std::string describeWritten(const std::vector<std::filesystem::path>& files,
                                          double seconds);

}  // namespace tufa::tools
