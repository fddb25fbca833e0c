#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "chunks/seams.h"

namespace tufa::chunks {

/// Moves the arcs' vertices where curves cross on their face, or lead back on themselves from one
/// vertex to the next, to their `havens`, offsets from their cells, until they do so nowhere or
/// none of these vertices can be moved. What becomes of a curve depends on what lies on its face
/// alone.
void untangle(const std::vector<openvdb::Vec3d>& havens, Seams& seams);

}  // namespace tufa::chunks
