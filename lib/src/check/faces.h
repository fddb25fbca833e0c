#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/job.h"

namespace tufa::checks {

/// The triangles of a mesh, sorted by what can be tested on them. Later stages read these lists and
/// need no guards against bad indices or positions.
struct Faces {
  explicit Faces(const std::vector<Position>& meshPositions) : positions(meshPositions) {}

  const std::vector<Position>& positions;
  std::size_t positionCount = 0;   ///< positions that are distinct after welding
  std::size_t triangleCount = 0;   ///< of the mesh, with the faces that are left out below
  std::size_t invalidCount = 0;    ///< an index out of range, or a position that is not finite
  std::size_t collapsedCount = 0;  ///< a repeated index
  std::size_t collinearCount = 0;  ///< three vertices, exactly on one line
  /// Faces of three distinct vertices at finite positions, for topology.
  std::vector<Triangle> proper;
  /// Of these, the faces that span a plane, for intersections and rays. Empty if that is all of
  /// them, see solid().
  std::vector<Triangle> noncollinear;

  [[nodiscard]] const std::vector<Triangle>& solid() const {
    return collinearCount == 0 ? proper : noncollinear;
  }
};

/// Sorts the triangles of a mesh. With `weld`, vertices at equal positions become the first of
/// them. Positions are read from `mesh`, which must outlive the result.
[[nodiscard]] Faces sortFaces(const Mesh& mesh, bool weld, base::Job& job);

/// True if the three indices are in range and their positions finite.
[[nodiscard]] bool isValid(const Triangle& triangle, const std::vector<Position>& positions);

}  // namespace tufa::checks
