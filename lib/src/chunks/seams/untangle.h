#pragma once

#include <vector>

#include "base/vec3.h"
#include "chunks/seams/seams.h"

namespace tufa::chunks {

/// Moves vertices of arcs to their fallback positions, offsets from their cells, where curves cross
/// on their face or lead back on themselves, until they do so nowhere or none of these vertices can
/// be moved. Depends on what lies on the face alone. Ends, as a vertex moves once at most.
void untangle(const std::vector<Vec3>& fallbacks, Seams& seams);

}  // namespace tufa::chunks
