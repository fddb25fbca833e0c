#pragma once

#include <tufa/mesh.h>

namespace tufa::intersect {

// Signs of determinants of coordinates, exactly: from floating point where its rounding cannot
// matter, else from sums of products without rounding (Shewchuk 1997). There is no tolerance. Not
// exact where products of three coordinates overflow or underflow a double.

/// 1 if d sees a, b, c counter-clockwise, -1 if clockwise, 0 if the four lie in one plane.
[[nodiscard]] int orientation(const Position& a, const Position& b, const Position& c,
                              const Position& d);

/// The same in the plane left when coordinate `axis` (0, 1, 2) is dropped: 1 if a, b, c turn left,
/// seen against that axis, 0 if they lie on a line.
[[nodiscard]] int orientationAcross(int axis, const Position& a, const Position& b,
                                    const Position& c);

}  // namespace tufa::intersect
