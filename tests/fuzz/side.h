#pragma once

namespace tufa::fuzz {

/// The most samples along an edge of a grid, each target's own. With few, many more grids go
/// through in the same time, and one fault in a cell shows as well.
extern const int kSide;

}  // namespace tufa::fuzz
