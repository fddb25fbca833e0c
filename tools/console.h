#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace tufa::tools {

/// Makes Ctrl-C and SIGTERM set a flag, and a broken pipe or a file over its size limit an error of
/// the write.
void installSignalHandlers();

/// Whether the user asked to stop.
[[nodiscard]] bool interrupted();

/// Throws Error(Cancelled) if so.
void stopIfAsked();

/// Writes all bytes to a descriptor, which `name` names in errors. Where nobody takes them, who
/// asks to stop need not wait. Throws Error: UnwritableFile, Cancelled.
void writeBytes(int descriptor, std::string_view bytes, const std::string& name);

/// Writes to standard output. Throws what writeBytes() throws, if it is full or closed for
/// instance.
void print(const std::string& text);

/// Prints a help text or the version. Returns the exit code: 1, after a note, if standard output is
/// full or closed, as programs do whose only work is that text.
[[nodiscard]] int printHelp(const std::string& text);

/// From now on print() writes to standard error: standard output is for data.
void printToStandardError();

/// One line on standard error, prefixed by the command's name.
void printNote(const std::string& text);

/// 'grid "NAME"', or "unnamed grid". Names come from files: what a terminal would obey is escaped.
[[nodiscard]] std::string shownGrid(const std::string& name);

/// The name of a file on one line. It may come from an archive, and is escaped as those of grids
/// are.
[[nodiscard]] std::string shownFile(const std::filesystem::path& file);

/// Ends the program without freeing what it holds: a file that could not be read may have broken
/// the heap, and a crash would follow the message.
[[noreturn]] void endAtOnce(int exitCode);

/// A count with a comma every three digits.
[[nodiscard]] std::string formatCount(std::size_t count);

/// A number in at most six significant digits.
[[nodiscard]] std::string formatNumber(double value);

/// A number in at most three significant digits, for tables.
[[nodiscard]] std::string shortNumber(double value);

/// A share in percent; 0% for nothing of nothing.
[[nodiscard]] std::string formatShare(std::size_t part, std::size_t whole);

/// What came of --min-angle: "smallest angle 1.2 degrees; 0.4% of the triangles are under 20".
[[nodiscard]] std::string describeAngles(double smallest, std::size_t below, std::size_t triangles,
                                         double asked);

/// The most memory that the process ever held, in bytes.
[[nodiscard]] std::uint64_t peakMemoryBytes();

/// Threads that a call with this option may use; 0 stands for all there are.
[[nodiscard]] int resolveThreads(int threads);

}  // namespace tufa::tools
