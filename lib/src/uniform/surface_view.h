#pragma once

#include <tufa/mesh.h>

#include <cstddef>

#include "grid/affine.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "uniform/cell_topology.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// The uniform mesh and all that is known of its cells, as later stages read them.
struct SurfaceView {
  const grid::Blocks& blocks;
  const grid::FieldScale& scale;
  const grid::Affine& affine;
  const CellTopology& topology;
  const VertexSheets& sheets;
  const Mesh& mesh;  ///< with normals

  [[nodiscard]] const Coord& origin(std::size_t surfaceBlock) const {
    return blocks.origin(topology.blocks[surfaceBlock].block);
  }
  /// The same cells with other vertices.
  [[nodiscard]] SurfaceView withMesh(const Mesh& other) const {
    return {blocks, scale, affine, topology, sheets, other};
  }
};

}  // namespace tufa::uniform
