#include "voxelize/exact_distances.h"

#include <tufa/error.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "implicit/mesh_distance.h"
#include "implicit/solid_mesh.h"

namespace tufa::voxelize_mesh {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// None if it is not closed.
std::optional<Mesh> closedOf(const Mesh& mesh) {
  try {
    return implicit::closedMesh(mesh);
  } catch (const Error&) {  // says why it is not
    return std::nullopt;
  }
}

// Gives the samples of a level set their distances.
class Distances {
 public:
  Distances(openvdb::FloatGrid& grid, const Mesh& mesh)
      : grid_(grid), distance_(implicit::signedDistanceTo(mesh)), voxelSize_(grid.voxelSize()[0]) {}

  // Returns whether sides are OpenVDB's but for voxels near the surface.
  bool take(base::Job& job) {
    std::vector<Leaf*> leaves;
    grid_.tree().getNodes(leaves);
    std::atomic<bool> isOther{false};
    job.forRanges(leaves.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !isOther; ++i) {
        if (!takeIn(*leaves[i])) isOther = true;
      }
    });
    return !isOther && widen(leaves, job);
  }

 private:
  bool takeIn(Leaf& leaf) const {
    double last = std::numeric_limits<double>::infinity();
    openvdb::Coord lastAt;
    for (auto value = leaf.beginValueOn(); value; ++value) {
      const openvdb::Coord at = value.getCoord();
      const double way = (at - lastAt).asVec3d().length() * voxelSize_;
      last = distanceAt(at, std::abs(last) + way);
      lastAt = at;
      if (isFarOnOtherSide(last, *value)) return false;
      value.setValue(inBand(last));
    }
    return true;
  }

  // Adds voxels that OpenVDB has left out, as it took those beside them to be farther away, and
  // mends the sides of those beyond a narrow band: all that are next to one that is more than a
  // voxel within the band, or near the surface.
  bool widen(const std::vector<Leaf*>& leaves, base::Job& job) {
    auto tree = grid_.getAccessor();
    const auto background = static_cast<double>(grid_.background());
    std::vector<std::pair<openvdb::Coord, double>> next;  // and how far they may be
    const auto visit = [&](const openvdb::Coord& at, double distance) {
      const double most = std::abs(distance) + voxelSize_;
      if (most > background && std::abs(distance) > kFar * voxelSize_) return;
      for (int side = 0; side < 6; ++side) {
        openvdb::Coord beside = at;
        beside[side / 2] += side % 2 == 0 ? -1 : 1;
        if (!tree.isValueOn(beside)) next.emplace_back(beside, most);
      }
    };
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      job.pollCancelled(i);
      for (auto value = leaves[i]->cbeginValueOn(); value; ++value) {
        visit(value.getCoord(), static_cast<double>(*value));
      }
    }
    for (std::size_t done = 0; !next.empty(); ++done) {
      job.pollCancelled(done);
      const auto [at, most] = next.back();
      next.pop_back();
      if (tree.isValueOn(at)) continue;
      const double distance = distanceAt(at, most);
      const float before = tree.getValue(at);
      if (isFarOnOtherSide(distance, before)) return false;
      if (std::abs(distance) < background) {
        tree.setValue(at, inBand(distance));
        visit(at, distance);
      } else if ((distance < 0) != (before < 0)) {
        tree.setValueOff(at, inBand(distance));
      }
    }
    return true;
  }

  [[nodiscard]] double distanceAt(const openvdb::Coord& at, double most) const {
    return distance_(Vec3(at.x(), at.y(), at.z()) * voxelSize_, most);
  }
  [[nodiscard]] bool isFarOnOtherSide(double distance, float before) const {
    return (distance < 0) != (before < 0) && std::abs(distance) >= kFar * voxelSize_;
  }
  [[nodiscard]] float inBand(double distance) const {
    return std::clamp(static_cast<float>(distance), -grid_.background(), grid_.background());
  }

  // Voxels. OpenVDB's signs may be wrong at up to 1.3 in sample meshes.
  static constexpr double kFar = 2;

  openvdb::FloatGrid& grid_;
  implicit::SignedDistance distance_;
  double voxelSize_;
};

}  // namespace

bool takeExactDistances(openvdb::FloatGrid& grid, const Mesh& mesh, base::Job& job) {
  const std::optional<Mesh> closed = closedOf(mesh);
  if (!closed || implicit::intersectsItself(*closed, job)) return false;
  const auto exact = openvdb::gridPtrCast<openvdb::FloatGrid>(grid.deepCopyGrid());
  if (!Distances(*exact, *closed).take(job)) return false;
  grid.setTree(exact->treePtr());
  return true;
}

}  // namespace tufa::voxelize_mesh
