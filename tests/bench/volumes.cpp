#include "volumes.h"

#include <tufa/io.h>
#include <tufa/shapes.h>
#include <tufa/voxelize.h>
#include <algorithm>
#include <cmath>
#include <functional>

namespace tufa::bench {
namespace {

using Maker = std::function<openvdb::FloatGrid::Ptr(double voxelSize)>;

// The longest side of a mesh's bounding box.
double extentOf(const Mesh& mesh) {
  openvdb::BBoxd box;
  for (const Position& p : mesh.positions) box.expand(openvdb::Vec3d(p.x, p.y, p.z));
  return box.empty() ? 0 : box.extents()[box.maxExtent()];
}

// A band's voxels go with the surface, so their number with the inverse square of the voxel size.
openvdb::FloatGrid::Ptr makeWithCount(const Maker& make, double voxelSize, double activeVoxels) {
  for (int round = 0; round < 2; ++round) {
    const auto count = static_cast<double>(make(voxelSize)->activeVoxelCount());
    voxelSize *= std::sqrt(count / (round == 0 ? std::min(activeVoxels, 3e5) : activeVoxels));
  }
  return make(voxelSize);
}

}  // namespace

openvdb::FloatGrid::Ptr makeVolume(const std::string& shapeOrFile, double activeVoxels) {
  if (const auto shape = shapeByName(shapeOrFile)) {
    const auto make = [&](double voxelSize) {
      ShapeOptions options;
      options.voxelSize = voxelSize;
      return makeShape(*shape, options);
    };
    return makeWithCount(make, 0.04, activeVoxels);
  }
  const Mesh mesh = readMesh(shapeOrFile);
  const auto make = [&](double voxelSize) {
    VoxelizeOptions options;
    options.voxelSize = voxelSize;
    options.exactDistances = false;  // as other programs make volumes of meshes
    return voxelize(mesh, options);
  };
  return makeWithCount(make, extentOf(mesh) / 64, activeVoxels);
}

}  // namespace tufa::bench
