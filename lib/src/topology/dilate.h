#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

namespace tufa::topology {

/// Adds the neighbours of marked vertices to the marks of a mesh, `rings` times. Vertices of one
/// polygon are neighbours.
[[nodiscard]] std::vector<std::uint8_t> dilate(const Mesh& mesh, std::vector<std::uint8_t> marks,
                                               int rings);

}  // namespace tufa::topology
