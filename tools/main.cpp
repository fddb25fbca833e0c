#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <algorithm>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "console.h"
#include "failure.h"
#include "memory_reserve.h"
#include "usage.h"

namespace {

using namespace tufa::tools;

/// Where a failure is told: a line on standard error, and with `--json` an object where the summary
/// would be.
struct Failures {
  bool json = false;

  void tell(const std::string& code, const std::string& message) const {
    printNote(message);
    if (!json) return;
    const nlohmann::ordered_json object = {{"error", errorToJson(code, message)}};
    try {
      print(object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    } catch (const tufa::Error&) {
      // Standard output is closed or full, which may be the failure itself: that was told.
    }
  }
};

/// Runs the subcommand; every error becomes one line and an exit code.
int runGuarded(const Command& command, const Failures& failures) {
  const auto tellOutOfMemory = [&] {
    failures.tell("out_of_memory", "out of memory");
    return kUnusableFile;
  };
  try {
    return command();
  } catch (const tufa::Error& error) {
    // A call that waited fails when it is interrupted, for instance to open a pipe.
    const bool cancelled = error.code() == tufa::ErrorCode::Cancelled || interrupted();
    failures.tell(nameOf(cancelled ? tufa::ErrorCode::Cancelled : error.code()),
                  cancelled ? "interrupted" : messageOf(error));
    const int exitCode = cancelled ? kCancelled : exitCodeOf(error);
    if (error.code() == tufa::ErrorCode::UnreadableFile) endAtOnce(exitCode);
    return exitCode;
  } catch (const std::bad_alloc&) {
    return tellOutOfMemory();
  } catch (const std::exception& error) {
    // TBB's words where the system has no room for another thread.
    if (std::string_view(error.what()).starts_with("pthread_create has failed")) {
      return tellOutOfMemory();
    }
    failures.tell("internal_error", error.what());
    return kUnusableFile;
  }
}

}  // namespace

int main(int argc, char** argv) {
  installSignalHandlers();
  giveLargeMemoryBack();
  keepMemoryInReserve();
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  // Also where the command line cannot be read otherwise.
  const Failures failures{std::find(words.begin(), words.end(), "--json") != words.end()};
  CLI::App app;
  Command chosen;
  declareCommand(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    // Not by CLI11, which does not notice a full disk.
    const auto show = [&] {
      std::ostringstream text;
      (void)app.exit(help, text, text);
      return printHelp(text.str());
    };
    return runGuarded(show, failures);
  } catch (const CLI::ParseError& error) {
    failures.tell("invalid_argument", describeMisuse(app, error, words));
    return kWrongUsage;
  }
  return runGuarded(chosen, failures);
}
