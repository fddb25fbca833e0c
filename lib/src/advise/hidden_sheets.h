#pragma once

#include <cstddef>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::advise {

/// Lattice edges of a distance field between two samples of one side from both of which the values
/// run, along the edge, to the other side before they meet: the surface passes there twice, and the
/// signs of the samples do not show it.
[[nodiscard]] std::size_t countHiddenSheets(const grid::Volume& volume, base::Job& job);

}  // namespace tufa::advise
