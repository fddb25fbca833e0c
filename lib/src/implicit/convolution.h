#pragma once

#include <tufa/implicit.h>

#include <variant>
#include <vector>

#include "base/vec3.h"
#include "implicit/fields.h"

namespace tufa::implicit {

/// What a skeleton is convolved with; r is the distance by the width.
enum class ConvolutionKernel {
  Cauchy,      ///< 1 / (1 + r²)², without end
  Gaussian,    ///< exp(-r²), without end
  Polynomial,  ///< (1 - r²)² up to 1
};

struct SkeletonSegment {
  Vec3 a{0.0}, b{0.0};
};
struct SkeletonTriangle {
  Vec3 a{0.0}, b{0.0}, c{0.0};
};
/// Part of a circle, from the point `start` about the axis.
struct SkeletonArc {
  Vec3 centre{0.0};
  Vec3 axis{0.0};    ///< of length 1
  Vec3 start{0.0};   ///< from the centre, at a right angle to the axis
  double angle = 0;  ///< radians, above 0 and at most a turn
};

struct SkeletonPart {
  std::variant<SkeletonSegment, SkeletonTriangle, SkeletonArc> shape;
  double weight = 1;
};

struct ConvolutionOptions {
  ConvolutionKernel kernel = ConvolutionKernel::Cauchy;
  double width = 1;
  double threshold = 0.5;
};

/// The threshold less the integrals of the kernel over all parts of a skeleton (Bloomenthal and
/// Shoemake 1991), in closed form (McCormack and Sherstyn 1998). They are scaled so that they are 1
/// on a straight line, or in a plane, without end. Triangles and arcs have a closed form for
/// Cauchy's kernel only.
[[nodiscard]] FieldPtr makeConvolution(const std::vector<SkeletonPart>& parts,
                                       const ConvolutionOptions& options);

}  // namespace tufa::implicit
