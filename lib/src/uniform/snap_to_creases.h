#pragma once

#include <tufa/mesh.h>
#include <cstddef>

#include "base/job.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// Moves vertices onto creases and corners that pass between cells.
///
/// A crease may run through cells that have no sign change and so no vertex. Then some quad cannot
/// be split into two triangles that lie on one smooth side each: it cuts the crease off, by up to
/// half a voxel. Of its vertices the one nearest to the line where its sides meet moves there, or,
/// where three sides meet, to their corner. The vertex leaves its cell, by a voxel at most, into a
/// cell that has none. Uses positions and normals of the mesh, each exact on its side, and changes
/// both. `voxelSize` is in world units. Returns the number of vertices moved.
std::size_t snapToCreases(Mesh& mesh, VertexSheets& sheets, double voxelSize, base::Job& job);

}  // namespace tufa::uniform
