#pragma once

#include <tufa/openvdb_fwd.h>

#include <tufa/mesh.h>
#include <array>
#include <memory>
#include <vector>

#include "base/job.h"
#include "base/lattice_range.h"
#include "base/vec3.h"

namespace tufa::grid {

/// A copy of a grid's transform between index and world space.
class Transform {
 public:
  explicit Transform(const openvdb::math::Transform& transform);

  [[nodiscard]] Vec3 indexToWorld(const Vec3& index) const;
  [[nodiscard]] Vec3 worldToIndex(const Vec3& world) const;
  /// Where the lattice points lie.
  [[nodiscard]] base::Lattice lattice() const;
  /// The same as a matrix: row vectors of index space times it are row vectors of world space.
  [[nodiscard]] std::array<std::array<double, 4>, 4> matrix() const;

 private:
  std::shared_ptr<const openvdb::math::Transform> transform_;
};

/// The transform of a grid.
[[nodiscard]] Transform transformOf(const openvdb::GridBase& grid);

/// The cells that positions in world space lie in, see Mesh::cells.
[[nodiscard]] std::vector<Coord> cellsOf(const std::vector<Position>& positions,
                                         const Transform& transform, base::Job& job);

}  // namespace tufa::grid
