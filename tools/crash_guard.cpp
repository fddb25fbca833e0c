#include "crash_guard.h"

#include <unistd.h>

#include <array>
#include <csignal>

#include "commands.h"

namespace tufa::tools {
namespace {

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::string message;  // made beforehand: a signal handler may not

void refuse(int /*signal*/) {
  // If that fails, nothing more can be done.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(kUnusableFile);
}

}  // namespace

CrashGuard::CrashGuard(const std::string& file) {
  message = "tufa: cannot read " + file + ": OpenVDB crashed on it, it is damaged\n";
  for (const int signal : kCrashes) std::signal(signal, refuse);
}

CrashGuard::~CrashGuard() {
  for (const int signal : kCrashes) std::signal(signal, SIG_DFL);
}

}  // namespace tufa::tools
