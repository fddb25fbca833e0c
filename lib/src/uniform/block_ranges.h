#pragma once

#include <tufa/mesh.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "uniform/cell_topology.h"

namespace tufa::uniform {

/// The elements `begin` to `end` of a rising list of vertices or quads: those of one block.
struct BlockRange {
  SurfaceBlockIndex block;
  std::size_t begin, end;
};

/// The blocks of vertices, given in rising order. Cost: a binary search a block.
[[nodiscard]] std::vector<BlockRange> blocksOfVertices(const CellTopology& topology,
                                                       const std::vector<VertexIndex>& vertices);

/// The same for quads.
[[nodiscard]] std::vector<BlockRange> blocksOfQuads(const CellTopology& topology,
                                                    const std::vector<std::uint32_t>& quads);

/// The quads with a vertex among some, rising. `marks` is not 0 at these vertices, which are given
/// in rising order, and 0 at all others. Cost: one pass over the quads of their blocks and of those
/// beside them.
[[nodiscard]] std::vector<std::uint32_t> quadsAt(const CellTopology& topology, const Mesh& mesh,
                                                 const std::vector<VertexIndex>& vertices,
                                                 const std::vector<std::uint8_t>& marks,
                                                 base::Job& job);

}  // namespace tufa::uniform
