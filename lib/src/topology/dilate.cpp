#include "topology/dilate.h"

#include "base/polygons.h"

#include <algorithm>

namespace tufa::topology {

std::vector<std::uint8_t> dilate(const Mesh& mesh, std::vector<std::uint8_t> marks, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::uint8_t> wider = marks;
    const auto look = [&](base::PolygonIndex, base::Corners v) {
      if (std::none_of(v.begin(), v.end(), [&](VertexIndex i) { return marks[i] != 0; })) return;
      for (const VertexIndex i : v) wider[i] = 1;
    };
    base::forPolygons(mesh, look);
    marks = std::move(wider);
  }
  return marks;
}

}  // namespace tufa::topology
