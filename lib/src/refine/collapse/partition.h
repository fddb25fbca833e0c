#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "refine/collapse/edge_mesh.h"

namespace tufa::refine {

/// The vertices of a mesh in regions of about one size. What is done inside one is not seen in
/// another, so regions are worked on at the same time.
struct Regions {
  std::vector<std::vector<VertexIndex>> vertices;  ///< of each region, by place
  std::vector<std::uint32_t> of;                   ///< region of each vertex
  std::vector<std::uint8_t> inner;  ///< vertices all of whose neighbours are in their region
};

/// Where the vertices are parted: at the middle of their number, or a third behind the first. The
/// borders of one are mostly inside the regions of the other.
enum class Parting : std::uint8_t { Halves, Thirds };

/// Parts the vertices that went into no other across their longest extent, again and again, until
/// there are at most `most` in a region. Depends on the mesh alone, not on the number of threads.
[[nodiscard]] Regions makeRegions(const EdgeMesh& mesh, std::size_t most, Parting parting,
                                  base::Job& job);

/// All vertices as one region.
[[nodiscard]] Regions oneRegion(const EdgeMesh& mesh);

}  // namespace tufa::refine
