#pragma once

#include <tufa/progress.h>

#include <cmath>
#include <string_view>

namespace tufa::base {

/// The progress of a call that is a part of a longer one: from `begin` to `end` of the whole, whose
/// Progress must outlive it.
inline Progress partOf(const Progress& whole, double begin, double end) {
  if (!whole) return nullptr;
  return [&whole, begin, end](std::string_view stage, double fraction) {
    return whole(stage, std::lerp(begin, end, fraction));
  };
}

}  // namespace tufa::base
