#pragma once

#include <tufa/export.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tufa {

/// A label of a grid.
struct LabelCount {
  std::int64_t label = 0;  ///< not 0
  std::size_t voxels = 0;  ///< active ones that have it
};

/// The labels of a grid of 32- or 64-bit integers, such as importSlices() makes: the values of its
/// active voxels but 0, in increasing order. Throws Error: UnsupportedGrid (other values),
/// LimitExceeded (more than a million labels).
[[nodiscard]] TUFA_API std::vector<LabelCount> labelsIn(const openvdb::GridBase& grid);

/// For each label a fog volume, a float grid named `label_` and the number: 1 in the active voxels
/// that have it, 0 elsewhere. At isovalue 0.5 its surface lies half way between those voxels and
/// others. One pass over the grid. Throws Error: UnsupportedGrid, InvalidArgument (a label twice).
[[nodiscard]] TUFA_API std::vector<std::shared_ptr<openvdb::GridBase>> labelVolumes(
    const openvdb::GridBase& grid, const std::vector<std::int64_t>& labels);

}  // namespace tufa
