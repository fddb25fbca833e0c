#include "rays/field_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "implicit/boxes.h"
#include "implicit/interval.h"

namespace tufa::rays {
namespace {

using implicit::Box;
using implicit::Field;
using implicit::Interval;

/// A part of the stretch that is still open. Its beginning is on the first side.
struct Part {
  double begin;
  double end;
  bool crosses;  ///< its end is on the other side
};

/// Parts so short, compared with coordinates, are not halved any further.
constexpr double kShortest = 1e-13;
/// What of the values rounding may hide, compared with coordinates times slope.
constexpr double kHidden = 1e-14;

class Search {
 public:
  Search(const Field& field, const Slopes& slopes, const Stretch& stretch, bool inside, int& looks)
      : field_(field), slopes_(slopes), stretch_(stretch), inside_(inside), looks_(looks) {
    const double ends = std::max(Vec3(at(stretch.begin)).length(), Vec3(at(stretch.end)).length());
    scale_ = std::max({ends, std::abs(stretch.begin), std::abs(stretch.end)});
  }

  [[nodiscard]] std::optional<double> run() {
    const Part all{stretch_.begin, stretch_.end, false};
    const Interval along = dot(stretch_.direction, slopes_.gradient);
    if (along.least > 0 || along.greatest < 0) {
      if (changed(all.end)) return onlyRoot(all);
      return std::nullopt;
    }
    push(all);
    while (depth_ > 0) {
      if (const auto found = look(open_[--depth_])) return found;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] Position at(double t) const { return stretch_.from + stretch_.direction * t; }
  [[nodiscard]] bool changed(double t) const { return (field_.value(at(t)) < 0) != inside_; }

  [[nodiscard]] std::optional<double> look(const Part part) {
    const double middle = (part.begin + part.end) / 2;
    const double half = (part.end - part.begin) / 2;
    const double value = field_.value(at(middle));
    if ((value < 0) != inside_) {
      // Nothing behind it is the first place.
      depth_ = 0;
      if (half <= kShortest * scale_) return middle;
      push({part.begin, middle, true});
      return std::nullopt;
    }
    // Infinite where there is no bound: nothing is above that.
    const double change = slopes_.steepest * (half + kHidden * scale_);
    if (!part.crosses && std::abs(value) > change) return std::nullopt;
    const Position a = at(part.begin);
    const Position b = at(part.end);
    // Ends are rounded: by less than this.
    const Box box = implicit::grown({minVec3(a, b), maxVec3(a, b)},
                                    scale_ * std::numeric_limits<double>::epsilon());
    const Box slopes = field_.gradientBound(box);
    const Interval along = dot(stretch_.direction, slopes);
    if (along.least > 0 || along.greatest < 0) {
      if (part.crosses || changed(part.end)) return onlyRoot(part);
      return std::nullopt;
    }
    if (!part.crosses) {
      const Interval range = value + along * Interval{-half, half};
      const double steepest = std::max(Vec3(slopes.least).length(), Vec3(slopes.greatest).length());
      const double hidden = kHidden * scale_ * steepest;
      if (isOneSide(range, hidden < implicit::kInfinity ? hidden : 0)) return std::nullopt;
      if (isOneSide(field_.bound(box), 0)) return std::nullopt;
    }
    const bool usedUp = looks_ == 0;
    if (!usedUp) --looks_;
    if (half <= kShortest * scale_ || (usedUp && !part.crosses)) {
      if (part.crosses) return part.end;
      return std::nullopt;
    }
    push({middle, part.end, part.crosses});
    push({part.begin, middle, false});
    return std::nullopt;
  }

  void push(const Part& part) { open_[depth_++] = part; }

  /// Whether values that are off by so much are all on the first side.
  [[nodiscard]] bool isOneSide(const Interval& values, double hidden) const {
    return inside_ ? values.greatest < hidden : values.least >= -hidden;
  }

  /// The crossing of a part with one: false position that halves where it is slow (the Illinois
  /// variant).
  [[nodiscard]] double onlyRoot(const Part& part) const {
    constexpr int kMostSteps = 100;
    double a = part.begin;
    double b = part.end;
    double valueA = field_.value(at(a));
    double valueB = field_.value(at(b));
    for (int n = 0; n < kMostSteps && std::abs(b - a) > kShortest * scale_; ++n) {
      const double share = valueA / (valueA - valueB);
      // Values such as 0 or infinity at an end tell nothing of the place.
      const bool usable = share > 0 && share < 1;
      const double middle = usable ? a + (b - a) * share : (a + b) / 2;
      const double value = field_.value(at(middle));
      if (value == 0 || middle == a || middle == b) return middle;
      if ((value < 0) == (valueB < 0)) {
        valueA /= 2;
      } else {
        a = b;
        valueA = valueB;
      }
      b = middle;
      valueB = value;
    }
    return b;
  }

  const Field& field_;
  const Slopes& slopes_;
  const Stretch& stretch_;
  bool inside_;
  int& looks_;        ///< that are left
  double scale_ = 0;  ///< of coordinates and distances
  // One part waits for each halving: of twice the scale at most, down to the shortest.
  std::array<Part, 64> open_;
  std::size_t depth_ = 0;
};

}  // namespace

std::optional<double> firstCrossing(const Field& field, const Slopes& slopes,
                                    const Stretch& stretch, bool inside, int& looks) {
  return Search(field, slopes, stretch, inside, looks).run();
}

std::optional<double> firstRoot(const Field& field, const Stretch& stretch, bool inside,
                                implicit::Spans& spans) {
  // From the middle, so that terms do not cancel.
  const double middle = (stretch.begin + stretch.end) / 2;
  const double half = (stretch.end - stretch.begin) / 2;
  const Vec3 from = stretch.from + stretch.direction * middle;
  spans.clear();
  if (!field.insideAlong({from, stretch.direction}, -half, half, spans)) return std::nullopt;
  implicit::dropShort(spans, kShortest * std::max(from.length(), std::abs(middle)));
  for (const Interval& span : spans) {
    if (span.greatest <= -half) continue;
    if (span.least > half) break;
    // Where it begins, unless a ray from inside leaves it.
    const double place = inside ? span.greatest : span.least;
    if (inside && span.least > -half) return stretch.begin;
    if (place > half) return std::nullopt;
    return middle + std::max(place, -half);
  }
  if (inside) return stretch.begin;
  return std::nullopt;
}

}  // namespace tufa::rays
