#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

namespace tufa::topology {

/// The marks of a mesh's vertices and those of all neighbours, so many rings of them.
[[nodiscard]] std::vector<std::uint8_t> dilate(const Mesh& mesh, std::vector<std::uint8_t> marks,
                                               int rings);

}  // namespace tufa::topology
