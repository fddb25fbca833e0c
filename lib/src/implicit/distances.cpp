// Exact distances to simple skeletons.

#include <tufa/implicit.h>

#include <utility>

#include "implicit/fields.h"
#include "implicit/formula_field.h"
#include "implicit/spans.h"
#include "implicit/triple.h"

namespace tufa::implicit {
namespace {

template <class T>
T length(const T& x, const T& y) {
  return sqrt(square(x) + square(y));
}
template <class T>
T length(const Triple<T>& v) {
  return norm(v[0], v[1], v[2]);
}

/// Two unit vectors at right angles to a third one.
std::pair<Vec3, Vec3> frameOf(const Vec3& normal) {
  // The axis least along the normal: their cross product is not short.
  std::size_t least = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  }
  Vec3 axis(0.0);
  axis[least] = 1;
  const Vec3 u = normal.cross(axis).unitOrX();
  return {u, normal.cross(u)};
}

/// Appends where a line is nearer to the origin than `radius`; of vectors of two components, to an
/// axis.
void appendBall(const Vec3& from, const Vec3& direction, double radius, Spans& spans) {
  const double a = direction.squaredLength();
  const double b = from.dot(direction);
  // By Lagrange's identity, which keeps what is left where a line just grazes it.
  const double reach = radius * std::sqrt(a);
  const double across = from.cross(direction).length();
  appendBelow0(a, b, from.squaredLength() - radius * radius, (reach - across) * (reach + across),
               spans);
}

/// What is in all of `count` sets of ranges, each of them one range or none, appended from `first`
/// on.
void intersectRanges(Spans& spans, std::size_t first, std::size_t count) {
  Interval range = everything();
  const bool none = spans.size() < first + count;
  for (std::size_t n = first; n < spans.size(); ++n) {
    range = {std::max(range.least, spans[n].least), std::min(range.greatest, spans[n].greatest)};
  }
  spans.resize(first);
  if (!none && range.least < range.greatest) spans.push_back(range);
}

/// Appends where a line is in a cylinder around the axis from the origin, between `least` and
/// `greatest` along it.
void appendCylinder(const Vec3& from, const Vec3& direction, const Vec3& axis, const Interval& ends,
                    double radius, Spans& spans) {
  const std::size_t first = spans.size();
  const double along = axis.dot(direction);
  const double at = axis.dot(from);
  appendSlab(along, at - (ends.least + ends.greatest) / 2, (ends.greatest - ends.least) / 2, spans);
  appendBall(from - axis * at, direction - axis * along, radius, spans);
  intersectRanges(spans, first, 2);
}

struct Sphere {
  static constexpr bool kUnitGradient = true;
  Vec3 centre;
  double radius;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    return length(Triple<T>{x - centre[0], y - centre[1], z - centre[2]}) - radius;
  }
  [[nodiscard]] Box extent() const { return boxAround(centre, Vec3(radius)); }
  [[nodiscard]] bool insideAlong(const Vec3& from, const Vec3& direction, Spans& spans) const {
    appendBall(from - centre, direction, radius, spans);
    return true;
  }
};

struct Segment {
  static constexpr bool kUnitGradient = true;
  Vec3 a, b;
  double radius;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const Vec3 along = b - a;
    const Triple<T> p{x - a[0], y - a[1], z - a[2]};
    const double squared = along.squaredLength();
    const T t = min(max(dot(squared > 0 ? along / squared : along, p), 0.0), 1.0);
    return length(Triple<T>{p[0] - along[0] * t, p[1] - along[1] * t, p[2] - along[2] * t}) -
           radius;
  }
  [[nodiscard]] Box extent() const { return grown({minVec3(a, b), maxVec3(a, b)}, radius); }
  [[nodiscard]] bool insideAlong(const Vec3& from, const Vec3& direction, Spans& spans) const {
    const std::size_t first = spans.size();
    const double length = (b - a).length();
    appendBall(from - a, direction, radius, spans);
    if (length > 0) {
      appendBall(from - b, direction, radius, spans);
      appendCylinder(from - a, direction, (b - a) / length, {0, length}, radius, spans);
    }
    uniteFrom(spans, first);
    return true;
  }
};

struct Circle {
  static constexpr bool kUnitGradient = true;
  Vec3 centre, normal, u, v;
  double circle;
  double radius;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const Triple<T> p{x - centre[0], y - centre[1], z - centre[2]};
    const T out = length(dot(u, p), dot(v, p)) - circle;
    const T up = dot(normal, p);
    const T middle = length(out, up);
    const T distance = middle - radius;
    if (radius <= circle) return distance;
    // The sides of a thick tube meet on the axis: where the nearest place of the tube would lie
    // behind it, the one where they meet is nearest.
    const double pole = std::sqrt((radius - circle) * (radius + circle));
    const T behind = circle * middle + radius * out;
    return choose(behind, -length(out + circle, abs(up) - pole), distance);
  }
  [[nodiscard]] Box extent() const {
    Vec3 half(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half[axis] = circle * std::sqrt(std::max(0.0, 1 - normal[axis] * normal[axis])) + radius;
    }
    return boxAround(centre, half);
  }
};

struct RoundBox {
  static constexpr bool kUnitGradient = true;
  Vec3 centre, half;
  double radius;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const Triple<T> q{abs(x - centre[0]) - (half[0] - radius),
                      abs(y - centre[1]) - (half[1] - radius),
                      abs(z - centre[2]) - (half[2] - radius)};
    const T outside = length(Triple<T>{max(q[0], 0.0), max(q[1], 0.0), max(q[2], 0.0)});
    return outside + min(max(q[0], max(q[1], q[2])), 0.0) - radius;
  }
  [[nodiscard]] Box extent() const { return boxAround(centre, half); }
  [[nodiscard]] bool insideAlong(const Vec3& from, const Vec3& direction, Spans& spans) const {
    if (radius > 0) return false;
    const std::size_t first = spans.size();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      appendSlab(direction[axis], from[axis] - centre[axis], half[axis], spans);
    }
    intersectRanges(spans, first, 3);
    return true;
  }
};

struct Plane {
  static constexpr bool kUnitGradient = true;
  Vec3 normal;
  double level;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    return dot(normal, Triple<T>{x, y, z}) - level;
  }
  [[nodiscard]] Box extent() const {
    Box box = wholeSpace();
    Vec3 least = box.least;
    Vec3 greatest = box.greatest;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (normal[axis] == 1) greatest[axis] = level;
      if (normal[axis] == -1) least[axis] = -level;
    }
    return {least, greatest};
  }
  [[nodiscard]] bool insideAlong(const Vec3& from, const Vec3& direction, Spans& spans) const {
    appendHalf(normal.dot(direction), normal.dot(from) - level, spans);
    return true;
  }
};

struct Cylinder {
  static constexpr bool kUnitGradient = true;
  Vec3 centre, axis, u, v;
  double half;
  double radius;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const Triple<T> p{x - centre[0], y - centre[1], z - centre[2]};
    const T side = length(dot(u, p), dot(v, p)) - radius;
    const T end = abs(dot(axis, p)) - half;
    return length(max(side, 0.0), max(end, 0.0)) + min(max(side, end), 0.0);
  }
  [[nodiscard]] Box extent() const {
    Vec3 reach(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      reach[i] =
          std::abs(axis[i]) * half + radius * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
    }
    return boxAround(centre, reach);
  }
  [[nodiscard]] bool insideAlong(const Vec3& from, const Vec3& direction, Spans& spans) const {
    appendCylinder(from - centre, direction, axis, {-half, half}, radius, spans);
    return true;
  }
};

}  // namespace

FieldPtr makeSphere(const Vec3& centre, double radius) { return fieldOf(Sphere{centre, radius}); }

FieldPtr makeSegment(const Vec3& a, const Vec3& b, double radius) {
  return fieldOf(Segment{a, b, radius});
}

FieldPtr makePolyline(const std::vector<Vec3>& points, double radius) {
  std::vector<FieldPtr> segments;
  for (std::size_t n = 1; n < points.size(); ++n) {
    segments.push_back(makeSegment(points[n - 1], points[n], radius));
  }
  return combine(Operation::Union, std::move(segments), 0);
}

FieldPtr makeCircle(const Vec3& centre, const Vec3& normal, double circle, double radius) {
  const Vec3 unit = normal.unitOrX();
  const auto [u, v] = frameOf(unit);
  return fieldOf(Circle{centre, unit, u, v, circle, radius});
}

FieldPtr makeBox(const Vec3& centre, const Vec3& half, double radius) {
  return fieldOf(RoundBox{centre, half, radius});
}

FieldPtr makePlane(const Vec3& point, const Vec3& normal) {
  const Vec3 unit = normal.unitOrX();
  return fieldOf(Plane{unit, unit.dot(point)});
}

FieldPtr makeCylinder(const Vec3& a, const Vec3& b, double radius) {
  const Vec3 axis = (b - a).unitOrX();
  const auto [u, v] = frameOf(axis);
  return fieldOf(Cylinder{(a + b) * 0.5, axis, u, v, (b - a).length() / 2, radius});
}

}  // namespace tufa::implicit
