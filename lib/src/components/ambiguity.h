#pragma once

#include <array>
#include <tufa/contour.h>

namespace tufa::components {

/// Whether the inside corners of an ambiguous face are joined. `values` are negative inside, in
/// cyclic order around the face, alternating in sign.
[[nodiscard]] bool joinsInside(Ambiguity rule, const std::array<double, 4>& values);

}  // namespace tufa::components
