#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "support/scratch_folder.h"

namespace tufa::test {

/// A sanitizer takes terabytes of addresses, and time.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// What a program may take.
struct RunLimits {
  rlim_t addressBytes = rlim_t{1} << 30;
  rlim_t cpuSeconds = 5;
};

/// How a program under limits ended.
struct LimitedOutcome {
  int exitCode = -1;  ///< -1 for a signal
  double cpuSeconds = 0;
  std::uint64_t peakBytes = 0;  ///< the most memory that it held
  std::string err;
};

/// Runs the command, `words[0]` being its name, under limits; the one of time ends a hang. Standard
/// error goes through the file `errors`, standard output nowhere.
inline LimitedOutcome runLimited(const std::vector<std::string>& words, const std::string& errors,
                                 const RunLimits& limits = {}) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlim_t cpu = kSanitized ? 60 : limits.cpuSeconds;
    const rlimit addresses{limits.addressBytes, limits.addressBytes};
    const rlimit seconds{cpu, cpu};
    if (!kSanitized) ::setrlimit(RLIMIT_AS, &addresses);
    ::setrlimit(RLIMIT_CPU, &seconds);
    ::alarm(kSanitized ? 600 : 120);  // a wait for something that never comes takes no CPU time
    std::vector<char*> arguments;
    std::vector<std::string> copies = words;
    for (std::string& word : copies) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (::freopen(errors.c_str(), "w", stderr) == nullptr) ::_exit(126);
    if (::freopen("/dev/null", "w", stdout) == nullptr) ::_exit(126);
    ::execv(TUFA_COMMAND, arguments.data());
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<std::uint64_t>(usage.ru_maxrss) << 10U, readBytes(errors)};
}

}  // namespace tufa::test
