#include "topology/dilate.h"

#include <algorithm>

namespace tufa::topology {

std::vector<std::uint8_t> dilate(const Mesh& mesh, std::vector<std::uint8_t> marks, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::uint8_t> wider = marks;
    const auto look = [&](const auto& v) {
      if (std::none_of(v.begin(), v.end(), [&](VertexIndex i) { return marks[i] != 0; })) return;
      for (const VertexIndex i : v) wider[i] = 1;
    };
    for (const Quad& quad : mesh.quads) look(quad.vertices);
    for (const Triangle& triangle : mesh.triangles) look(triangle.vertices);
    marks = std::move(wider);
  }
  return marks;
}

}  // namespace tufa::topology
