#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <functional>
#include <memory>

namespace tufa::bench {

/// What one run of vtkFlyingEdges3D made.
struct FlyingEdgesMesh {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::shared_ptr<void> made;
};

/// Runs VTK's vtkFlyingEdges3D at an isovalue, without normals, on a dense copy of the grid's
/// bounding box, which is made now. Empty where the program was built without VTK or the copy would
/// take more than two gigabytes.
[[nodiscard]] std::function<FlyingEdgesMesh(int threads)> flyingEdgesOf(
    const openvdb::FloatGrid& grid, double isovalue);

}  // namespace tufa::bench
