#include "crash_guard.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include "commands.h"
#include "memory_reserve.h"

namespace tufa::tools {
namespace {

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

// What the signal handler needs is made beforehand and lies outside of the heap, which a crash may
// have overwritten, as is the stack that it runs on: the usual one may have overflowed.
std::array<char, 8192> message;
std::size_t messageBytes = 0;
int outputCopy = STDOUT_FILENO;
int errorCopy = STDERR_FILENO;
alignas(16) std::array<char, std::size_t{64} << 10> handlerStack;

void refuse(int /*signal*/) {
  constexpr std::string_view kOutOfMemory = "tufa: out of memory\n";
  // Blosc does not look whether it was given the memory that it asked for.
  if (isMemoryAtItsEnd()) {
    messageBytes = kOutOfMemory.copy(message.data(), message.size());
  }
  // If that fails, nothing more can be done.
  [[maybe_unused]] const ssize_t written = ::write(errorCopy, message.data(), messageBytes);
  ::_exit(kUnusableFile);
}

void compose(const std::string& file) {
  const std::string text = "tufa: cannot read " + file + ": OpenVDB crashed on it, it is damaged\n";
  messageBytes = std::min(text.size(), message.size());
  std::copy_n(text.begin(), messageBytes, message.begin());
}

/// Sends a standard stream nowhere, but for its copy, which it returns; itself if it has none.
int mute(int descriptor) {
  // The copy of one stream must not take the number of another that is closed.
  const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (copy < 0) return descriptor;
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) ::dup2(nowhere, descriptor);
  if (nowhere >= 0) ::close(nowhere);
  return copy;
}

void restore(int descriptor, int& copy) {
  if (copy == descriptor) return;
  ::dup2(copy, descriptor);
  ::close(copy);
  copy = descriptor;
}

/// OpenVDB's log goes to standard output where it was built with log4cplus. What was printed
/// before it is kept, and what it says does not stay in the buffer.
void muteStreams() {
  std::fflush(stdout);
  outputCopy = mute(STDOUT_FILENO);
  errorCopy = mute(STDERR_FILENO);
}

void restoreStreams() {
  std::fflush(stdout);
  restore(STDOUT_FILENO, outputCopy);
  restore(STDERR_FILENO, errorCopy);
}

void setHandlerStack(int flags) {
  stack_t stack{};
  stack.ss_sp = handlerStack.data();
  stack.ss_size = handlerStack.size();
  stack.ss_flags = flags;
  ::sigaltstack(&stack, nullptr);
}

void handleCrashes(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  for (const int signal : kCrashes) ::sigaction(signal, &action, nullptr);
}

}  // namespace

CrashGuard::CrashGuard(const std::string& file) : exceptions_(std::uncaught_exceptions()) {
  compose(file);
  muteStreams();
  setHandlerStack(0);
  handleCrashes(refuse, SA_ONSTACK);
}

CrashGuard::~CrashGuard() {
  if (std::uncaught_exceptions() == exceptions_) {
    handleCrashes(SIG_DFL, 0);
    setHandlerStack(SS_DISABLE);
  }
  restoreStreams();
}

}  // namespace tufa::tools
