#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// What has become of some triangles of a mesh in a reduction of these alone, the rest of the mesh
/// being open where they were.
struct ReplacedPart {
  Surface surface;
  std::vector<Vec3f> positions;  ///< of its vertices, as the mesh's
  std::vector<Index> vertices;   ///< of the mesh: for each that came into that reduction, rising
  std::vector<Index> faces;      ///< the same for triangles
};

/// Replaces parts of a surface that is as it came in, its faces being those of the reference. Parts
/// must not touch each other. Regions and planes of lines have the same numbers everywhere.
void replaceParts(Surface& surface, const ReferenceMesh& reference,
                  std::span<const ReplacedPart> parts, base::Job& job);

/// Has all vertices of triangles of some regions stay; these are marked by a number other than 0.
void holdRegions(Surface& surface, const std::vector<std::uint8_t>& isHeld, base::Job& job);

}  // namespace tufa::reduce
