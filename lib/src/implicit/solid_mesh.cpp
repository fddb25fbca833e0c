#include "implicit/solid_mesh.h"

#include <tufa/error.h>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/bvh.h"
#include "implicit/mesh_topology.h"
#include "implicit/shell_layers.h"
#include "intersect/surface.h"

namespace tufa::implicit {

Mesh closedMesh(const Mesh& mesh) {
  TriangleSet set = trianglesOf(mesh);
  static_cast<void>(neighboursIn(set));
  Mesh closed;
  for (const Vec3& p : set.positions) closed.positions.emplace_back(p[0], p[1], p[2]);
  for (const auto& t : set.triangles) closed.triangles.emplace_back(t[0], t[1], t[2]);
  return closed;
}

bool intersectsItself(const Mesh& mesh, base::Job& job) {
  std::vector<base::Box> boxes(mesh.triangles.size(), base::Box::empty());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    job.pollCancelled(t);
    for (const VertexIndex v : mesh.triangles[t].vertices) boxes[t].add(Vec3(mesh.positions[v]));
  }
  const base::Bvh tree(std::move(boxes), job);
  std::atomic<bool> found{false};
  job.forRanges(tree.leafCount(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end && !found; ++leaf) {
      tree.pairsOfLeaf(leaf, [&](std::uint32_t a, std::uint32_t b) {
        if (!found && intersect::intersectElsewhere(mesh.positions, mesh.triangles[a].vertices,
                                                    mesh.triangles[b].vertices, false)) {
          found = true;
        }
      });
    }
  });
  return found;
}

void requireSolid(const Mesh& mesh, base::Job& job) {
  const Mesh closed = closedMesh(mesh);
  if (!findShells(mesh, true, job).boundSolid) {
    throw Error(ErrorCode::InvalidArgument,
                "a part of the mesh faces inward without another one around it, or outward inside "
                "another; tufa voxelize fills all parts but cavities, and with \"thickness\" "
                "any will do");
  }
  if (intersectsItself(closed, job)) {
    throw Error(ErrorCode::InvalidArgument,
                "the mesh has faces that intersect or touch each other; tufa voxelize takes it as "
                "the union of its parts, and with \"thickness\" any will do");
  }
}

}  // namespace tufa::implicit
