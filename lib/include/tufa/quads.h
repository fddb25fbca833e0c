#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <cstddef>

namespace tufa {

/// Joins triangles of a mesh in pairs to quads where the surface is flat or bent one way only, as
/// on a cylinder, and returns how many quads were made. Reduced meshes are of triangles; this is
/// for programs and people that want quads. The surface stays what it is: each quad begins at the
/// diagonal that its triangles shared, so that triangulate() gives the same triangles again.
///
/// Two triangles make a quad if their normals are within 20 degrees, its corners between 15 and 165
/// degrees, and its two diagonals within `mostWarp`, in world units, of each other: a program that
/// splits along the other diagonal is off by no more. Each vertex keeps three edges. Pairs are
/// taken by their corners, those nearest to right angles first; then pairs are exchanged where that
/// makes one more, until none does. Quads that were there come first. Positions, normals and
/// attributes stay.
///
/// Throws Error(InvalidArgument) for a vertex that is not there, and for a `mostWarp` that is
/// negative or not a number. Cost: a sort of the edges, and some passes over the triangles.
TUFA_API std::size_t pairTriangles(Mesh& mesh, double mostWarp);

}  // namespace tufa
