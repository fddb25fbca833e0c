#include "implicit/convolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/box.h"
#include "implicit/boxes.h"
#include "implicit/dual.h"
#include "implicit/formula_field.h"
#include "implicit/kernel_profile.h"
#include "implicit/near_field.h"
#include "implicit/triple.h"

namespace tufa::implicit {
namespace {

constexpr double kPi = std::numbers::pi;

template <class T>
Triple<T> minus(const Triple<T>& p, const Vec3& q) {
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}

double arctangent(double y, double x) { return std::atan2(y, x); }
Dual<double> arctangent(const Dual<double>& y, const Dual<double>& x) {
  const double squared = square(x.value) + square(y.value);
  Dual<double> angle{std::atan2(y.value, x.value), {}};
  for (std::size_t i = 0; i < 3; ++i) {
    angle.slopes[i] = (x.value * y.slopes[i] - y.value * x.slopes[i]) / squared;
  }
  return angle;
}
double plain(double x) { return x; }
double plain(const Dual<double>& x) { return x.value; }

// Lengths below are in widths of the kernel.

/// Over the part from u1 to u2 of a line; `h2` is the squared distance from it, and u counts from
/// the foot of the point. Divided by the integral over the whole line.
template <class T>
T overLine(ConvolutionKernel kernel, const T& h2, const T& u1, const T& u2) {
  if (kernel == ConvolutionKernel::Gaussian) return exp(-h2) * (erf(u2) - erf(u1)) * 0.5;
  if (kernel == ConvolutionKernel::Polynomial) {
    if (plain(h2) >= 1) return h2 * 0.0;
    const T q = 1.0 - h2;
    const T end = sqrt(q);
    const auto upTo = [&](const T& at) {
      const T u = max(min(at, end), -end);
      const T v = square(u);
      return u * (square(q) - q * v * (2.0 / 3) + square(v) * 0.2);
    };
    return (upTo(u2) - upTo(u1)) * (15.0 / 16);
  }
  const T p2 = h2 + 1.0;
  const T p = sqrt(p2);
  const auto upTo = [&](const T& u) {
    return u / (p2 * (p2 + square(u))) + atan(u / p) / (p2 * p);
  };
  return (upTo(u2) - upTo(u1)) / kPi;
}

template <class T>
T integral(const SkeletonSegment& segment, ConvolutionKernel kernel, double width,
           const Triple<T>& point) {
  const Vec3 along = (segment.b - segment.a) / width;
  const double length = along.length();
  const Vec3 unit = along / length;
  const Triple<T> p = minus(point, segment.a);
  const Triple<T> q{p[0] / width, p[1] / width, p[2] / width};
  const T foot = dot(unit, q);
  const T x = q[0] - unit[0] * foot;
  const T y = q[1] - unit[1] * foot;
  const T z = q[2] - unit[2] * foot;
  return overLine<T>(kernel, square(x) + square(y) + square(z), -foot, length - foot);
}

/// By the theorem of Gauss, with the foot of the point in the plane as origin: a sum over the edges
/// of integrals of what a sector holds.
template <class T>
T integral(const SkeletonTriangle& triangle, ConvolutionKernel /*kernel*/, double width,
           const Triple<T>& point) {
  const std::array<Vec3, 3> corners{triangle.a / width, triangle.b / width, triangle.c / width};
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).unitOrX();
  const Triple<T> q{point[0] / width, point[1] / width, point[2] / width};
  const T height = dot(normal, minus(q, corners[0]));
  const T p2 = square(height) + 1.0;
  T sum = height * 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    const double length = edge.length();
    const Vec3 along = edge / length;
    const Triple<T> from = minus(q, corners[k]);
    const T inward = dot(normal.cross(along), from);
    const T foot = dot(along, from);
    const T m = sqrt(p2 + square(inward));
    sum = sum + inward / (p2 * m) * (atan((length - foot) / m) - atan(-foot / m));
  }
  return sum / (2 * kPi);
}

template <class T>
T integral(const SkeletonArc& arc, ConvolutionKernel /*kernel*/, double width,
           const Triple<T>& point) {
  const double radius = arc.start.length() / width;
  const Vec3 u = arc.start.unitOrX();
  const Vec3 v = arc.axis.cross(u);
  const Triple<T> from = minus(point, arc.centre);
  T x = dot(u, from) / width;
  const T y = dot(v, from) / width;
  const T z = dot(arc.axis, from) / width;
  // On the axis no direction is nearest, and the integral does not depend on it.
  constexpr double kBeside = 1e-9;
  if (square(plain(x)) + square(plain(y)) < square(kBeside)) x = x + kBeside;
  const T r = sqrt(square(x) + square(y));
  const T angle = arctangent(y, x);
  // The squared distance plus one, at an angle t from the point's: a - b cos t.
  const T a = square(r) + square(z) + (1 + radius * radius);
  const T b = r * (2 * radius);
  const T root2 = (a - b) * (a + b);
  const T root = sqrt(root2);
  const T stretch = sqrt((a + b) / (a - b));
  const auto upTo = [&](const T& t) {
    // The arctangent is one of half a turn; further ones add up.
    const double turns = std::round(plain(t) / (2 * kPi));
    const T within = t - turns * 2 * kPi;
    const T halfAngle = within * 0.5;
    const T tangent = sin(halfAngle) / cos(halfAngle);
    const T simple = (atan(stretch * tangent) * 2.0 + turns * 2 * kPi) / root;
    return b * sin(within) / (root2 * (a - b * cos(within))) + a * simple / root2;
  };
  return (upTo(arc.angle - angle) - upTo(-angle)) * (radius * 2 / kPi);
}

/// A small part of a skeleton, for bounds: all of it lies in a ball.
struct Piece {
  Vec3 centre{0.0};
  double radius = 0;
  double size = 0;  ///< length or area
};

/// Pieces of half a width, as far as that is not too many.
std::vector<Piece> piecesOf(const SkeletonSegment& segment, double width) {
  constexpr double kMost = 256;
  const Vec3 along = segment.b - segment.a;
  const double count = std::clamp(std::ceil(2 * along.length() / width), 1.0, kMost);
  std::vector<Piece> pieces;
  for (double n = 0; n < count; ++n) {
    const double length = along.length() / count;
    pieces.push_back({segment.a + along * ((n + 0.5) / count), length / 2, length});
  }
  return pieces;
}
std::vector<Piece> piecesOf(const SkeletonArc& arc, double width) {
  constexpr double kLeast = 4;
  constexpr double kMost = 256;
  const double length = arc.start.length() * arc.angle;
  const double count = std::clamp(std::ceil(2 * length / width), kLeast, kMost);
  const Vec3 across = arc.axis.cross(arc.start);
  std::vector<Piece> pieces;
  for (double n = 0; n < count; ++n) {
    const double angle = arc.angle * (n + 0.5) / count;
    const Vec3 middle = arc.centre + arc.start * std::cos(angle) + across * std::sin(angle);
    // An arc is no further from its middle than along itself.
    pieces.push_back({middle, length / count / 2, length / count});
  }
  return pieces;
}
std::vector<Piece> piecesOf(const SkeletonTriangle& triangle, double width) {
  constexpr double kMost = 24;
  const Vec3 u = triangle.b - triangle.a;
  const Vec3 v = triangle.c - triangle.a;
  const double longest = std::max({u.length(), v.length(), (u - v).length()});
  const double count = std::clamp(std::ceil(2 * longest / width), 1.0, kMost);
  // All are alike, or turned by half a turn.
  const Vec3 third = (u + v) / (3 * count);
  const double radius =
      std::max({third.length(), (u / count - third).length(), (v / count - third).length()});
  const double area = u.cross(v).length() / 2 / (count * count);
  std::vector<Piece> pieces;
  for (double i = 0; i < count; ++i) {
    for (double j = 0; i + j < count; ++j) {
      const Vec3 corner = triangle.a + (u * i + v * j) / count;
      pieces.push_back({corner + third, radius, area});
      if (i + j + 1 < count) pieces.push_back({corner + third * 2.0, radius, area});
    }
  }
  return pieces;
}

/// A part, and what its bounds are taken from. Sizes are such that the kernel's integral over a
/// line or a plane without end is 1.
struct BoundedPart {
  SkeletonPart part;
  std::vector<Piece> pieces;
};

class Convolution final : public Field {
 public:
  Convolution(std::vector<BoundedPart> parts, const ConvolutionOptions& options)
      : parts_(std::move(parts)), options_(options), profile_{options.kernel} {}

  [[nodiscard]] double value(const Position& p) const override {
    return at<double>({p.x, p.y, p.z});
  }
  [[nodiscard]] Position gradient(const Position& p) const override {
    const auto slopes = at<Dual<double>>(variables<double>(p.x, p.y, p.z, 1)).slopes;
    return {slopes[0], slopes[1], slopes[2]};
  }

  [[nodiscard]] Interval bound(const Box& box) const override {
    double above = 0;
    double below = 0;
    double steepest = 0;
    forPieces(box, [&](double weight, const Piece& piece, double distance) {
      const double most = weight * piece.size * profile_.value(distance) * (1 + 1e-9);
      (weight > 0 ? above : below) += most;
      steepest += steepestOf(weight, piece, distance);
    });
    return both({options_.threshold - above, options_.threshold - below},
                aroundCentre(value(centreOf(box)), steepest, box));
  }

  [[nodiscard]] double lipschitz(const Box& box) const override {
    double steepest = 0;
    forPieces(box, [&](double weight, const Piece& piece, double distance) {
      steepest += steepestOf(weight, piece, distance);
    });
    return steepest;
  }

  [[nodiscard]] Box gradientBound(const Box& box) const override {
    if (!isFinite(box)) return Field::gradientBound(box);
    return makeNearField(*this, boundsNear(box))->gradientBound(box);
  }

  // Beyond the distance where the bounds of all parts together are below the threshold.
  [[nodiscard]] Box extent() const override {
    Box all = boxAround(parts_[0].pieces[0].centre, Vec3(0.0));
    double size = 0;
    for (const BoundedPart& part : parts_) {
      for (const Piece& piece : part.pieces) {
        all = hull(all, boxAround(piece.centre, Vec3(piece.radius)));
        if (part.part.weight > 0) size += part.part.weight * piece.size;
      }
    }
    const auto reaches = [&](double widths) {
      return size * profile_.value(widths) > options_.threshold;
    };
    double near = 0;
    double far = 1;
    while (reaches(far)) far *= 2;
    constexpr int kHalvings = 30;
    for (int n = 0; n < kHalvings; ++n) {
      const double middle = (near + far) / 2;
      (reaches(middle) ? near : far) = middle;
    }
    return grown(all, far * options_.width);
  }

  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    if (!(profile_.reach() < kInfinity)) return withNearBounds(box);
    std::vector<BoundedPart> near;
    for (const BoundedPart& part : parts_) {
      const auto reaches = [&](const Piece& piece) {
        return distanceTo(piece, box) < profile_.reach();
      };
      if (std::any_of(part.pieces.begin(), part.pieces.end(), reaches)) near.push_back(part);
    }
    if (near.size() == parts_.size()) return nullptr;
    return std::make_shared<Convolution>(std::move(near), options_);
  }

 private:
  [[nodiscard]] NearBounds boundsNear(const Box& box) const {
    NearBounds bounds{box};
    forPieces(box, [&](double weight, const Piece& piece, double distance) {
      bounds.steepest += steepestOf(weight, piece, distance);
      bounds.curvature += std::abs(weight) * piece.size * profile_.curvatureFrom(distance);
    });
    bounds.curvature *= (1 + 1e-9) / square(options_.width);
    return bounds;
  }
  /// In small boxes bounds of all pieces together are as good as those of each.
  [[nodiscard]] FieldPtr withNearBounds(const Box& box) const {
    constexpr double kSmall = 0.25;
    if (!(halfOf(box).length() < kSmall * options_.width)) return nullptr;
    return makeNearField(*this, boundsNear(box));
  }
  template <class T>
  [[nodiscard]] T at(const Triple<T>& point) const {
    T sum = point[0] * 0.0;
    for (const BoundedPart& part : parts_) {
      const T one = std::visit(
          [&](const auto& shape) {
            return integral<T>(shape, options_.kernel, options_.width, point);
          },
          part.part.shape);
      sum = sum + one * part.part.weight;
    }
    return options_.threshold - sum;
  }

  /// No point of a box is nearer to a piece: in widths.
  [[nodiscard]] double distanceTo(const Piece& piece, const Box& box) const {
    const base::Box bounds{box.least, box.greatest};
    const double near = std::sqrt(bounds.distanceSquared(piece.centre)) - piece.radius;
    return near > 0 ? near * (1 - 1e-12) / options_.width : 0;
  }
  [[nodiscard]] double steepestOf(double weight, const Piece& piece, double distance) const {
    return std::abs(weight) * piece.size * profile_.steepestFrom(distance) / options_.width *
           (1 + 1e-9);
  }

  /// Calls visit(weight, piece, how near a box comes to it in widths) for all pieces.
  template <class Visit>
  void forPieces(const Box& box, const Visit& visit) const {
    for (const BoundedPart& part : parts_) {
      for (const Piece& piece : part.pieces) visit(part.part.weight, piece, distanceTo(piece, box));
    }
  }

  std::vector<BoundedPart> parts_;
  ConvolutionOptions options_;
  Profile profile_;
};

BoundedPart bounded(const SkeletonPart& part, const ConvolutionOptions& options) {
  std::vector<Piece> pieces =
      std::visit([&](const auto& shape) { return piecesOf(shape, options.width); }, part.shape);
  const bool area = std::holds_alternative<SkeletonTriangle>(part.shape);
  const double whole =
      area ? kPi * square(options.width) : Profile{options.kernel}.total() * options.width;
  for (Piece& piece : pieces) piece.size /= whole;
  return {part, std::move(pieces)};
}

}  // namespace

FieldPtr makeConvolution(const std::vector<SkeletonPart>& parts,
                         const ConvolutionOptions& options) {
  std::vector<BoundedPart> all;
  all.reserve(parts.size());
  for (const SkeletonPart& part : parts) all.push_back(bounded(part, options));
  return std::make_shared<Convolution>(std::move(all), options);
}

}  // namespace tufa::implicit
