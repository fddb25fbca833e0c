#pragma once

#include <tufa/contour.h>

namespace tufa::test {

/// contour() with every cell meshed on its own.
inline Mesh uniformMesh(const openvdb::GridBase& grid, ContourOptions options = {},
                        ContourReport* report = nullptr) {
  options.uniform = true;
  return contour(grid, options, report);
}

}  // namespace tufa::test
