#pragma once

#include <array>

#include "fit/blob_field.h"

namespace tufa::fit {

/// One ball of a field optimized, the others staying: the energy near it is as small as
/// `iterations` steps make it.
[[nodiscard]] Ball solveBall(const BlobField& field, std::size_t index, int iterations);

/// Two balls in place of one, optimized together from `start` on.
[[nodiscard]] std::array<Ball, 2> solveBalls(const BlobField& field, std::size_t index,
                                             const std::array<Ball, 2>& start, int iterations);

}  // namespace tufa::fit
