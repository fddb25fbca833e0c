#pragma once

#include <tufa/mesh.h>

#include <cstddef>
#include <vector>

#include "base/vec3.h"
#include "fit/blob_field.h"

namespace tufa::fit {

/// Where a mesh is, and how large.
struct Frame {
  Vec3 middle{0.0};
  double diagonal = 0;

  [[nodiscard]] Vec3 toUnit(const Vec3& p) const { return (p - middle) / diagonal; }
};

/// Of the triangles' box. Throws Error(InvalidArgument) for a corner that is not finite, and where
/// blobs would have numbers that scenes may not.
[[nodiscard]] Frame frameOf(const Mesh& mesh, const std::vector<Triangle>& triangles);

/// In cubes of the diagonal; that of a sheet for a mesh that encloses next to nothing. Throws
/// Error(InvalidArgument) where the mesh faces inward.
[[nodiscard]] double volumeOf(const Mesh& mesh, const std::vector<Triangle>& triangles,
                              const Frame& frame);

/// Points of equal area with the normals of their triangles, `count` or a few less. Throws
/// Error(InvalidArgument) for a mesh without area.
[[nodiscard]] std::vector<Sample> sampleMesh(const Mesh& mesh,
                                             const std::vector<Triangle>& triangles,
                                             const Frame& frame, std::size_t count);

}  // namespace tufa::fit
