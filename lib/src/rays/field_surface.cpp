// Rays to the surfaces of fields.

#include <tufa/rays.h>

#include <tufa/error.h>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/box_ray.h"
#include "base/job.h"
#include "implicit/boxes.h"
#include "implicit/spans.h"
#include "rays/field_ray.h"
#include "rays/surface.h"

namespace tufa {
namespace rays {
namespace {

using implicit::Box;
using implicit::Field;

base::Box toBase(const Box& box) { return {box.least, box.greatest}; }

/// A cube of an octree. The surface passes through leaves alone.
struct Cube {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  base::Box box;
  const Field* field = nullptr;  ///< the same values in the box; null where no surface is
  bool inside = false;           ///< of those without surface
  bool closedForm = false;       ///< whether the field knows where lines are inside
  std::uint32_t firstChild = kNone;
  Slopes slopes;  ///< of leaves without closed form
};

/// Bounds that all rays share: cubes without surface, and fields that are quicker in the others.
class FieldSurface final : public RaySurface {
 public:
  FieldSurface(std::shared_ptr<const Field> field, const Box& bounds, base::Job& job)
      : RaySurface(toBase(bounds), skinOf(bounds)), field_(std::move(field)) {
    cubes_.push_back(
        {toBase(bounds), field_.get(), false, hasClosedForm(*field_), Cube::kNone, {}});
    std::size_t begin = 0;
    for (int level = 0; level < kLevels; ++level) {
      job.beginStage("bounds", (level + 1.0) / kLevels);
      const std::size_t end = cubes_.size();
      split(begin, level + 1 == kLevels, job);
      begin = end;
    }
  }

  [[nodiscard]] std::unique_ptr<Caster> caster() const override;

  /// Whether a point within the bounds is inside, by the cube that it lies in.
  [[nodiscard]] bool isInside(const Vec3& point) const {
    const Cube* cube = cubes_.data();
    while (cube->firstChild != Cube::kNone) {
      const Vec3 middle = cube->box.centre();
      const unsigned child = (point[0] >= middle[0] ? 1U : 0U) | (point[1] >= middle[1] ? 2U : 0U) |
                             (point[2] >= middle[2] ? 4U : 0U);
      cube = &cubes_[cube->firstChild + child];
    }
    return cube->field != nullptr ? cube->field->value(point) < 0 : cube->inside;
  }

  /// Calls visit(cube, begin, end) for the parts of a ray in leaves, in their order, until it
  /// returns true.
  template <class Visit>
  void forLeaves(const base::BoxRay& ray, double to, const Visit& visit) const {
    std::array<std::uint32_t, 8 * (kLevels + 1)> open;  // seven wait at each level
    std::size_t depth = 0;
    open[depth++] = 0;
    while (depth > 0) {
      const Cube& cube = cubes_[open[--depth]];
      if (cube.field == nullptr) continue;
      const auto [begin, end] = ray.span(cube.box, to);
      if (!(begin <= end)) continue;
      if (cube.firstChild == Cube::kNone) {
        if (visit(cube, begin, end)) return;
        continue;
      }
      // The children that the ray enters last go to the bottom.
      const unsigned last = (ray.inverse[0] < 0 ? 0U : 1U) | (ray.inverse[1] < 0 ? 0U : 2U) |
                            (ray.inverse[2] < 0 ? 0U : 4U);
      for (unsigned n = 0; n < 8; ++n) open[depth++] = cube.firstChild + (n ^ last);
    }
  }

 private:
  static constexpr int kLevels = 6;

  static bool hasClosedForm(const Field& field) {
    implicit::Spans spans;
    return field.insideAlong({}, 0, 0, spans);
  }

  static double skinOf(const Box& bounds) {
    constexpr double kShare = 1e-7;
    return kShare * implicit::halfOf(bounds).length();
  }

  /// Gives children to all cubes from `begin` on that the surface may pass.
  void split(std::size_t begin, bool leaves, base::Job& job) {
    const std::size_t end = cubes_.size();
    const std::size_t count = end - begin;
    std::vector<std::array<Cube, 8>> children(count);
    std::vector<std::vector<std::shared_ptr<const Field>>> made(count);
    job.forRanges(count, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n) {
        const Cube& cube = cubes_[begin + n];
        if (cube.field != nullptr) children[n] = halved(cube, leaves, made[n]);
      }
    });
    for (std::size_t n = 0; n < count; ++n) {
      if (cubes_[begin + n].field == nullptr) continue;
      cubes_[begin + n].firstChild = static_cast<std::uint32_t>(cubes_.size());
      cubes_.insert(cubes_.end(), children[n].begin(), children[n].end());
      for (auto& field : made[n]) restricted_.push_back(std::move(field));
    }
  }

  static std::array<Cube, 8> halved(const Cube& cube, bool leaves,
                                    std::vector<std::shared_ptr<const Field>>& made) {
    std::array<Cube, 8> children;
    const Vec3 middle = cube.box.centre();
    for (unsigned n = 0; n < 8; ++n) {
      base::Box box = cube.box;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const bool upper = (n >> axis & 1U) != 0;
        (upper ? box.lower : box.upper)[axis] = middle[axis];
      }
      children[n].box = box;
      // Places on a ray are rounded.
      const double room = 1e-12 * (box.lower.length() + box.upper.length());
      const Box around = implicit::grown({box.lower, box.upper}, room);
      const implicit::Interval bound = cube.field->bound(around);
      children[n].inside = bound.greatest < 0;
      if (bound.least > 0 || bound.greatest < 0) continue;
      children[n].field = cube.field;
      children[n].closedForm = cube.closedForm;
      if (auto field = cube.field->restricted(around)) {
        children[n].field = field.get();
        children[n].closedForm = hasClosedForm(*field);
        made.push_back(std::move(field));
      }
      if (leaves && !children[n].closedForm) {
        const Field& own = *children[n].field;
        children[n].slopes = {own.gradientBound(around), own.lipschitz(around)};
      }
    }
    return children;
  }

  std::shared_ptr<const Field> field_;
  std::vector<std::shared_ptr<const Field>> restricted_;  ///< what the cubes refer to
  std::vector<Cube> cubes_;
};

class FieldCaster final : public Caster {
 public:
  explicit FieldCaster(const FieldSurface& surface) : surface_(surface) {}

  [[nodiscard]] std::optional<RayHit> cast(const UnitRay& ray) override {
    const base::BoxRay boxRay(ray.origin, ray.direction, ray.least);
    const auto [begin, end] = boxRay.span(surface_.bounds(), ray.greatest);
    if (!(begin <= end)) return std::nullopt;
    // The bounds are a little larger than what holds all of the inside.
    const bool inside = begin == ray.least && surface_.isInside(ray.at(begin));
    // Some dozens are enough as a rule.
    int looks = 5000;
    std::optional<double> found;
    const Field* field = nullptr;
    surface_.forLeaves(boxRay, ray.greatest, [&](const Cube& cube, double from, double to) {
      const Stretch stretch{ray.origin, ray.direction, from, to};
      found = cube.closedForm ? firstRoot(*cube.field, stretch, inside, spans_)
                              : firstCrossing(*cube.field, cube.slopes, stretch, inside, looks);
      field = cube.field;
      return found.has_value();
    });
    if (!found) return std::nullopt;
    const Vec3 point = ray.at(*found);
    return RayHit{*found, point, static_cast<Normal>(Vec3(field->normal(point)))};
  }

 private:
  const FieldSurface& surface_;
  implicit::Spans spans_;
};

std::unique_ptr<Caster> FieldSurface::caster() const {
  return std::make_unique<FieldCaster>(*this);
}

}  // namespace
}  // namespace rays

std::shared_ptr<const RaySurface> makeRaySurface(std::shared_ptr<const implicit::Field> field,
                                                 const RaySurfaceOptions& options) {
  if (!field) throw Error(ErrorCode::InvalidArgument, "there is no field to cast rays at");
  const implicit::Box extent = field->extent();
  if (!implicit::isFinite(extent)) {
    throw Error(
        ErrorCode::InvalidArgument,
        "the solid may go on for ever; give bounds that it is cut by (implicit::Field::extent())");
  }
  // Beyond it all is outside; where it is closed by bounds, the surface lies in its sides.
  constexpr double kMargin = 1e-4;
  const double margin = kMargin * implicit::halfOf(extent).length();
  base::Job job(options.threads, options.progress);
  std::shared_ptr<const RaySurface> surface;
  job.run([&] {
    surface = std::make_shared<rays::FieldSurface>(std::move(field),
                                                   implicit::grown(extent, margin), job);
  });
  job.finish();
  return surface;
}

}  // namespace tufa
