#include "refine/withdraw_placements.h"

#include <gtest/gtest.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>
#include <tufa/voxelize.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "grid/volume.h"
#include "support/random_solid.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {
namespace {

// Edges between faces of more than 0.02 square voxels that turn by more than 140 degrees, but for
// those between two vertices on creases: the solid may be as sharp there.
int foldsOf(const uniform::UniformSurface& surface) {
  const Mesh& mesh = surface.mesh;
  std::map<std::pair<VertexIndex, VertexIndex>, Vec3> normals;
  const double voxel = surface.affine().voxelSize(), leastArea = 0.02 * voxel * voxel;
  int folds = 0;
  for (const Triangle& face : triangulate(mesh)) {
    const auto& v = face.vertices;
    const Vec3 a(mesh.positions[v[0]]), b(mesh.positions[v[1]]), c(mesh.positions[v[2]]);
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.length() < 2 * leastArea) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(v[i], v[(i + 1) % 3]);
      const auto [other, isFirst] = normals.try_emplace({low, high}, normal);
      if (isFirst || (surface.sheets.isSharp(low) && surface.sheets.isSharp(high))) continue;
      folds += other->second.dot(normal) < -0.766 * other->second.length() * normal.length();
    }
  }
  return folds;
}

TEST(WithdrawPlacements, LeavesNoFoldButOnCreases) {
  int before = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    VoxelizeOptions voxelize;
    voxelize.voxelSize = 0.04;
    const std::string text = test::randomSolid(seed);
    const auto grid =
        tufa::voxelize(*implicit::readScene(FileBytes{text, "solid"}).field, voxelize);
    if (grid->activeVoxelCount() == 0) continue;
    base::Job job(1, {});
    uniform::UniformSurface surface =
        uniform::makeUniformSurface(grid::openVolume(*grid, {}, job), {}, {}, job);
    before += foldsOf(surface);
    const Withdrawal withdrawal = withdrawPlacements(surface, 0, job);
    EXPECT_LE(foldsOf(surface), static_cast<int>(withdrawal.left)) << "seed " << seed;
  }
  EXPECT_GT(before, 20);
}

}  // namespace
}  // namespace tufa::refine
