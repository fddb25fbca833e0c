#pragma once

#include <tufa/contour.h>
#include <array>

namespace tufa::uniform {

/// Whether the inside corners of an ambiguous face are joined. `values` are negative inside, in
/// cyclic order around the face, alternating in sign.
[[nodiscard]] bool joinsInside(Ambiguity rule, const std::array<double, 4>& values);

}  // namespace tufa::uniform
