#include "console.h"

#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include "base/printable.h"
#include "commands.h"

namespace tufa::tools {
namespace {

// A signal handler may touch little else.
volatile std::sig_atomic_t stopRequested = 0;

bool printsToStandardError = false;

void requestStop(int signal) {
  stopRequested = 1;
  // A second Ctrl-C ends the program at once, should the first not be heard.
  std::signal(signal, SIG_DFL);
}

/// Not by std::signal(), after which the system goes on with a call that waits, for a reader of a
/// pipe for instance, and the request would not be heard.
void requestStopAt(int signal) {
  struct sigaction action {};
  action.sa_handler = requestStop;
  ::sigaction(signal, &action, nullptr);
}

/// Waits a moment until a descriptor takes bytes, or writing to it fails at once; whether it does.
bool takesBytes(int descriptor) {
  pollfd output{descriptor, POLLOUT, 0};
  constexpr int kMilliseconds = 200;
  const int ready = ::poll(&output, 1, kMilliseconds);
  return ready > 0 || (ready < 0 && errno != EINTR);
}

}  // namespace

void installSignalHandlers() {
  requestStopAt(SIGINT);
  requestStopAt(SIGTERM);
  // A terminal that is closed; nohup has it ignored.
  if (std::signal(SIGHUP, SIG_DFL) == SIG_IGN) {
    std::signal(SIGHUP, SIG_IGN);
  } else {
    requestStopAt(SIGHUP);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() { return stopRequested != 0; }

void stopIfAsked() {
  if (interrupted()) throw Error(ErrorCode::Cancelled, "cancelled");
}

// No call waits for a reader for long: a request to stop that comes just before it would not be
// heard.
void writeBytes(int descriptor, std::string_view bytes, const std::string& name) {
  constexpr std::size_t kAtOnce = PIPE_BUF;  // what a pipe that takes bytes has room for
  while (!bytes.empty()) {
    if (!takesBytes(descriptor)) {
      stopIfAsked();
      continue;
    }
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), kAtOnce));
    if (written < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (written < 0) {
      throw Error(ErrorCode::UnwritableFile, "cannot write " + name + ": " + std::strerror(errno));
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void print(const std::string& text) {
  if (printsToStandardError) {
    writeBytes(STDERR_FILENO, text, "standard error");
  } else {
    writeBytes(STDOUT_FILENO, text, "standard output");
  }
}

int printHelp(const std::string& text) {
  try {
    print(text);
    return kDone;
  } catch (const Error& error) {
    printNote(error.what());
    return kHelpNotPrinted;
  }
}

void printToStandardError() { printsToStandardError = true; }

void printNote(const std::string& text) {
  std::fprintf(stderr, "tufa: %s\n", base::printable(text).c_str());
}

std::string shownGrid(const std::string& name) {
  return name.empty() ? "unnamed grid" : "grid \"" + base::printable(name) + "\"";
}

std::string shownFile(const std::filesystem::path& file) { return base::printable(file.string()); }

void endAtOnce(int exitCode) {
  std::fflush(nullptr);
  ::_exit(exitCode);
}

std::string formatCount(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t n = digits.size(); n > 3; n -= 3) digits.insert(n - 3, 1, ',');
  return digits;
}

std::string formatNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::string shortNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

std::string formatShare(std::size_t part, std::size_t whole) {
  const double share =
      static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
  return shortNumber(100 * share) + "%";
}

std::string describeAngles(double smallest, std::size_t below, std::size_t triangles,
                           double asked) {
  return "smallest angle " + shortNumber(smallest) + " degrees; " + formatShare(below, triangles) +
         " of the triangles are under " + shortNumber(asked);
}

std::uint64_t peakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

int resolveThreads(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
}

}  // namespace tufa::tools
