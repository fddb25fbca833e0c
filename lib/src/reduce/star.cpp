#include "reduce/star.h"

#include <algorithm>
#include <cmath>

namespace tufa::reduce {

Vec3f commonAxis(const Vec3f* normals, int count, float& leastCosine) {
  constexpr int kRounds = 6;
  Vec3f sum, axis;
  for (int i = 0; i < count; ++i) sum = sum + normals[i];
  for (int round = 0; round < kRounds; ++round) {
    axis = unit(sum);
    leastCosine = 2;
    int worst = 0;
    for (int i = 0; i < count; ++i) {
      const float cosine = dot(axis, normals[i]);
      if (cosine < leastCosine) leastCosine = cosine, worst = i;
    }
    if (leastCosine > 0.5f) break;
    sum = axis + normals[worst] * (0.6f / static_cast<float>(round + 1));
  }
  return axis;
}

bool windsOnce(const Vec3f* to, int count, Vec3f axis) {
  const Vec3f y = base::frameAbout(axis).y;
  int turns = 0;  // times that it passes the ray along the frame's x upward
  float last = dot(to[0], y);
  for (int i = 0; i < count; ++i) {
    const float next = dot(to[i + 1 == count ? 0 : i + 1], y);
    turns += last < 0 && next >= 0;
    last = next;
  }
  return turns == 1;
}

bool arcsPart(Vec3f s, Vec3f t, Vec3f x, Vec3f y) {
  // Two flat cones are apart if and only if a plane through the apex parts them. One that touches
  // both does, so it holds an arc or an end of each.
  constexpr float kGap = 1e-4f;
  const auto parts = [&](Vec3f n) {
    const float l2 = squaredLength(n);
    if (!(l2 > 1e-12f)) return false;
    const float gap = kGap * std::sqrt(l2), touch = 1e-3f * gap;
    const float a = dot(n, s), b = dot(n, t), c = dot(n, x), d = dot(n, y);
    const float lowA = std::min(a, b), highA = std::max(a, b);
    const float lowB = std::min(c, d), highB = std::max(c, d);
    return (lowA > -touch && highB < -gap) || (highA < touch && lowB > gap) ||
           (lowB > -touch && highA < -gap) || (highB < touch && lowA > gap);
  };
  return parts(s + t - x - y) || parts(cross(s, t)) || parts(cross(x, y)) || parts(cross(s, x)) ||
         parts(cross(s, y)) || parts(cross(t, x)) || parts(cross(t, y));
}

bool linkIsSimple(const Vec3f* directions, int count, int first, int last) {
  const auto at = [&](int i) { return directions[i >= count ? i - count : i]; };
  for (int i = first - 1; i <= last; ++i) {  // arc i runs from i to i + 1
    const int own = i < 0 ? count - 1 : i;
    for (int other = 0; other < count; ++other) {
      const int apart = other > own ? other - own : own - other;
      if (apart <= 1 || apart == count - 1) continue;                // the same or a neighbour
      if (other >= first && other <= last && other < own) continue;  // seen before
      if (!arcsPart(at(own), at(own + 1), at(other), at(other + 1))) return false;
    }
  }
  return true;
}

}  // namespace tufa::reduce
