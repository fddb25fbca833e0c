#include "progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>

#include "console.h"

namespace tufa::tools {
namespace {

constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kRedraw{100};
constexpr int kBarWidth = 40;

}  // namespace

ProgressBar::ProgressBar(bool quiet, std::vector<double> shares)
    : enabled_(!quiet && isatty(STDERR_FILENO) == 1), shares_(std::move(shares)) {}

ProgressBar::~ProgressBar() { clear(); }

Progress ProgressBar::callback() {
  const std::size_t call = std::min(call_++, shares_.size() - 1);
  const auto next = shares_.begin() + static_cast<std::ptrdiff_t>(call);
  const double all = std::accumulate(shares_.begin(), shares_.end(), 0.0);
  const double begin = std::accumulate(shares_.begin(), next, 0.0) / all;
  const double share = *next / all;
  return [this, begin, share](std::string_view stage, double fraction) {
    if (enabled_) show(stage, begin + share * std::clamp(fraction, 0.0, 1.0));
    return !interrupted();
  };
}

void ProgressBar::show(std::string_view stage, double fraction) {
  shown_ = std::max(shown_, fraction);
  const auto left = rest_.secondsLeft(shown_);
  const auto now = Clock::now();
  if (now - start_ < kPatience || now - drawn_ < kRedraw) return;
  drawn_ = now;
  visible_ = true;
  const int filled = static_cast<int>(shown_ * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  const std::string rest = left ? "about " + shortNumber(std::ceil(*left)) + " s left" : "";
  std::fprintf(stderr, "\r[%s] %3d%% %-12.12s %-20.20s", bar.c_str(),
               static_cast<int>(shown_ * 100), std::string(stage).c_str(), rest.c_str());
}

void ProgressBar::clear() {
  if (visible_) std::fprintf(stderr, "\r%*s\r", kBarWidth + 42, "");
  visible_ = false;
}

}  // namespace tufa::tools
