#pragma once

#include <cstddef>
#include <functional>

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace tufa::tools {

/// The work of a subcommand once the command line is read; returns the exit code.
using Command = std::function<int()>;

/// Declares the whole command and its subcommands.
void declareCommand(CLI::App& app, Command& chosen);

// Each declares one subcommand with its options, and puts its work into `chosen` when the command
// line names it.
void addMakeCommand(CLI::App& app, Command& chosen);
void addVoxelizeCommand(CLI::App& app, Command& chosen);
void addModelCommand(CLI::App& app, Command& chosen);
void addImportCommand(CLI::App& app, Command& chosen);
void addPictureCommand(CLI::App& app, Command& chosen);
void addInfoCommand(CLI::App& app, Command& chosen);
void addAdviseCommand(CLI::App& app, Command& chosen);
void addFilterCommand(CLI::App& app, Command& chosen);
void addMeshCommand(CLI::App& app, Command& chosen);
void addLodCommand(CLI::App& app, Command& chosen);
void addChunksCommand(CLI::App& app, Command& chosen);
void addCheckCommand(CLI::App& app, Command& chosen);
void addCompareCommand(CLI::App& app, Command& chosen);
void addRepairCommand(CLI::App& app, Command& chosen);
void addFitCommand(CLI::App& app, Command& chosen);
void addHelpCommand(CLI::App& app, Command& chosen);

/// Declares `--threads`, which all of them have.
void addThreadsOption(CLI::App& app, int& threads);

/// For options that take a number above 0.
[[nodiscard]] CLI::Validator above0();

/// That an option is a whole number, `least` or more: CLI11 alone takes -1 for the greatest.
[[nodiscard]] CLI::Validator wholeNumberFrom(std::size_t least);

/// That an option is a whole number in a range, ends included.
[[nodiscard]] CLI::Validator wholeNumberIn(std::size_t least, std::size_t most);

/// Exit codes of the command.
inline constexpr int kDone = 0;
inline constexpr int kPromiseBroken = 1;   ///< the mesh is not what it should be
inline constexpr int kHelpNotPrinted = 1;  ///< standard output is full or closed
inline constexpr int kWrongUsage = 2;
inline constexpr int kUnusableFile =
    3;                                  ///< input that cannot be used or output that cannot be made
inline constexpr int kCancelled = 130;  ///< as a shell reports a program that Ctrl-C ended

}  // namespace tufa::tools
