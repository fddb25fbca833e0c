// Fields moved, turned, scaled, mirrored and repeated.

#include <tufa/implicit.h>

#include <cmath>
#include <utility>

#include "implicit/boxes.h"
#include "implicit/fields.h"
#include "implicit/interval.h"
#include "implicit/spans.h"

namespace tufa::implicit {
namespace {

/// The box around a box's image.
Box imageOf(const Affine& map, const Box& box) {
  Vec3 least(0.0);
  Vec3 greatest(0.0);
  for (std::size_t row = 0; row < 3; ++row) {
    Interval side{map.shift[row], map.shift[row]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (map.rows[row][axis] == 0) continue;
      side = side + map.rows[row][axis] * sideOf(box, axis);
    }
    least[row] = side.least;
    greatest[row] = side.greatest;
  }
  return {least, greatest};
}

class Transformed final : public Field {
 public:
  /// `toPart` takes world points to the part's space.
  Transformed(FieldPtr part, const Affine& toPart) : part_(std::move(part)), toPart_(toPart) {
    scale_ = 1 / std::cbrt(std::abs(toPart.determinant()));
    // A bound of the longest image of a unit vector, exact where all shapes are kept.
    double frobenius = 0;
    double spread = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      frobenius += toPart.rows[i].squaredLength();
      for (std::size_t j = 0; j < 3; ++j) {
        const double target = i == j ? 1 / (scale_ * scale_) : 0;
        spread = std::max(spread, std::abs(toPart.rows[i].dot(toPart.rows[j]) - target));
      }
    }
    keepsShapes_ = spread * scale_ * scale_ < 1e-12;
    stretch_ = keepsShapes_ ? 1 : scale_ * std::sqrt(frobenius);
  }

  [[nodiscard]] double value(const Position& p) const override {
    return scale_ * part_->value(toPart_(p));
  }
  [[nodiscard]] Position gradient(const Position& p) const override {
    const Vec3 inner = part_->gradient(toPart_(p));
    return (toPart_.rows[0] * inner[0] + toPart_.rows[1] * inner[1] + toPart_.rows[2] * inner[2]) *
           scale_;
  }
  [[nodiscard]] Interval bound(const Box& box) const override {
    const Box inner = imageOf(toPart_, box);
    const Interval around = scale_ * part_->bound(inner);
    // The image of a box fits its own box only where both have the same axes.
    const double slope = stretch_ * part_->lipschitz(inner);
    return both(around, aroundCentre(value(centreOf(box)), slope, box));
  }
  [[nodiscard]] double lipschitz(const Box& box) const override {
    return stretch_ * part_->lipschitz(imageOf(toPart_, box));
  }
  [[nodiscard]] Box gradientBound(const Box& box) const override {
    const Box inner = part_->gradientBound(imageOf(toPart_, box));
    std::array<Interval, 3> slopes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vec3 column(toPart_.rows[0][axis], toPart_.rows[1][axis], toPart_.rows[2][axis]);
      slopes[axis] = scale_ * dot(column, inner);
    }
    return boxOf(slopes);
  }
  [[nodiscard]] bool hasUnitGradient() const override {
    return keepsShapes_ && part_->hasUnitGradient();
  }
  [[nodiscard]] double distance(const Position& p, double reach) const override {
    return keepsShapes_ ? scale_ * part_->distance(toPart_(p), reach / scale_)
                        : Field::distance(p, reach);
  }
  [[nodiscard]] Box extent() const override { return imageOf(toPart_.inverse(), part_->extent()); }
  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    FieldPtr inner = part_->restricted(imageOf(toPart_, box));
    return inner ? std::make_shared<Transformed>(std::move(inner), toPart_) : nullptr;
  }
  // Such a map keeps where a line's points are along it.
  [[nodiscard]] bool insideAlong(const Line& line, double begin, double end,
                                 std::vector<Interval>& spans) const override {
    return part_->insideAlong({toPart_(line.from), toPart_.turn(line.direction)}, begin, end,
                              spans);
  }

 private:
  FieldPtr part_;
  Affine toPart_;
  double scale_;        ///< of lengths, from the part to the world
  double stretch_ = 1;  ///< most that the map lengthens, beside that
  bool keepsShapes_ = false;
};

/// Range of copies along the three axes.
struct Copies {
  std::array<double, 3> first;
  std::array<double, 3> last;
};

class Repeated final : public Field {
 public:
  Repeated(FieldPtr part, const Vec3& steps, const std::array<std::int64_t, 3>& counts)
      : part_(std::move(part)), steps_(steps), counts_(counts), extent_(part_->extent()) {}

  [[nodiscard]] double value(const Position& p) const override { return part_->value(nearest(p)); }
  [[nodiscard]] Position gradient(const Position& p) const override {
    return part_->gradient(nearest(p));
  }
  [[nodiscard]] double distance(const Position& p, double reach) const override {
    double least = kInfinity;
    forCopies(around(p), [&](const Vec3& shift) {
      least = std::min(least, part_->distance(Vec3(p) - shift, reach));
    });
    return least;
  }
  [[nodiscard]] Interval bound(const Box& box) const override {
    const Copies copies = around(box);
    if (!fewEnough(copies)) return part_->bound(seenFrom(box));
    Interval all{kInfinity, kInfinity};
    forCopies(copies, [&](const Vec3& shift) { all = min(all, part_->bound(moved(box, shift))); });
    return all;
  }
  [[nodiscard]] double lipschitz(const Box& box) const override {
    return part_->lipschitz(seenFrom(box));
  }
  [[nodiscard]] Box gradientBound(const Box& box) const override {
    const Copies copies = around(box);
    if (!fewEnough(copies)) return part_->gradientBound(seenFrom(box));
    Box all{Vec3(kInfinity), Vec3(-kInfinity)};
    forCopies(copies,
              [&](const Vec3& shift) { all = hull(all, part_->gradientBound(moved(box, shift))); });
    return all;
  }
  [[nodiscard]] bool hasUnitGradient() const override { return part_->hasUnitGradient(); }
  [[nodiscard]] Box extent() const override {
    Vec3 reach(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      reach[axis] = steps_[axis] * static_cast<double>(counts_[axis] - 1);
    }
    return {extent_.least, Vec3(extent_.greatest) + reach};
  }
  // Where all points have the same nearest copy, what is asked are the same copies: a union of
  // them.
  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Interval side = sideOf(box, axis);
      if (copyAt(side.least, axis) != copyAt(side.greatest, axis)) return nullptr;
    }
    std::vector<FieldPtr> copies;
    forCopies(around(box), [&](const Vec3& shift) {
      Affine map;
      map.shift = shift;
      copies.push_back(transformed(part_, map));
    });
    FieldPtr all = combine(Operation::Union, std::move(copies), 0);
    FieldPtr fewer = all->restricted(box);
    return fewer ? fewer : all;
  }
  [[nodiscard]] bool insideAlong(const Line& line, double begin, double end,
                                 std::vector<Interval>& spans) const override {
    const std::size_t first = spans.size();
    const Vec3 from = line.from;
    const Vec3 direction = line.direction;
    const Vec3 a = from + direction * begin;
    const Vec3 b = from + direction * end;
    bool closed = true;
    forCopies(around(Box{minVec3(a, b), maxVec3(a, b)}), [&](const Vec3& shift) {
      closed = closed && part_->insideAlong({from - shift, direction}, begin, end, spans);
    });
    if (closed) {
      uniteFrom(spans, first);
    } else {
      spans.resize(first);
    }
    return closed;
  }

 private:
  /// To be looked at one by one.
  static bool fewEnough(const Copies& copies) {
    constexpr double kMost = 64;
    double count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      count *= copies.last[axis] - copies.first[axis] + 1;
    }
    return count <= kMost;
  }
  static Box moved(const Box& box, const Vec3& shift) {
    return {Vec3(box.least) - shift, Vec3(box.greatest) - shift};
  }
  /// The copy whose box's centre is nearest to a coordinate.
  [[nodiscard]] double copyAt(double x, std::size_t axis) const {
    if (counts_[axis] == 1) return 0;
    const double copy = std::round((x - centreOf(extent_)[axis]) / steps_[axis]);
    return std::clamp(copy, 0.0, static_cast<double>(counts_[axis] - 1));
  }
  /// Those copies that are asked for a value somewhere in a box: the ones on either side of the
  /// nearest too, whose solid may be nearer.
  [[nodiscard]] Copies around(const Box& box) const {
    Copies copies{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Interval side = sideOf(box, axis);
      const double last = static_cast<double>(counts_[axis] - 1);
      copies.first[axis] = std::max(copyAt(side.least, axis) - 1, 0.0);
      copies.last[axis] = std::min(copyAt(side.greatest, axis) + 1, last);
    }
    return copies;
  }
  [[nodiscard]] Copies around(const Position& p) const { return around(Box{p, p}); }

  template <class Visit>
  void forCopies(const Copies& copies, const Visit& visit) const {
    for (double x = copies.first[0]; x <= copies.last[0]; ++x) {
      for (double y = copies.first[1]; y <= copies.last[1]; ++y) {
        for (double z = copies.first[2]; z <= copies.last[2]; ++z) {
          visit(Vec3(x * steps_[0], y * steps_[1], z * steps_[2]));
        }
      }
    }
  }

  /// The point in the space of the copy of least value.
  [[nodiscard]] Position nearest(const Position& p) const {
    Vec3 best = p;
    double least = kInfinity;
    forCopies(around(p), [&](const Vec3& shift) {
      const double value = part_->value(Vec3(p) - shift);
      if (value >= least) return;
      least = value;
      best = Vec3(p) - shift;
    });
    return best;
  }

  /// Where the copies asked for see a box: within a step and a half of their centre, further out
  /// only before the first and behind the last.
  [[nodiscard]] Box seenFrom(const Box& box) const {
    const Vec3 centre = centreOf(extent_);
    Vec3 least(0.0);
    Vec3 greatest(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Interval side = sideOf(box, axis);
      least[axis] = side.least;
      greatest[axis] = side.greatest;
      if (counts_[axis] == 1) continue;
      const double step = steps_[axis];
      const double end = step * static_cast<double>(counts_[axis] - 1);
      least[axis] = std::min(centre[axis] - 1.5 * step, side.least - step);
      least[axis] = std::max(least[axis], side.least - end);
      greatest[axis] = std::max(centre[axis] + 1.5 * step, side.greatest - end + step);
      greatest[axis] = std::min(greatest[axis], side.greatest);
    }
    return {least, greatest};
  }

  FieldPtr part_;
  Vec3 steps_;
  std::array<std::int64_t, 3> counts_;
  Box extent_;
};

}  // namespace

Affine Affine::then(const Affine& next) const {
  Affine both;
  for (std::size_t row = 0; row < 3; ++row) {
    both.rows[row] =
        rows[0] * next.rows[row][0] + rows[1] * next.rows[row][1] + rows[2] * next.rows[row][2];
  }
  both.shift = next(shift);
  return both;
}

Affine Affine::inverse() const {
  const double factor = 1 / determinant();
  const Vec3 a = rows[1].cross(rows[2]) * factor;
  const Vec3 b = rows[2].cross(rows[0]) * factor;
  const Vec3 c = rows[0].cross(rows[1]) * factor;
  Affine back;
  for (std::size_t row = 0; row < 3; ++row) back.rows[row] = Vec3(a[row], b[row], c[row]);
  back.shift = -back.turn(shift);
  return back;
}

FieldPtr transformed(FieldPtr part, const Affine& map) {
  return std::make_shared<Transformed>(std::move(part), map.inverse());
}

FieldPtr repeated(FieldPtr part, const Vec3& steps, const std::array<std::int64_t, 3>& counts) {
  return std::make_shared<Repeated>(std::move(part), steps, counts);
}

}  // namespace tufa::implicit
