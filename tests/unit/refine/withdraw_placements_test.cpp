#include "refine/withdraw_placements.h"

#include <gtest/gtest.h>
#include <tufa/implicit.h>
#include <tufa/memory.h>
#include <tufa/voxelize.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "grid/volume.h"
#include "support/random_solid.h"
#include "uniform/place_vertices.h"
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

// Of samples that are hardly inside or outside, all vertices around are near them, in any order.
TEST(WithdrawPlacements, LeavesNoFoldBetweenMassPointsThatCrowd) {
  constexpr int kSide = 40;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(-1, 1);
  const auto grid = openvdb::FloatGrid::create(1);
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const openvdb::Coord at(i % kSide, i / kSide % kSide, i / (kSide * kSide));
    const float x = value(random);
    grid->tree().setValue(at, x * x * x);
  }
  base::Job job(1, {});
  uniform::UniformSurface surface =
      uniform::makeUniformSurface(grid::openVolume(*grid, {}, job), {}, {}, job);
  const int before = foldsOf(surface);
  const Withdrawal withdrawal = withdrawPlacements(surface, 0, job);
  EXPECT_GT(before, 100);
  EXPECT_EQ(foldsOf(surface), 0);
  EXPECT_EQ(withdrawal.left, 0u);
}

// Every quad of a checkerboard meets a dozen others: tried one by one, moves took 25 times as long.
TEST(WithdrawPlacements, GoesToMassPointsAtOnceInACrowd) {
  constexpr int kSide = 10;
  const auto grid = openvdb::FloatGrid::create(1);
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const openvdb::Coord at(i % kSide, i / kSide % kSide, i / (kSide * kSide));
    grid->tree().setValue(at, (at[0] + at[1] + at[2]) % 2 == 0 ? 1.0f : -1.0f);
  }
  base::Job job(1, {});
  uniform::UniformSurface surface =
      uniform::makeUniformSurface(grid::openVolume(*grid, {}, job), {}, {}, job);
  const Withdrawal withdrawal = withdrawPlacements(surface, 0, job);
  EXPECT_GT(withdrawal.pairsFound, surface.mesh.quads.size());
  std::vector<VertexIndex> vertices(surface.mesh.positions.size());
  std::iota(vertices.begin(), vertices.end(), 0);
  const std::vector<Position> mass =
      uniform::fallbackPoints(surface.volume.blocks, surface.volume.scale, surface.topology,
                              surface.affine(), vertices, job)
          .mass;
  std::size_t moved = 0;
  for (const VertexIndex i : vertices) moved += surface.mesh.positions[i] == mass[i] ? 1 : 0;
  EXPECT_GE(moved, withdrawal.vertices);
  EXPECT_GT(withdrawal.vertices, vertices.size() / 2);
}

}  // namespace
}  // namespace tufa::refine
