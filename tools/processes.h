#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace tufa::tools {

/// How a process ended that worked for this one.
struct ProcessResult {
  std::string output;  ///< what its work returned; incomplete if it was ended
  int signal = 0;      ///< that ended it, or 0
};

/// Calls work(index) for each index below `count`, at most `jobs` at a time, each in a process of
/// its own: what it may break, a damaged file in OpenVDB's reader for instance, breaks no other.
/// What it returns comes back through a pipe. Calls done(index, result) in the order of the
/// indices, as soon as that is possible; if it returns false, no further work begins. Throws
/// Error(Cancelled) when asked to stop, once all processes have ended.
///
/// To be called while this process has one thread: processes begin as copies of it.
void runInProcesses(std::size_t count, int jobs,
                    const std::function<std::string(std::size_t index)>& work,
                    const std::function<bool(std::size_t index, const ProcessResult&)>& done);

}  // namespace tufa::tools
