#include "implicit/near_field.h"

#include "implicit/boxes.h"
#include "implicit/interval.h"

namespace tufa::implicit {
namespace {

class NearField final : public Field {
 public:
  NearField(const Field& whole, const NearBounds& bounds) : whole_(whole), bounds_(bounds) {}

  [[nodiscard]] double value(const Position& p) const override { return whole_.value(p); }
  [[nodiscard]] Position gradient(const Position& p) const override { return whole_.gradient(p); }
  [[nodiscard]] double distance(const Position& p, double reach) const override {
    return whole_.distance(p, reach);
  }
  [[nodiscard]] bool hasUnitGradient() const override { return whole_.hasUnitGradient(); }
  [[nodiscard]] Box extent() const override { return whole_.extent(); }
  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    return whole_.restricted(box);
  }

  [[nodiscard]] Interval bound(const Box& box) const override {
    if (!holds(box)) return whole_.bound(box);
    return aroundCentre(value(centreOf(box)), bounds_.steepest, box);
  }
  [[nodiscard]] double lipschitz(const Box& box) const override {
    return holds(box) ? bounds_.steepest : whole_.lipschitz(box);
  }
  // Around the gradient in the centre.
  [[nodiscard]] Box gradientBound(const Box& box) const override {
    if (!holds(box)) return whole_.gradientBound(box);
    const Vec3 centre = gradient(centreOf(box));
    const double change = bounds_.curvature * halfOf(box).length();
    const Box around = grown({centre, centre}, (change + 1e-12 * centre.length()) * (1 + 1e-9));
    const Vec3 steepest(bounds_.steepest);
    return both({-steepest, steepest}, around);
  }

 private:
  [[nodiscard]] bool holds(const Box& box) const {
    const Box all = hull(bounds_.box, box);
    return all.least == bounds_.box.least && all.greatest == bounds_.box.greatest;
  }

  const Field& whole_;
  NearBounds bounds_;
};

}  // namespace

FieldPtr makeNearField(const Field& whole, const NearBounds& bounds) {
  return std::make_shared<NearField>(whole, bounds);
}

}  // namespace tufa::implicit
