#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "console.h"

namespace {

using namespace tufa::tools;

int exitCodeOf(const tufa::Error& error) {
  switch (error.code()) {
    case tufa::ErrorCode::InvalidArgument:
      return kWrongUsage;
    case tufa::ErrorCode::Cancelled:
      return kCancelled;
    default:
      return kUnusableFile;
  }
}

/// Runs the subcommand; every error becomes one line and an exit code.
int runGuarded(const Command& command) {
  try {
    return command();
  } catch (const tufa::Error& error) {
    printNote(error.what());
    if (error.code() == tufa::ErrorCode::UnreadableFile) endAtOnce(exitCodeOf(error));
    return exitCodeOf(error);
  } catch (const std::bad_alloc&) {
    printNote("out of memory");
    return kUnusableFile;
  } catch (const std::exception& error) {
    printNote(error.what());
    return kUnusableFile;
  }
}

std::string oneLine(std::string text) {
  const auto end = text.find_last_not_of(" \n");
  text.erase(end == std::string::npos ? 0 : end + 1);
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  installSignalHandlers();
  CLI::App app;
  Command chosen;
  declareCommand(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    printNote(oneLine(error.what()) + " (see tufa --help)");
    return kWrongUsage;
  }
  return runGuarded(chosen);
}
