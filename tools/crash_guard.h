#pragma once

#include <string>

namespace tufa::tools {

/// While an object exists, a crash ends the program as a damaged file does: with one line that
/// names the file, and exit code 3. OpenVDB's reader trusts what it reads, so damage can make it
/// crash; nothing is being written at that time. What it and the C library say meanwhile on
/// standard output and error is kept back. Where reading ends in an error, crashes stay guarded
/// until the program ends: the heap may be broken by then. One object at a time, on the main
/// thread.
class CrashGuard {
 public:
  explicit CrashGuard(const std::string& file);
  ~CrashGuard();
  CrashGuard(const CrashGuard&) = delete;
  CrashGuard& operator=(const CrashGuard&) = delete;

 private:
  int exceptions_;
};

}  // namespace tufa::tools
