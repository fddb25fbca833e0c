#pragma once

#include <tufa/contour.h>

namespace tufa::test {

/// contour() with every cell meshed on its own.
Mesh uniformMesh(const openvdb::GridBase& grid, ContourOptions options = {},
                 ContourReport* report = nullptr);

/// The crossed lattice edges that a uniform mesh stands for: a quad each, or the four triangles
/// that the repair put in its place.
std::size_t edgesOf(const Mesh& mesh);

}  // namespace tufa::test
