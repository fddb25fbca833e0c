#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/job.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// Tells the quads with a vertex among some, as the function of that name in
/// uniform/block_ranges.h does.
using QuadsAt = std::function<std::vector<std::uint32_t>(const std::vector<VertexIndex>& vertices,
                                                         const std::vector<std::uint8_t>& marks)>;

/// Whether the samples around a place allow surface there, as SampleBalls do. From several threads.
using Admits = std::function<bool(const Position& place)>;

/// Moves vertices onto creases and corners that pass between cells.
///
/// A crease may run through cells that have no sign change and so no vertex. Then some quad cannot
/// be split into two triangles that lie on one smooth sheet each: it cuts the crease off, by up to
/// half a voxel. Of its vertices the one nearest to the line where its sheets meet snaps to it, or,
/// where three sheets meet, to their corner. The vertex leaves its cell, by a voxel at most, or two
/// onto an acute edge that `admits` allows, into a cell that has none. `voxelSize` is in world
/// units. Reads positions and normals as exact on their sheets, and changes both. Returns the
/// number of vertices moved.
///
/// Promised: a vertex depends on what is within six rounds of two cells each, and not on where the
/// mesh begins, so a part of a grid gets the same vertices as the whole. Polygons may intersect
/// afterwards; repair removes that. Cost: one pass over the quads; later rounds look only around
/// the vertices moved before, whose quads `quadsAt` tells.
std::size_t snapToCreases(Mesh& mesh, VertexSheets& sheets, double voxelSize,
                          const QuadsAt& quadsAt, const Admits& admits, base::Job& job);

}  // namespace tufa::uniform
