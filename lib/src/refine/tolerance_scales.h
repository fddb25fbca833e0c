#pragma once

#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "grid/affine.h"
#include "octree/cut_rule.h"

namespace tufa::refine {

/// The rule's tolerance at a point of the uniform mesh, voxels.
[[nodiscard]] double toleranceAt(const octree::CutRule& rule, const grid::Affine& affine,
                                 const Vec3& point);

/// What the rule multiplies the tolerance with at each vertex of a mesh, as far as that makes it no
/// larger than the mesh; none if it is 1 everywhere.
[[nodiscard]] std::vector<float> scalesOf(const Mesh& mesh, const grid::Affine& affine,
                                          const octree::CutRule& rule, base::Job& job);

}  // namespace tufa::refine
