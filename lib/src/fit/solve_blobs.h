#pragma once

#include <array>

#include "base/job.h"
#include "fit/blob_field.h"

namespace tufa::fit {

/// One blob of a field optimized, the others staying: the energy near it is as small as
/// `iterations` steps make it. Throws Error(Cancelled) between steps when the job is asked to stop.
[[nodiscard]] UnitBlob solveBlob(const BlobField& field, std::size_t index, int iterations,
                                 base::Job& job);

/// Two blobs in place of one, optimized together from `start` on.
[[nodiscard]] std::array<UnitBlob, 2> solveBlobs(const BlobField& field, std::size_t index,
                                                 const std::array<UnitBlob, 2>& start,
                                                 int iterations, base::Job& job);

}  // namespace tufa::fit
