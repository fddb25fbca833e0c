#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <vector>

namespace tufa::chunks {

/// A straight segment of a curve on its face.
struct FaceSegment {
  std::size_t line, from, to;  ///< its curve, and its ends there
  std::array<double, 2> a, b;  ///< where they are, along the axes of the face
};

/// Whether two segments intersect elsewhere than in a common end. In floating point: nearly
/// touching ones may count either way.
[[nodiscard]] inline bool intersectElsewhere(const FaceSegment& s, const FaceSegment& t) {
  if (s.a == t.a || s.a == t.b || s.b == t.a || s.b == t.b) return false;
  const auto side = [](const auto& a, const auto& b, const auto& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  };
  const double sa = side(s.a, s.b, t.a), sb = side(s.a, s.b, t.b);
  const double ta = side(t.a, t.b, s.a), tb = side(t.a, t.b, s.b);
  return sa * sb <= 0 && ta * tb <= 0 && !(sa == 0 && sb == 0);
}

/// Sorts segments of one face from left to right, and calls body(i, j) for each two that intersect
/// elsewhere than in a common end. Cost: a sweep that compares all that overlap from left to right.
template <class Body>
void forCrossings(std::vector<FaceSegment>& segments, const Body& body) {
  std::sort(segments.begin(), segments.end(), [](const FaceSegment& s, const FaceSegment& t) {
    return std::tuple(std::min(s.a[0], s.b[0]), s.line, s.from) <
           std::tuple(std::min(t.a[0], t.b[0]), t.line, t.from);
  });
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const FaceSegment& s = segments[i];
    const double right = std::max(s.a[0], s.b[0]);
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      const FaceSegment& t = segments[j];
      if (std::min(t.a[0], t.b[0]) > right) break;
      if (intersectElsewhere(s, t)) body(i, j);
    }
  }
}

}  // namespace tufa::chunks
