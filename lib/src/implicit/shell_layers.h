#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"

namespace tufa::implicit {

/// Connected parts of a mesh that bound solids, or cavities in the layers before.
struct ShellLayer {
  Mesh mesh;  ///< positions and faces alone
  bool isCavity = false;
};

struct Shells {
  /// Empty if no part is a cavity, as in most meshes: then the mesh is one layer as it is.
  std::vector<ShellLayer> layers;
  /// If that was asked for, whether each part is closed, and faces outward or is a cavity, as they
  /// lie in each other: the mesh bounds a solid, if it does not intersect itself.
  bool boundSolid = false;
};

/// The parts of a mesh by how deep they lie in each other, the outermost first: what a voxelizer
/// that fills closed parts adds or takes away by turns. A part is a cavity if it is closed, faces
/// inward and lies in an odd number of other closed parts.
///
/// Equal positions count as one vertex. Whether a part lies in another is asked by rays from some
/// of its faces, of which the majority decides. Cost: a hash table of the positions; one of the
/// edges, and with several parts a tree over the faces, if one of several parts faces inward or
/// `asksForSolid`.
[[nodiscard]] Shells findShells(const Mesh& mesh, bool asksForSolid, base::Job& job);

}  // namespace tufa::implicit
