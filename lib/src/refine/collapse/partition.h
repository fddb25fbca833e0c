#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "refine/collapse/edge_mesh.h"

namespace tufa::refine {

/// The vertices of a mesh in k-d parts of about one size. What changes inside one part is not
/// visible in another, so parts are processed in parallel.
struct Regions {
  std::vector<std::vector<VertexIndex>> vertices;  ///< of each part, by place
  std::vector<std::uint32_t> of;                   ///< part of each vertex
  std::vector<std::uint8_t> inner;  ///< vertices all of whose neighbours are in their part
};

/// Where the vertices are divided: at the median, or behind the first third. So the borders of one
/// partition lie mostly inside the parts of the other.
enum class Parting : std::uint8_t { Halves, Thirds };

/// Divides the vertices that were joined to no other across their longest extent, recursively,
/// until a part has at most `most`. Depends on the mesh alone, not on the number of threads. Cost:
/// n log n, as a k-d tree.
[[nodiscard]] Regions makeRegions(const EdgeMesh& mesh, std::size_t most, Parting parting,
                                  base::Job& job);

/// All vertices as one part.
[[nodiscard]] Regions oneRegion(const EdgeMesh& mesh);

}  // namespace tufa::refine
