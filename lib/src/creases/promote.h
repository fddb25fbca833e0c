#pragma once

#include <cstddef>
#include <cstdint>
#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"

namespace tufa::creases {

/// How many smooth sides meet at each vertex of a mesh: 0 not asked (the field is smooth there), 1
/// one side of a crease nearby, 2 on a crease, 3 on a corner.
using SideCounts = std::vector<std::uint8_t>;

/// Moves vertices onto creases that pass between cells.
///
/// A crease may run through cells that have no sign change and so no vertex. Then two neighbouring
/// vertices lie on different sides and the edge between them cuts the corner, by up to half a voxel.
/// Of each such pair the one nearer to the line where its two planes meet moves there, or to the
/// corner of three planes. It leaves its cell, by a voxel at most, into a cell that has no vertex.
/// Uses the positions and normals of the mesh (each exact on its side) and changes both. `voxelSize`
/// is in world units. Returns the number of vertices moved.
std::size_t promoteToCreases(Mesh& mesh, SideCounts& sides, double voxelSize, base::Job& job);

}  // namespace tufa::creases
