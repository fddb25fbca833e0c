#pragma once

#include <openvdb/openvdb.h>

#include <tufa/mesh.h>

#include "creases/vertex_sides.h"

namespace tufa::polygons {

/// Whether the diagonal from corner 1 to corner 3 splits the quad better than the one from 0 to 2.
/// `crossing` is a point of the surface that the quad stands around, `direction` the outward
/// direction of the lattice edge there, of the length of a voxel.
[[nodiscard]] bool secondDiagonalIsBetter(const Mesh& mesh, const Quad& quad,
                                          const creases::VertexSides& sides,
                                          const Position& crossing,
                                          const openvdb::Vec3d& direction);

}  // namespace tufa::polygons
