#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tufa/voxelize.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/job.h"
#include "base/lattice_range.h"
#include "base/number_text.h"
#include "base/part_of_progress.h"
#include "base/require_mesh.h"
#include "base/vec3.h"
#include "grid/progress_interrupter.h"
#include "implicit/shell_layers.h"
#include "voxelize/exact_distances.h"
#include "voxelize/fog.h"

namespace tufa {
namespace {

/// The mesh as meshToVolume() wants it: index-space points and polygons.
class IndexSpaceMesh {
 public:
  IndexSpaceMesh(const Mesh& mesh, double voxelSize) : mesh_(mesh), voxelSize_(voxelSize) {}

  [[nodiscard]] std::size_t polygonCount() const {
    return mesh_.triangles.size() + mesh_.quads.size();
  }
  [[nodiscard]] std::size_t pointCount() const { return mesh_.positions.size(); }
  [[nodiscard]] std::size_t vertexCount(std::size_t polygon) const {
    return polygon < mesh_.triangles.size() ? 3 : 4;
  }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, openvdb::Vec3d& point) const {
    const std::size_t triangles = mesh_.triangles.size();
    const VertexIndex vertex = polygon < triangles
                                   ? mesh_.triangles[polygon].vertices[corner]
                                   : mesh_.quads[polygon - triangles].vertices[corner];
    const Position& p = mesh_.positions[vertex];
    point = openvdb::Vec3d(p.x, p.y, p.z) / voxelSize_;
  }

 private:
  const Mesh& mesh_;
  double voxelSize_;
};

/// Throws for voxels too small for the lattice's coordinates.
void requireUsableExtent(const Mesh& mesh, const VoxelizeOptions& options) {
  double largest = 0;
  for (const Position& p : mesh.positions) {
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  // OpenVDB's mesher computes in single precision: beyond that it loses the faces.
  constexpr double kLimit = 1 << 24;
  const double voxels = largest / options.voxelSize + options.halfWidth;
  if (voxels < kLimit) return;
  throw Error(ErrorCode::InvalidArgument,
              "voxel size " + base::numberText(options.voxelSize) + " puts the mesh " +
                  base::numberText(voxels) +
                  " voxels from the origin, more than the grid's limit of " +
                  base::numberText(kLimit));
}

/// An estimate of the voxels of the band, on the high side where faces overlap. Memory goes by the
/// blocks of 8^3 voxels that the band passes, which hold less of it around a needle than around a
/// plane: so a needle counts as the plane whose blocks take as much.
double bandVoxelsOf(const Mesh& mesh, const VoxelizeOptions& options) {
  constexpr double kBlockReach = 6;  // the band's blocks reach about so much farther than the band
  constexpr double kLong = 64;       // of shorter faces the blocks are those of others, too
  const double reach = options.halfWidth + kBlockReach;
  double area = 0, lengths = 0;
  for (const Triangle& t : triangulate(mesh)) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = Vec3(mesh.positions[t.vertices[k]]) / options.voxelSize;
    }
    area += (p[1] - p[0]).cross(p[2] - p[0]).length() / 2;
    const std::array<double, 3> sides{(p[1] - p[0]).length(), (p[2] - p[1]).length(),
                                      (p[0] - p[2]).length()};
    if (*std::max_element(sides.begin(), sides.end()) > kLong) {
      lengths += sides[0] + sides[1] + sides[2];
    }
  }
  // The volume within a distance of a triangle: a slab, half a tube along each side, and a ball.
  const double tubes = std::numbers::pi / 2 * reach * options.halfWidth * lengths;
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(options.halfWidth, 3);
  return 2 * options.halfWidth * area + tubes + ball;
}

/// Throws for bands of more voxels than the options allow.
void requireUsableBand(const Mesh& mesh, const VoxelizeOptions& options) {
  const double voxels = bandVoxelsOf(mesh, options);
  if (voxels <= options.bandVoxels) return;
  throw Error(ErrorCode::LimitExceeded,
              "the band around the mesh has about " +
                  base::roughNumberAbove(voxels, options.bandVoxels) + " voxels, more than " +
                  base::numberText(options.bandVoxels) +
                  "; take larger voxels, or raise the limit (VoxelizeOptions::bandVoxels)");
}

/// Takes all that closed parts enclose for inside, cavities too.
openvdb::FloatGrid::Ptr filled(const Mesh& mesh, const VoxelizeOptions& options,
                               grid::ProgressInterrupter& interrupter) {
  const auto transform = openvdb::math::Transform::createLinearTransform(options.voxelSize);
  const float halfWidth = static_cast<float>(options.halfWidth);
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      interrupter, IndexSpaceMesh(mesh, options.voxelSize), *transform, halfWidth, halfWidth);
}

/// Layers of shells, each added to those before or taken from them.
openvdb::FloatGrid::Ptr combined(const std::vector<implicit::ShellLayer>& layers,
                                 const VoxelizeOptions& options,
                                 grid::ProgressInterrupter& interrupter) {
  openvdb::FloatGrid::Ptr all;
  for (const implicit::ShellLayer& layer : layers) {
    const openvdb::FloatGrid::Ptr part = filled(layer.mesh, options, interrupter);
    if (interrupter.cancelled()) return part;
    if (!all) {
      all = part;
    } else if (layer.isCavity) {
      openvdb::tools::csgDifference(*all, *part);
    } else {
      openvdb::tools::csgUnion(*all, *part);
    }
  }
  return all;
}

}  // namespace

openvdb::FloatGrid::Ptr voxelize(const Mesh& mesh, const VoxelizeOptions& options,
                                 MeshDistances* distances) {
  base::requireVoxelSize(options.voxelSize);
  base::requireHalfWidth(options.halfWidth);
  if (mesh.triangleCount() == 0) {
    throw Error(ErrorCode::InvalidArgument, "the mesh has no faces to voxelize");
  }
  constexpr double kLayersEnd = 0.01, kVoxelsEnd = 0.4;  // of the time that it took, nearly
  base::Job job(options.threads, options.progress);
  job.beginStage("voxelizing", kLayersEnd);
  base::requireFaces(mesh);
  base::requireFinite(mesh);
  requireUsableExtent(mesh, options);
  requireUsableBand(mesh, options);
  openvdb::initialize();

  grid::ProgressInterrupter interrupter(options.progress, "voxelizing", kLayersEnd,
                                        options.exactDistances ? kVoxelsEnd : 1);
  openvdb::FloatGrid::Ptr result;
  bool boundsSolid = false;
  job.run([&] {
    const implicit::Shells shells = implicit::findShells(mesh, options.exactDistances, job);
    boundsSolid = shells.boundSolid;
    result = shells.layers.empty() ? filled(mesh, options, interrupter)
                                   : combined(shells.layers, options, interrupter);
  });
  if (interrupter.cancelled() || interrupter.wasInterrupted(100))
    throw Error(ErrorCode::Cancelled, "cancelled while voxelizing");
  bool areExact = false;
  if (options.exactDistances) {
    base::Job rest(options.threads, base::partOf(options.progress, kVoxelsEnd, 1));
    rest.beginStage("distances", 1);
    if (boundsSolid) {
      rest.run([&] { areExact = voxelize_mesh::takeExactDistances(*result, mesh, rest); });
    }
    rest.finish();
  }
  if (distances != nullptr) *distances = areExact ? MeshDistances::Exact : MeshDistances::OpenVdb;
  result->setGridClass(openvdb::GRID_LEVEL_SET);
  result->setName("surface");
  if (options.fog) base::runWithThreads(options.threads, [&] { voxelize_field::toFog(*result); });
  return result;
}

}  // namespace tufa
