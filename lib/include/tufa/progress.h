#pragma once

#include <tufa/export.h>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tufa {

/// How far a call is.
struct ProgressState {
  std::string_view stage;             ///< what it does at present: "blocks", "vertices", ...
  double fraction = 0;                ///< the share of the whole call that is done, 0 to 1
  std::optional<double> secondsLeft;  ///< once enough is done to estimate it
};

/// Estimates how long work still takes from the time that its part so far took.
class RestEstimate {
 public:
  /// Seconds from now to the end, if at least 5 % are done. The time counts from the first call.
  [[nodiscard]] std::optional<double> secondsLeft(double fraction) {
    constexpr double kEnough = 0.05;
    const auto now = Clock::now();
    if (!start_) start_ = now;
    if (!(fraction >= kEnough)) return std::nullopt;
    const double elapsed = std::chrono::duration<double>(now - *start_).count();
    return fraction < 1 ? elapsed * (1 - fraction) / fraction : 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> start_;
};

/// A function that is called at times during long work, on the calling thread only, never by two
/// calls at once. It takes a ProgressState, or a stage and a fraction; see there. The fraction
/// never falls in a call, and is 1 at the end of one that succeeds. If it returns false, the call
/// throws Error with ErrorCode::Cancelled and frees everything it holds. It is the only way to stop
/// a call: one inside a group of TBB's tasks goes on to its end when that group is cancelled.
class Progress {
 public:
  /// None: nobody is asked.
  Progress() = default;
  /// None: nobody is asked.
  Progress(std::nullptr_t) {}
  /// From any function of a stage and a fraction.
  template <class Function>
  requires(std::is_invocable_r_v<bool, Function&, std::string_view, double>)
      Progress(Function function) {
    if constexpr (std::is_constructible_v<Function, std::nullptr_t> &&
                  std::is_constructible_v<bool, const Function&>) {
      if (!static_cast<bool>(function)) return;  // a pointer or std::function of nothing
    }
    function_ = [f = std::move(function)](const ProgressState& state) mutable {
      return f(state.stage, state.fraction);
    };
  }
  /// From any function of a state.
  template <class Function>
  requires(std::is_invocable_r_v<bool, Function&, const ProgressState&> &&
           !std::same_as<std::remove_cvref_t<Function>, Progress>) Progress(Function function)
      : function_(std::move(function)) {}

  /// Whether there is a function.
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(function_); }

  /// What calls do: tells the function, and gives its answer.
  bool operator()(std::string_view stage, double fraction) const {
    // A smaller fraction is that of another call.
    if (fraction < last_) rest_ = {};
    last_ = fraction;
    return function_({stage, fraction, rest_.secondsLeft(fraction)});
  }

 private:
  std::function<bool(const ProgressState&)> function_;
  mutable RestEstimate rest_;
  mutable double last_ = 0;
};

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
