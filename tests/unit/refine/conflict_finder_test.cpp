#include "refine/conflict_finder.h"

#include <gtest/gtest.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

#include "grid/volume.h"
#include "intersect/candidates.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {
namespace {

constexpr double kMargin = 1e-3;

auto keyOf(const Conflict& conflict) {
  return std::tuple(conflict.kind, conflict.parts, conflict.edge);
}

// Of these quads or faces of them.
std::vector<Conflict> sorted(std::vector<Conflict> conflicts) {
  std::sort(conflicts.begin(), conflicts.end(),
            [](const Conflict& a, const Conflict& b) { return keyOf(a) < keyOf(b); });
  return conflicts;
}

bool contains(const std::vector<Conflict>& all, const Conflict& conflict) {
  return std::any_of(all.begin(), all.end(),
                     [&](const Conflict& other) { return keyOf(other) == keyOf(conflict); });
}

// What is found around vertices that have moved, with what was found before and is not around
// them, is what a new search finds everywhere.
TEST(ConflictFinder, FindsAroundMovedVerticesWhatIsThere) {
  ShapeOptions shape;
  shape.voxelSize = 0.04;
  const auto grid = makeShape(Shape::Bracket, shape);
  base::Job job(1, {});
  uniform::UniformSurface surface =
      uniform::makeUniformSurface(grid::openVolume(*grid, {}, job), {}, {}, job);
  const double voxel = surface.affine().voxelSize();
  ConflictFinder finder(surface, kMargin * voxel, job);
  std::vector<Conflict> known = finder.findEverywhere();
  EXPECT_FALSE(known.empty());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> way(-0.6, 0.6);
  std::size_t fresh = 0;
  for (int round = 0; round < 5; ++round) {
    std::vector<VertexIndex> moved;
    for (VertexIndex v = 0; v < surface.mesh.positions.size(); ++v) {
      if (random() % 300 != 0) continue;
      surface.mesh.positions[v] =
          Vec3(surface.mesh.positions[v]) + Vec3(way(random), way(random), way(random)) * voxel;
      surface.sheets.setOutOfCell(v);
      moved.push_back(v);
    }
    finder.noteMoved(moved);
    const std::vector<Conflict> around =
        finder.findAroundMoved(ConflictFinder::Pairs::WithCandidate);
    EXPECT_EQ(finder.candidates(),
              intersect::findCandidates(surface.view(), surface.mesh, kMargin * voxel, job));
    ConflictFinder other(surface, kMargin * voxel, job);
    const std::vector<Conflict> all = other.findEverywhere();
    EXPECT_EQ(finder.pairs().close, other.pairs().close);
    EXPECT_EQ(finder.pairs().intersecting, other.pairs().intersecting);
    for (const Conflict& conflict : around) EXPECT_TRUE(contains(all, conflict));
    for (const Conflict& conflict : all) {
      if (contains(around, conflict)) continue;
      ++fresh;
      EXPECT_TRUE(contains(known, conflict));
    }
    known = sorted(all);
  }
  EXPECT_GT(fresh, 20U) << "conflicts that were there before";
}

}  // namespace
}  // namespace tufa::refine
