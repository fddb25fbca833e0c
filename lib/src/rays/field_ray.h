#pragma once

#include <tufa/implicit.h>

#include <optional>

#include "base/vec3.h"
#include "implicit/spans.h"

namespace tufa::rays {

/// A part of a line: from + t * direction, t from `begin` to `end`. The direction has length 1.
struct Stretch {
  Vec3 from;
  Vec3 direction;
  double begin = 0;
  double end = 0;
};

/// What is known of a field in a box around stretches.
struct Slopes {
  implicit::Box gradient;  ///< bounds, by component
  double steepest = 0;     ///< bound of its length
};

/// The first t on a stretch where the field changes to the other side than `inside` says of its
/// beginning. Interval arithmetic tells of each part that it holds no such place, or one alone;
/// else it is halved (Moore 1966; for rays Mitchell 1990). Each part takes one of `looks`; once
/// they are used up, parts that bounds do not decide are taken for empty: a field without bounds,
/// such as 1/0, would be halved for ever.
[[nodiscard]] std::optional<double> firstCrossing(const implicit::Field& field,
                                                  const Slopes& slopes, const Stretch& stretch,
                                                  bool inside, int& looks);

/// The same for a field whose insideAlong() is a closed form, by its roots. Ranges shorter than
/// rounding explains, as between solids with a common face, are left out. `spans` is scratch.
[[nodiscard]] std::optional<double> firstRoot(const implicit::Field& field, const Stretch& stretch,
                                              bool inside, implicit::Spans& spans);

}  // namespace tufa::rays
