#pragma once

#include <openvdb/openvdb.h>
#include <tufa/mesh.h>

#include "base/job.h"

namespace tufa::voxelize_mesh {

/// Puts exact signed distances in the place of a level set's, which OpenVDB has made of a mesh that
/// bounds a solid (see Shells), if no two of its faces intersect: then the face, edge or vertex
/// nearest to a voxel tells the voxel's side (Baerentzen and Aanaes 2005). Voxels within the band
/// that OpenVDB left out become active. Returns whether it has. It has not, either, if a voxel's
/// side is not OpenVDB's two voxels or more from the surface. Cost: a search for intersections
/// among the triangles, and for the nearest one of each voxel of the band.
bool takeExactDistances(openvdb::FloatGrid& grid, const Mesh& mesh, base::Job& job);

}  // namespace tufa::voxelize_mesh
