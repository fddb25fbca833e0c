#pragma once

#include <tufa/contour_report.h>
#include <vector>

#include "base/job.h"
#include "chunks/cut/cut_volume.h"
#include "grid/slab.h"
#include "grid/volume.h"
#include "octree/cut_rule.h"

namespace tufa::chunks {

/// Voxels that a slab must be thick.
inline constexpr int kLeastSlab = 64;

/// LOD 0 of a volume, made of one slab after the other, so that no more than one uniform mesh of a
/// slab is in memory at a time. It has errors, see CutMesh::errors.
///
/// Each slab's uniform mesh is made of its blocks and some beyond, so that it is as that of the
/// whole volume up to where the slab ends. Two slabs' borders are compared; should they differ, as
/// where a repair reached farther, both are made again as one. The curves in the planes between
/// slabs are open borders to reduction, and stay as they are at this LOD.
///
/// `rule` has the tolerance, in voxels, and no scale. In the report counts of
/// repairs and of creases near a border of two slabs are those of both. `end`: the share of the
/// progress that is reached at the end.
[[nodiscard]] CutMesh reduceSlabs(const grid::Volume& volume, std::vector<grid::Slab> slabs,
                                  const octree::CutRule& rule, const CutOptions& options,
                                  const CutEnds& ends, double end, ContourReport& report,
                                  base::Job& job);

}  // namespace tufa::chunks
