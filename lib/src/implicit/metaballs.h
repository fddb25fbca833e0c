#pragma once

#include <tufa/implicit.h>

#include <vector>

#include "base/vec3.h"
#include "implicit/fields.h"

namespace tufa::implicit {

/// How the density of a metaball falls from 1 in its centre, s being the distance by its radius.
enum class BallKernel {
  Blinn,      ///< exp(-blobbiness s²), without end (Blinn 1982)
  Nishimura,  ///< 1 - 3 s² up to a third, then 3/2 (1 - s)² (Nishimura et al. 1985)
  Wyvill,     ///< 1 - 22/9 s² + 17/9 s⁴ - 4/9 s⁶ (Wyvill, McPheeters and Wyvill 1986)
};

struct Metaball {
  Vec3 centre{0.0};
  double radius = 1;
  double weight = 1;  ///< of its density; below 0 it takes away from others
};

struct MetaballOptions {
  BallKernel kernel = BallKernel::Wyvill;
  double threshold = 0.5;  ///< inside is where the densities' sum is above it
  double blobbiness = 4;   ///< of Blinn's
};

/// The threshold less the sum of all densities. Those of Blinn end where they are below 1e-9 of
/// their greatest.
[[nodiscard]] FieldPtr makeMetaballs(std::vector<Metaball> balls, const MetaballOptions& options);

}  // namespace tufa::implicit
