// Curves on the faces between chunks that cross each other.

#include "chunks/seams/untangle.h"

#include <gtest/gtest.h>

namespace tufa::chunks {
namespace {

// A curve along y on a face across x, through the middles of cells, its vertices at these heights.
void addCurve(Seams& seams, std::vector<Vec3>& fallbacks, const std::vector<double>& heights,
              double fallback) {
  SeamCurve curve;
  curve.axis = 0;
  curve.chunk = Coord(1, 0, 0);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    curve.arcs.push_back(static_cast<SeamIndex>(seams.arcs.size()));
    seams.arcs.emplace_back();
    seams.vertices.push_back(
        {Coord(16, static_cast<int>(i), 0), Vec3(0, 0.5, heights[i]), Normal(0, 0, 1)});
    fallbacks.emplace_back(0, 0.5, fallback);
  }
  seams.curves.push_back(curve);
}

std::vector<double> heights(const Seams& seams, std::size_t curve) {
  std::vector<double> found;
  for (const SeamIndex arc : seams.curves[curve].arcs) {
    found.push_back(seams.vertices[arc].offset[2]);
  }
  return found;
}

TEST(Untangle, LeavesCurvesThatDoNotCross) {
  Seams seams;
  std::vector<Vec3> fallbacks;
  addCurve(seams, fallbacks, {0.2, 0.3, 0.2, 0.3}, 0.1);
  addCurve(seams, fallbacks, {0.7, 0.6, 0.7, 0.6}, 0.9);
  untangle(fallbacks, seams);
  EXPECT_EQ(heights(seams, 0), (std::vector<double>{0.2, 0.3, 0.2, 0.3}));
  EXPECT_EQ(heights(seams, 1), (std::vector<double>{0.7, 0.6, 0.7, 0.6}));
}

TEST(Untangle, MovesNoMoreThanItMust) {
  Seams seams;
  std::vector<Vec3> fallbacks;
  addCurve(seams, fallbacks, {0.2, 0.2, 0.8, 0.2, 0.2}, 0.1);
  addCurve(seams, fallbacks, {0.7, 0.7, 0.7, 0.7, 0.7}, 0.9);
  untangle(fallbacks, seams);
  EXPECT_EQ(heights(seams, 0), (std::vector<double>{0.2, 0.1, 0.1, 0.1, 0.2}));
  EXPECT_EQ(heights(seams, 1), (std::vector<double>{0.7, 0.9, 0.9, 0.9, 0.7}));
}

TEST(Untangle, MovesVerticesThatLeadBack) {
  Seams seams;
  std::vector<Vec3> fallbacks;
  addCurve(seams, fallbacks, {0.5, 0.5, 0.5, 0.5, 0.5}, 0.6);
  // The third vertex lies behind the second.
  seams.vertices[1].offset[1] = 0.9;
  seams.vertices[2].offset[1] = -0.4;
  untangle(fallbacks, seams);
  EXPECT_EQ(heights(seams, 0), (std::vector<double>{0.5, 0.6, 0.6, 0.5, 0.5}));
  EXPECT_EQ(seams.vertices[1].offset, fallbacks[1]);
}

TEST(Untangle, LeavesSharpCorners) {
  Seams seams;
  std::vector<Vec3> fallbacks;
  // Up and down again by ten voxels, one apart.
  addCurve(seams, fallbacks, {0.5, 0.5, 10.5, 0.5, 0.5}, 0.6);
  untangle(fallbacks, seams);
  EXPECT_EQ(heights(seams, 0), (std::vector<double>{0.5, 0.5, 10.5, 0.5, 0.5}));
}

TEST(Untangle, DoesNotMoveOneFaceForAnother) {
  Seams seams;
  std::vector<Vec3> fallbacks;
  addCurve(seams, fallbacks, {0.2, 0.8, 0.2}, 0.1);
  addCurve(seams, fallbacks, {0.7, 0.7, 0.7}, 0.9);
  seams.curves[1].chunk = Coord(2, 0, 0);
  untangle(fallbacks, seams);
  EXPECT_EQ(heights(seams, 0), (std::vector<double>{0.2, 0.8, 0.2}));
  EXPECT_EQ(heights(seams, 1), (std::vector<double>{0.7, 0.7, 0.7}));
}

// A point on a chunk edge belongs to several faces.
TEST(Untangle, KeepsPointsOnChunkEdges) {
  Seams seams;
  std::vector<Vec3> fallbacks;
  addCurve(seams, fallbacks, {0.2, 0.2}, 0.1);
  addCurve(seams, fallbacks, {0.7, 0.7}, 0.9);
  seams.vertices.push_back({Coord(16, -1, 0), Vec3(0, 0.5, 0.95), Normal(0, 0, 1)});
  seams.curves[0].begin = 4;
  seams.vertices.push_back({Coord(16, -1, 0), Vec3(0, 0.5, 0.3), Normal(0, 0, 1)});
  seams.curves[1].begin = 5;
  untangle(fallbacks, seams);
  EXPECT_EQ(seams.vertices[4].offset, Vec3(0, 0.5, 0.95));
  EXPECT_EQ(seams.vertices[5].offset, Vec3(0, 0.5, 0.3));
  EXPECT_EQ(heights(seams, 0), (std::vector<double>{0.1, 0.2}));
}

}  // namespace
}  // namespace tufa::chunks
