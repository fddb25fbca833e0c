#pragma once

#include <tufa/mesh.h>

namespace tufa::test {

/// The largest distance of vertices, edge middles and triangle middles of one mesh to the other, in
/// world units; infinite if a point is farther than `most`.
[[nodiscard]] double largestDistance(const Mesh& from, const Mesh& to, double most);

}  // namespace tufa::test
