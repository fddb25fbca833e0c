#pragma once

#include <tufa/export.h>
#include <stdexcept>
#include <string>

namespace tufa {

/// The kind of an error. Bad topology is never an error: it is data in a CheckReport.
enum class ErrorCode {
  InvalidArgument,  ///< an option is out of its range
  UnsupportedGrid,  ///< the grid's type or transform cannot be meshed (points, frustum, ...)
  NonFiniteValues,  ///< the grid holds NaN or infinite values
  UnknownGrid,      ///< no grid of that name in the file
  UnreadableFile,   ///< missing, truncated, of a foreign format or damaged
  UnwritableFile,   ///< no permission, no such folder, disk full
  LimitExceeded,    ///< more vertices than 32-bit indices can name, or another stated limit
  Cancelled,        ///< the caller's Progress asked to stop
};

/// The one exception type that Tufa throws on its own. The message says what was wrong, where, and
/// what to do, in one line.
class TUFA_API Error : public std::runtime_error {
 public:
  /// `message` is what what() gives, as one line: control characters, which names in files may
  /// hold, are escaped there.
  Error(ErrorCode code, const std::string& message);

  /// The kind of error, for callers that react to it.
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace tufa
