#pragma once

#include <cstddef>

#include "base/job.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// Slides vertices along their creases until they are in the order in which the surface passes
/// them, 0.16 voxels apart. Returns how many have moved.
///
/// Each cell places its vertex for itself, at the point of the crease nearest to its own crossings.
/// Along an acute edge several cells lie beside the same stretch of the crease, and their points
/// coincide or lie the wrong way around, which turns faces over. A quad between the crease and a
/// sheet says which of its vertices comes first: seen from outside it runs counter-clockwise. A
/// quad whose vertices are all on the crease lies between its two sheets, and takes its direction
/// from the quads beside it.
///
/// Meant, not promised: an order may be out of reach, and withdrawPlacements() has the last word.
/// Cost: what looking at the quads of vertices on creases takes.
std::size_t orderAlongCreases(uniform::UniformSurface& surface, base::Job& job);

}  // namespace tufa::refine
