#pragma once

#include <tufa/mesh.h>

#include <cstddef>
#include <vector>

#include "base/direction.h"
#include "base/huge_pages.h"
#include "base/job.h"

namespace tufa::base {

/// The normals of a mesh in four bytes each in place of twelve, see Direction: for meshes of which
/// few vertices will be in the result.
class PackedNormals {
 public:
  PackedNormals() = default;
  PackedNormals(const std::vector<Normal>& normals, Job& job) {
    resizeLarge(directions_, normals.size(), job);
    job.forRanges(normals.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        directions_[i] = Direction(Vec3f(normals[i].x, normals[i].y, normals[i].z));
      }
    });
  }

  [[nodiscard]] Normal operator[](std::size_t vertex) const {
    const Vec3f normal = directions_[vertex].vector();
    return {normal.x, normal.y, normal.z};
  }

 private:
  std::vector<Direction> directions_;
};

}  // namespace tufa::base
