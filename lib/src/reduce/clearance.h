#pragma once

#include "base/job.h"
#include "reduce/partition.h"

namespace tufa::reduce {

/// Sets kNarrow at vertices near which the surface is not, within `reach` voxels, the graph of a
/// function.
///
/// Looks in cells of a few triangles' size, at least twice `reach`. Where the normals of all
/// triangles that pass within `reach` of a cell have a common direction, there is one sheet: a
/// closed surface passes every line in and out in turn. So it is with normals on two sides where a
/// plane parts the triangles of one side from those of the other, by more than `reach`. All else is
/// marked; everything, where the reach is so large that most parts are near most others. Away from
/// the marks sheets stay apart as long as no point moves by more than a third of `reach`, so that
/// operations there need no test for intersections with what lies farther off. Cost: about 0.3
/// microseconds a triangle, more in narrow places.
void markNarrow(Surface& surface, const Partition& partition, float reach, base::Job& job);

}  // namespace tufa::reduce
