#pragma once

#include <tufa/coord.h>
#include <tufa/export.h>
#include <cstdint>
#include <vector>

namespace tufa {

/// A leaf of the octree of an adaptive mesh that the surface passes: a cube of 2^level lattice
/// steps along each edge, aligned to multiples of its size.
struct LeafCell {
  Coord corner;   ///< lowest lattice point
  int level = 0;  ///< log2 of the size in lattice steps
};

/// Whether no two leaves that touch, by a face, an edge or a corner, differ by more than one level,
/// and no leaf holds another. Throws Error(InvalidArgument) for levels other than 0 to 31.
[[nodiscard]] TUFA_API bool isRestricted(const std::vector<LeafCell>& leaves);

}  // namespace tufa
