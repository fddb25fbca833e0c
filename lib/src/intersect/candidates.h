#pragma once

#include <cstdint>
#include <vector>

#include "uniform/quads.h"

namespace tufa::intersect {

/// The quads of the uniform mesh that may intersect another quad elsewhere than in what they share;
/// the others intersect each other nowhere else, even if each moves by half of `margin` (world
/// units) in any way. Sorted.
///
/// Let a quad stand around the lattice edge from a to b. Its envelope is the union of the four
/// tetrahedra (a, b, v, w), v and w being vertices of the quad in neighbouring cells (Ju and Udeshi
/// 2006). In a cell of one vertex v the envelopes of all quads are cones from v over triangles (a,
/// b, q) on the cell's faces, q being the point where the edge from v to the neighbour's vertex
/// passes the face. These triangles share no inner point, so neither do the envelopes. A quad whose
/// triangles lie in its envelope, off a and b, therefore touches another such quad only in common
/// vertices and edges. They do lie in it if each of their two planes has a behind it and b in
/// front: the line through a and b then passes one of them between a and b, and the quad's diagonal
/// passes the triangle (v, a, b) of a vertex v beside it.
///
/// Candidates are the quads that fail this, that touch a cell of several vertices, or that have a
/// vertex out of its cell. Every intersecting pair contains one. Cost: one pass over the quads, two
/// planes each.
[[nodiscard]] std::vector<std::uint32_t> findCandidates(const uniform::SurfaceView& context,
                                                        const Mesh& mesh, double margin,
                                                        base::Job& job);

/// Those among some quads, given in rising order.
[[nodiscard]] std::vector<std::uint32_t> findCandidatesAmong(
    const std::vector<std::uint32_t>& quads, const uniform::SurfaceView& context, const Mesh& mesh,
    double margin, base::Job& job);

}  // namespace tufa::intersect
