#pragma once

#include <vector>

#include "base/vec3.h"
#include "chunks/seams/seams.h"

namespace tufa::chunks {

/// Moves the arcs' vertices where curves cross on their face, or lead back on themselves from one
/// vertex to the next, to their `havens`, offsets from their cells, until they do so nowhere or
/// none of these vertices can be moved. What becomes of a curve depends on what lies on its face
/// alone.
void untangle(const std::vector<Vec3>& fallbacks, Seams& seams);

}  // namespace tufa::chunks
