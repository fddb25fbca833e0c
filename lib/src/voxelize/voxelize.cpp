#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/util/NullInterrupter.h>
#include <tufa/voxelize.h>

#include <tufa/error.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <thread>

#include "base/job.h"
#include "base/lattice_range.h"
#include "base/number_text.h"
#include "base/vec3.h"

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

/// Passes OpenVDB's interrupt checks on to a Progress. OpenVDB calls from any thread and gives the
/// percentage only at times, so only the caller's thread passes it on.
class ProgressInterrupter final : public openvdb::util::NullInterrupter {
 public:
  explicit ProgressInterrupter(const Progress& progress) : progress_(progress) {}

  bool wasInterrupted(int percent = -1) override {
    if (progress_ && std::this_thread::get_id() == caller_) {
      fraction_ = std::max(fraction_, std::min(percent / 100.0, 1.0));
      bool goOn = true;
      base::runIsolated([&] { goOn = progress_("voxelizing", fraction_); });
      if (!goOn) cancelled_ = true;
    }
    return cancelled_;
  }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  const Progress& progress_;
  std::thread::id caller_ = std::this_thread::get_id();
  double fraction_ = 0;
  std::atomic<bool> cancelled_{false};
};

void requireUsableFaces(const Mesh& mesh) {
  const auto requireInside = [&](const auto& face) {
    for (const VertexIndex vertex : face.vertices) {
      if (vertex < mesh.positions.size()) continue;
      throw Error(ErrorCode::InvalidArgument, "a face names vertex " + std::to_string(vertex) +
                                                  " of " + std::to_string(mesh.positions.size()));
    }
  };
  std::for_each(mesh.triangles.begin(), mesh.triangles.end(), requireInside);
  std::for_each(mesh.quads.begin(), mesh.quads.end(), requireInside);
}

/// Throws for meshes that are not finite, and for voxels too small for the lattice's coordinates.
void requireUsableExtent(const Mesh& mesh, const VoxelizeOptions& options) {
  double largest = 0;
  for (const Position& p : mesh.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw Error(ErrorCode::InvalidArgument, "the mesh has a vertex that is not finite");
    }
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  constexpr double kLimit = 1 << 30;
  const double voxels = largest / options.voxelSize + options.halfWidth;
  if (voxels < kLimit) return;
  throw Error(ErrorCode::InvalidArgument,
              "voxel size " + base::numberText(options.voxelSize) + " puts the mesh " +
                  base::numberText(voxels) +
                  " voxels from the origin, more than the grid's limit of " +
                  base::numberText(kLimit));
}

/// Throws for bands of more voxels than the options allow.
void requireUsableBand(const Mesh& mesh, const VoxelizeOptions& options) {
  double area = 0;
  for (const Triangle& t : triangulate(mesh)) {
    const auto corner = [&](std::size_t k) {
      return Vec3(mesh.positions[t.vertices[k]]) / options.voxelSize;
    };
    area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).length() / 2;
  }
  // Around faces, and around a mesh much smaller than the band is wide.
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(options.halfWidth, 3);
  const double voxels = 2 * options.halfWidth * area + ball;
  if (voxels <= options.bandVoxels) return;
  throw Error(ErrorCode::LimitExceeded,
              "the band around the mesh has about " + base::numberText(voxels) +
                  " voxels, more than " + base::numberText(options.bandVoxels) +
                  "; take larger voxels, or raise the limit (--band-voxels)");
}

}  // namespace

openvdb::FloatGrid::Ptr voxelize(const Mesh& mesh, const VoxelizeOptions& options) {
  base::requireVoxelSize(options.voxelSize);
  base::requireHalfWidth(options.halfWidth);
  if (mesh.triangleCount() == 0) {
    throw Error(ErrorCode::InvalidArgument, "the mesh has no faces to voxelize");
  }
  requireUsableFaces(mesh);
  requireUsableExtent(mesh, options);
  requireUsableBand(mesh, options);
  openvdb::initialize();

  ProgressInterrupter interrupter(options.progress);
  const auto transform = openvdb::math::Transform::createLinearTransform(options.voxelSize);
  const float halfWidth = static_cast<float>(options.halfWidth);
  openvdb::FloatGrid::Ptr grid;
  base::Job(options.threads, {}).run([&] {
    grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        interrupter, IndexSpaceMesh(mesh, options.voxelSize), *transform, halfWidth, halfWidth);
  });
  if (interrupter.cancelled()) throw Error(ErrorCode::Cancelled, "cancelled while voxelizing");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  return grid;
}

}  // namespace tufa
