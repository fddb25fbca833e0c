#pragma once

#include <tufa/check.h>

#include "base/job.h"
#include "check/faces.h"

namespace tufa::checks {

/// Fills in area, volume and the figures about angles.
void measure(const Faces& faces, base::Job& job, CheckReport& report);

}  // namespace tufa::checks
