#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/job.h"
#include "chunks/cut/cut_mesh.h"
#include "grid/slab.h"

namespace tufa::chunks {

/// Where a slab's surface ends, in a plane between two slabs.
struct SlabBorder {
  struct Vertex {
    std::array<double, 3> at;
    VertexIndex vertex;                ///< its number in the slab's mesh
    std::array<ChunkPlane, 3> planes;  ///< of the mesh of both slabs; axis -1 where there are fewer
  };
  std::vector<Vertex> vertices;  ///< by place
  /// Places in `vertices`, as they follow each other around the slab's triangles; sorted.
  std::vector<std::array<std::uint32_t, 2>> edges;
};

/// Whether one slab goes on where the other one ends: the same vertices, and the same edges the
/// other way round.
[[nodiscard]] bool fit(const SlabBorder& upper, const SlabBorder& lower);

/// The chunks of a slab alone, at LOD 0.
struct CutSlab {
  CutMesh cut;  ///< open where the slab ends, whose planes are none of it
  SlabBorder lower, upper;
};

/// Leaves those chunks of LOD 0, which has errors, that lie in a slab. Cost: linear.
[[nodiscard]] CutSlab takeSlab(CutMesh whole, const grid::Slab& slab, base::Job& job);

}  // namespace tufa::chunks
