#pragma once

#include <tufa/implicit.h>

#include <optional>

#include "base/vec3.h"

namespace tufa::rays {

/// A part of a line: from + t * direction, t from `begin` to `end`. The direction has length 1.
struct Stretch {
  Vec3 from;
  Vec3 direction;
  double begin = 0;
  double end = 0;
};

/// The first t on a stretch where the field changes to the other side than `inside` says of its
/// beginning. Interval arithmetic tells of each part that it holds no such place, or one alone;
/// else it is halved (Moore 1966; for rays Mitchell 1990). Each part takes one of `looks`; once
/// they are used up, parts that bounds do not decide are taken for empty: a field without bounds,
/// such as 1/0, would be halved for ever.
[[nodiscard]] std::optional<double> firstCrossing(const implicit::Field& field,
                                                  const Stretch& stretch, bool inside, int& looks);

}  // namespace tufa::rays
