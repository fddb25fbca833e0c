#pragma once

#include "grid/openvdb_templates.h"

// What tests make beside what the library compiles.
TUFA_TREE_IS_ELSEWHERE(BoolTree);
TUFA_TREE_IS_ELSEWHERE(Int32Tree);
TUFA_TREE_IS_ELSEWHERE(Vec3STree);
