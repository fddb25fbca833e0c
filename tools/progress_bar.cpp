#include "progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "console.h"

namespace tufa::tools {
namespace {

constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kRedraw{100};
constexpr int kBarWidth = 40;

}  // namespace

ProgressBar::ProgressBar(bool quiet) : enabled_(!quiet && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { clear(); }

Progress ProgressBar::callback() {
  return [this](std::string_view stage, double fraction) {
    if (enabled_) show(stage, fraction);
    return !interrupted();
  };
}

void ProgressBar::show(std::string_view stage, double fraction) {
  const auto now = Clock::now();
  if (now - start_ < kPatience || now - drawn_ < kRedraw) return;
  drawn_ = now;
  visible_ = true;
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r[%s] %3d%% %-16.16s", bar.c_str(), static_cast<int>(fraction * 100),
               std::string(stage).c_str());
}

void ProgressBar::clear() {
  if (visible_) std::fprintf(stderr, "\r%*s\r", kBarWidth + 24, "");
  visible_ = false;
}

}  // namespace tufa::tools
