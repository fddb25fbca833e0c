#pragma once

#include <string>

namespace tufa::tools {

/// While an object exists, a crash ends the program as a damaged file does: with one line that
/// names the file, and exit code 3. OpenVDB's reader trusts what it reads, so damage can make it
/// crash; nothing is being written at that time. One object at a time.
class CrashGuard {
 public:
  explicit CrashGuard(const std::string& file);
  ~CrashGuard();
  CrashGuard(const CrashGuard&) = delete;
  CrashGuard& operator=(const CrashGuard&) = delete;
};

}  // namespace tufa::tools
