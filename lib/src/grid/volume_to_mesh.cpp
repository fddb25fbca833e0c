#include "grid/volume_to_mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <vector>

#include "grid/openvdb_templates.h"

namespace tufa::grid {
namespace {

template <class GridT>
Mesh meshOf(const GridT& grid, const IsoChoice& iso, double adaptivity) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, iso.isovalue, adaptivity);
  Mesh mesh;
  mesh.positions.reserve(points.size());
  mesh.triangles.reserve(triangles.size());
  mesh.quads.reserve(quads.size());
  for (const openvdb::Vec3s& p : points) mesh.positions.emplace_back(p[0], p[1], p[2]);
  // OpenVDB takes the side of the background for outside, and its faces are clockwise seen from
  // there.
  const bool backgroundAbove = !(static_cast<double>(grid.background()) < iso.isovalue);
  const bool turn = iso.insideIsBelow == backgroundAbove;
  for (const openvdb::Vec3I& t : triangles) {
    mesh.triangles.emplace_back(t[turn ? 2 : 0], t[1], t[turn ? 0 : 2]);
  }
  for (const openvdb::Vec4I& q : quads) {
    mesh.quads.emplace_back(q[turn ? 3 : 0], q[turn ? 2 : 1], q[turn ? 1 : 2], q[turn ? 0 : 3]);
  }
  return mesh;
}

}  // namespace

Mesh volumeToMesh(const openvdb::GridBase& grid, const IsoChoice& iso, double adaptivity) {
  if (grid.isType<openvdb::FloatGrid>()) {
    return meshOf(static_cast<const openvdb::FloatGrid&>(grid), iso, adaptivity);
  }
  return meshOf(static_cast<const openvdb::DoubleGrid&>(grid), iso, adaptivity);
}

}  // namespace tufa::grid
