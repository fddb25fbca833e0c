#pragma once

#include <vector>

#include "base/job.h"
#include "base/shared_array.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// A mesh that a surface was once reduced to, kept to stand in for the reference: what is within a
/// distance of it is within that and its own error of the reference. It has a fraction of the
/// triangles, so that reducing to tolerances many times its error costs as little.
struct Proxy {
  base::SharedArray<Vec3f> positions;
  base::TriangleArray triangles;
  std::vector<Index> faces;   ///< for each vertex the face of the reference below it, or kNone
  std::vector<Index> owners;  ///< for each reference vertex the triangle that answers for it
  float largest = 0;          ///< its distance to the reference, a bound, voxels
  float mean = 0;             ///< of the reference vertices from their owners, voxels
};

/// The surface as it is, which is not whole.
[[nodiscard]] Proxy makeProxy(const Surface& surface, float largest, float mean);

/// The mesh of a proxy as a reference. It bends where most of what lies below does: its triangles
/// are too large to tell.
[[nodiscard]] ReferenceMesh makeReference(const Proxy& proxy, const ReferenceMesh& reference,
                                          base::Job& job);

/// Hands a surface over from the reference of a proxy to the proxy: each vertex of the proxy gets
/// an owner, the nearest of those that the reference's face below it has, and each vertex of the
/// surface a face of the proxy, found in the same way.
void handOver(Surface& surface, const ReferenceMesh& reference, const Proxy& proxy,
              const ReferenceMesh& proxyMesh, base::Job& job);

/// The face of the reference below a vertex that lies over a face of the proxy; kNone if that is.
[[nodiscard]] Index faceBelow(const ReferenceMesh& reference, const Proxy& proxy, Index proxyFace,
                              Vec3f p, Vec3f axis);

}  // namespace tufa::reduce
