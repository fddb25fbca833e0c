#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tufa {

/// A label of a grid.
struct LabelCount {
  std::int64_t label = 0;  ///< not 0
  std::size_t voxels = 0;  ///< active ones that have it
};

/// The labels of a grid of 32- or 64-bit integers, such as importSlices() makes: the values of its
/// active voxels but 0, in increasing order. Throws Error: UnsupportedGrid (other values),
/// LimitExceeded (more than a million labels).
[[nodiscard]] TUFA_API std::vector<LabelCount> labelsIn(const openvdb::GridBase& grid);

/// For each label a fog volume, a float grid named `label_` and the number: 1 in the active voxels
/// that have it, 0 elsewhere. At isovalue 0.5 its surface lies half way between those voxels and
/// others. One pass over the grid. Throws Error: UnsupportedGrid, InvalidArgument (a label twice).
[[nodiscard]] TUFA_API std::vector<std::shared_ptr<openvdb::GridBase>> labelVolumes(
    const openvdb::GridBase& grid, const std::vector<std::int64_t>& labels);

/// What shareInterfaces() did to the mesh of a label.
struct InterfaceReport {
  std::size_t sharedVertices = 0;  ///< in cells that have another of the labels, too
  /// More sheets of the surface than one pass a cell: they are apart in the mesh, and so many
  /// vertices lie in the place of one before.
  std::size_t touchingVertices = 0;
};

/// Makes meshes fit where their labels meet: the same positions, to the bit, and the same quads
/// with the same diagonals, seen from both sides. `meshes` are those of labelVolumes(grid, labels),
/// in that order, by Method::SurfaceNets with ContourOptions::keepCells. Each vertex goes to the
/// mean of the middles of all edges of its cell whose ends have different labels, others and none
/// being one of them; normals become those of the faces. Meshes stay closed 2-manifolds. Throws
/// Error: UnsupportedGrid, InvalidArgument (other meshes).
TUFA_API std::vector<InterfaceReport> shareInterfaces(const openvdb::GridBase& grid,
                                                      const std::vector<std::int64_t>& labels,
                                                      std::vector<Mesh>& meshes);

}  // namespace tufa
