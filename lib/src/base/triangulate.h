#pragma once

#include <tufa/mesh.h>

#include <vector>

#include "base/job.h"

namespace tufa::base {

/// The triangles of tufa::triangulate(), by all threads.
[[nodiscard]] std::vector<Triangle> triangulate(const Mesh& mesh, Job& job);

}  // namespace tufa::base
