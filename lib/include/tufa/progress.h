#pragma once

#include <tufa/export.h>
#include <functional>
#include <string_view>

namespace tufa {

/// Called at times during long work, on the calling thread only, never by two calls at once.
///
/// `stage` names the present stage ("signs", "vertices", ...), `fraction` is the share of the whole
/// call that is done, from 0 to 1, never falling. Return false to cancel: the call then throws
/// Error with ErrorCode::Cancelled and frees everything it holds. It is the only way to stop a
/// call: one inside a group of TBB's tasks goes on to its end when that group is cancelled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

/// A Progress that asks an interrupter as OpenVDB's own tools take it, such as
/// openvdb::util::NullInterrupter and what programs derive from it: any type with
/// `bool wasInterrupted(int percent)`. The interrupter must live as long as the call.
template <class Interrupter>
[[nodiscard]] Progress progressOf(Interrupter& interrupter) {
  return [&interrupter](std::string_view /*stage*/, double fraction) {
    return !interrupter.wasInterrupted(static_cast<int>(100 * fraction));
  };
}

}  // namespace tufa
