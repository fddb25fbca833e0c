#include "intersect/cut_candidates.h"

#include <gtest/gtest.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "intersect/surface.h"
#include "octree/leaves.h"
#include "support/model.h"

namespace tufa::intersect {
namespace {

// What findCutCandidates() promises, of cuts as coarse as a tolerance lets them be, whose polygons
// nobody has looked at: every pair has a candidate.
TEST(CutCandidates, HaveAPartInEveryPair) {
  std::size_t pairs = 0, candidates = 0, polygons = 0;
  for (const Shape shape :
       {Shape::Noise, Shape::Sphere, Shape::Gyroid, Shape::Bracket, Shape::Terrain}) {
    for (const double tolerance : {0.1, 0.5, 4.0}) {
      ShapeOptions shapeOptions;
      shapeOptions.voxelSize = shape == Shape::Noise ? 0.1 : 0.04;
      ContourOptions options;
      options.tolerance = tolerance;
      test::ModelOf model(makeShape(shape, shapeOptions), options);
      const octree::ClusterForest& forest = model.model().forest();
      const uniform::SurfaceView view = model.model().view();
      const octree::CellFlags merged =
          octree::mergeCells(forest, model.rule(), octree::CellFlags(forest), model.job());
      const octree::Cut cut = octree::makeCut(forest, view.topology, merged, model.job());
      octree::CutMesh made = octree::meshCut(forest, cut, model.mesh(), view.affine, model.job());
      const std::vector<std::uint8_t> isCandidate =
          findCutCandidates(forest, cut, made, view, 1e-4 * model.voxelSize(), model.job());
      ASSERT_EQ(isCandidate.size(), made.mesh.quads.size() + made.mesh.triangles.size());
      std::vector<PolygonIndex> all(isCandidate.size());
      std::iota(all.begin(), all.end(), 0U);
      const Surface surface(made.mesh, model.job());
      for (const PolygonPair& pair : findPairs(surface, all, model.job())) {
        ++pairs;
        EXPECT_TRUE(isCandidate[pair.a] != 0 || isCandidate[pair.b] != 0)
            << "shape " << static_cast<int>(shape) << ", tolerance " << tolerance;
      }
      if (shape != Shape::Sphere) continue;  // where the surface bends little, few are
      candidates += static_cast<std::size_t>(
          std::count(isCandidate.begin(), isCandidate.end(), std::uint8_t{1}));
      polygons += all.size();
    }
  }
  EXPECT_GT(pairs, 100U);
  EXPECT_LT(3 * candidates, polygons);
}

}  // namespace
}  // namespace tufa::intersect
