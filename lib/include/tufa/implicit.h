#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tufa {
struct FileBytes;
}

/// Solids given by formulas: a field is a function of space, negative inside. tufa::voxelize() of
/// <tufa/voxelize.h> makes level sets of them.
namespace tufa::implicit {

/// A range of numbers; the ends may be infinite.
struct Interval {
  double least = 0;     ///< lower end
  double greatest = 0;  ///< upper end
};

/// An axis-aligned box in world space; sides may be infinite.
struct Box {
  Position least{0, 0, 0};     ///< corner
  Position greatest{0, 0, 0};  ///< opposite corner
};

/// The points from + t direction, for all numbers t.
struct Line {
  Position from{0, 0, 0};       ///< where t is 0
  Position direction{0, 0, 1};  ///< of any length but 0
};

/// A function of world space whose zero set is a surface, negative inside. To make one of your own,
/// derive from it. All functions may be called from several threads at a time.
class TUFA_API Field {
 public:
  Field();
  virtual ~Field();
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;

  /// The value at a world point. A point where it is NaN is outside.
  [[nodiscard]] virtual double value(const Position& point) const = 0;

  /// The derivatives of value() there, in values by world unit. At creases, where there are none,
  /// those of one side; 0 at points such as the centre of a distance.
  [[nodiscard]] virtual Position gradient(const Position& point) const = 0;

  /// Bounds of value() over a box. They must hold; what lies between two surfaces is left out
  /// because of them. The tighter, the less is sampled. Where value() may be NaN, the greatest must
  /// not be below 0.
  [[nodiscard]] virtual Interval bound(const Box& box) const = 0;

  /// A bound of the length of gradient() over a box; infinite where there is none.
  [[nodiscard]] virtual double lipschitz(const Box& box) const = 0;

  /// Bounds of gradient() over a box, component by component: the corners of a box of vectors. With
  /// them rays find the surface by Newton's method. Default: lipschitz() each way.
  [[nodiscard]] virtual Box gradientBound(const Box& box) const;

  /// Whether gradient() has length 1 all but everywhere, as with distances and with unions and
  /// intersections of them. Level sets take such values as they are; none must be NaN. Default: no.
  [[nodiscard]] virtual bool hasUnitGradient() const;

  /// The distance to the surface as far as value and gradient around the point tell it, of the
  /// sign of value(); where it is `reach` or more, anything of that sign that is, too. Default: the
  /// value itself if hasUnitGradient(); else two steps of Newton's method, and where they do not
  /// converge a search along the gradient.
  [[nodiscard]] virtual double distance(const Position& point, double reach) const;

  /// A box that holds all points inside. Default: all of space.
  [[nodiscard]] virtual Box extent() const;

  /// A field of the same values in a box that is quicker to evaluate there; null if this one is as
  /// good. It may refer to this one, which must outlive it. Default: null.
  [[nodiscard]] virtual std::shared_ptr<const Field> restricted(const Box& box) const;

  /// In closed form, where there is one: appends the ranges of t in which a line is inside, sorted
  /// and apart, right between `begin` and `end` at least. Rays then need no search. Returns whether
  /// there is one, the same for all lines; appends nothing if not. Default: there is none.
  [[nodiscard]] virtual bool insideAlong(const Line& line, double begin, double end,
                                         std::vector<Interval>& spans) const;

  /// The unit vector along gradient() that points outward; (0, 0, 0) where the gradient is 0.
  [[nodiscard]] Position normal(const Position& point) const;
};

/// What a scene file says.
struct Scene {
  std::shared_ptr<const Field> field;  ///< the union of its objects, cut by its bounds
  std::string name;                    ///< for the grid: "surface" unless the scene has another
  std::optional<double> voxelSize;     ///< world units
  std::optional<double> halfWidth;     ///< of the narrow band, in voxels
  std::size_t nodes = 0;               ///< fields in the tree
};

/// Reads a scene: JSON of the form that docs/scenes.md describes. `bounds` replaces those of the
/// scene. Throws Error: UnreadableFile, which names the path of the offending value, such as
/// `/objects/2/radius`; LimitExceeded for a scene of more than a million nodes; InvalidArgument for
/// bounds that are no box.
[[nodiscard]] TUFA_API Scene readScene(const std::filesystem::path& path,
                                       const std::optional<Box>& bounds = {});

/// Reads a scene from memory. Files that it names are sought in the current folder.
[[nodiscard]] TUFA_API Scene readScene(const FileBytes& file,
                                       const std::optional<Box>& bounds = {});

/// An expression in x, y and z, such as "x^2 + y^2 + z^2 - 1": negative inside. Derivatives are by
/// automatic differentiation, bounds by interval arithmetic. Throws Error(InvalidArgument), which
/// names the place in the text.
[[nodiscard]] TUFA_API std::shared_ptr<const Field> makeExpression(std::string_view text);

}  // namespace tufa::implicit
