#include "reduce/proxy.h"

#include <array>
#include <limits>
#include <utility>

#include "reduce/triangles.h"

namespace tufa::reduce {
namespace {

// Of the owners of a face's corners the one that is nearest to p, among triangles over positions.
Index nearestOwner(const std::array<Index, 3>& corners, const std::vector<Index>& owners,
                   const base::SharedArray<Vec3f>& positions, const base::TriangleArray& triangles,
                   Vec3f p) {
  Index best = kNone;
  float nearest = std::numeric_limits<float>::max();
  for (const Index corner : corners) {
    const Index owner = owners[corner];
    if (owner == kNone) continue;
    const auto [a, b, c] = triangles[owner].vertices;
    const float d2 = squaredDistanceToTriangle(p, positions[a], positions[b], positions[c]);
    if (d2 < nearest) nearest = d2, best = owner;
  }
  return best;
}

// The face that is seen from p along an axis, near another one; that one if none is seen.
Index locateNear(const ReferenceMesh& mesh, Index face, Vec3f p, Vec3f axis) {
  if (squaredLength(axis) == 0) return face;
  const Index found = mesh.locate(face, p, axis);
  return found == kNone ? face : found;
}

}  // namespace

Proxy makeProxy(const Surface& surface, float largest, float mean) {
  return {surface.position, surface.triangles, surface.face, surface.owner, largest, mean};
}

ReferenceMesh makeReference(const Proxy& proxy, const ReferenceMesh& reference, base::Job& job) {
  Surface surface = makeSurface(proxy.positions, proxy.triangles, job);
  std::vector<int> bent(proxy.positions.size(), 0);  // vertices below that are, less the others
  for (Index r = 0; r < proxy.owners.size(); ++r) {
    job.pollCancelled(r);
    if (proxy.owners[r] == kNone) continue;
    const int one = reference.isBent(r) ? 1 : -1;
    for (const Index v : proxy.triangles[proxy.owners[r]].vertices) bent[v] += one;
  }
  for (Index v = 0; v < bent.size(); ++v) {
    surface.flags[v] &= static_cast<std::uint8_t>(~kBent);
    if (bent[v] > 0) surface.flags[v] |= kBent;
  }
  return {surface, {}, job};
}

void handOver(Surface& s, const ReferenceMesh& reference, const Proxy& proxy,
              const ReferenceMesh& proxyMesh, base::Job& job) {
  std::vector<Index> owners(proxy.positions.size(), kNone);
  job.forRanges(owners.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      if (proxy.faces[r] == kNone) continue;
      owners[r] = nearestOwner(reference.vertices(proxy.faces[r]), s.owner, s.position, s.triangles,
                               proxy.positions[r]);
    }
  });
  job.forRanges(s.position.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (s.face[v] == kNone) continue;
      const Index face = nearestOwner(reference.vertices(s.face[v]), proxy.owners, proxy.positions,
                                      proxy.triangles, s.position[v]);
      s.face[v] =
          face == kNone ? kNone : locateNear(proxyMesh, face, s.position[v], s.axis[v].vector());
    }
  });
  s.owner = std::move(owners);
}

Index faceBelow(const ReferenceMesh& reference, const Proxy& proxy, Index proxyFace, Vec3f p,
                Vec3f axis) {
  if (proxyFace == kNone) return kNone;
  Index nearest = kNone;
  for (const Index corner : proxy.triangles[proxyFace].vertices) {
    if (nearest == kNone ||
        squaredLength(proxy.positions[corner] - p) < squaredLength(proxy.positions[nearest] - p)) {
      nearest = corner;
    }
  }
  const Index face = proxy.faces[nearest];
  return face == kNone ? kNone : locateNear(reference, face, p, axis);
}

}  // namespace tufa::reduce
