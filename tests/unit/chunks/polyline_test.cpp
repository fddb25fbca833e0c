#include "chunks/seams/polyline.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "chunks/seams/face_segments.h"

namespace tufa::chunks {
namespace {

const grid::Affine kLattice{grid::Transform(*openvdb::math::Transform::createLinearTransform(1.0))};

SeamVertex vertexAt(double y, double z) {
  const Coord cell(16, static_cast<int>(std::floor(y)), static_cast<int>(std::floor(z)));
  return {cell, Vec3(0, y - cell[1], z - cell[2]), Normal(0, 0, 1)};
}

// A curve along y on the face at x = 16, its arcs at these heights.
void addCurve(Seams& seams, const std::vector<double>& heights) {
  SeamCurve curve;
  curve.chunk = Coord(1, 0, 0);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    curve.arcs.push_back(static_cast<SeamIndex>(seams.arcs.size()));
    seams.arcs.emplace_back();
    seams.vertices.push_back(vertexAt(static_cast<double>(i) + 0.5, heights[i]));
  }
  seams.curves.push_back(curve);
}

// A loop of arcs around a point of the face.
void addLoop(Seams& seams, int count, double radius) {
  SeamCurve curve;
  curve.chunk = Coord(1, 0, 0);
  curve.closed = true;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    curve.arcs.push_back(static_cast<SeamIndex>(seams.arcs.size()));
    seams.arcs.emplace_back();
    seams.vertices.push_back(
        vertexAt(20.3 + radius * std::cos(angle), 20.3 + radius * std::sin(angle)));
  }
  seams.curves.push_back(curve);
}

std::vector<SeamIndex> verticesOf(const SeamPolylines& lines, const SeamCurve& curve) {
  std::vector<SeamIndex> vertices;
  for (const SeamIndex arc : curve.arcs) {
    if (vertices.empty() || vertices.back() != lines[arc]) vertices.push_back(lines[arc]);
  }
  return vertices;
}

Vec3 placeOf(const Seams& seams, SeamIndex vertex) {
  return Vec3(seams.vertices[vertex].cell) + seams.vertices[vertex].offset;
}

SeamPolylines simplified(const Seams& seams, double budget,
                         const PolylineValidation& validation = nullptr) {
  return simplifySeams(
      seams, kLattice, [&](const Vec3&) { return budget; }, validation);
}

TEST(SimplifySeams, LeavesTheEndsOfAStraightCurve) {
  Seams seams;
  addCurve(seams, std::vector<double>(12, 3.5));
  EXPECT_EQ(verticesOf(simplified(seams, 0.1), seams.curves[0]), (std::vector<SeamIndex>{0, 11}));
}

TEST(SimplifySeams, GivesEachVertexOneStretchOfArcs) {
  Seams seams;
  addCurve(seams, {0.5, 0.5, 0.5, 0.5, 3.5, 3.5, 3.5, 3.5, 0.5, 0.5});
  const SeamPolylines lines = simplified(seams, 0.3);
  const auto vertices = verticesOf(lines, seams.curves[0]);
  const std::set<SeamIndex> distinct(vertices.begin(), vertices.end());
  EXPECT_EQ(distinct.size(), vertices.size());
  EXPECT_GT(vertices.size(), 3U);
  for (const SeamIndex vertex : vertices) EXPECT_EQ(lines[vertex], vertex) << "stands for itself";
}

TEST(SimplifySeams, KeepsWhatIsFartherThanAllowed) {
  Seams seams;
  std::vector<double> heights(15, 3.2);
  heights[6] = 3.6;
  addCurve(seams, heights);
  EXPECT_EQ(verticesOf(simplified(seams, 0.5), seams.curves[0]).size(), 2U);
  const auto vertices = verticesOf(simplified(seams, 0.3), seams.curves[0]);
  EXPECT_EQ(std::count(vertices.begin(), vertices.end(), 6U), 1);
}

TEST(SimplifySeams, AsksWhatIsAllowedWhereTheVertexLies) {
  Seams seams;
  std::vector<double> heights(20, 3.2);
  heights[5] = heights[14] = 3.6;
  addCurve(seams, heights);
  const SeamPolylines lines =
      simplifySeams(seams, kLattice, [](const Vec3& at) { return at[1] < 10 ? 1.0 : 0.1; });
  const auto vertices = verticesOf(lines, seams.curves[0]);
  EXPECT_EQ(std::count(vertices.begin(), vertices.end(), 5U), 0);
  EXPECT_EQ(std::count(vertices.begin(), vertices.end(), 14U), 1);
}

TEST(SimplifySeams, IsWithinWhatIsAllowedOnACircle) {
  Seams seams;
  addLoop(seams, 60, 9);
  std::size_t before = 61;
  for (const double budget : {0.0, 0.05, 0.4}) {
    const SeamPolylines lines = simplified(seams, budget);
    auto vertices = verticesOf(lines, seams.curves[0]);
    if (vertices.front() == vertices.back()) vertices.pop_back();
    EXPECT_LT(vertices.size(), before);
    before = vertices.size();
    const auto place = [&](SeamIndex i) { return placeOf(seams, i); };
    for (const SeamIndex arc : seams.curves[0].arcs) {
      double least = 1e30;
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3 a = place(vertices[i]), way = place(vertices[(i + 1) % vertices.size()]) - a;
        const double along = std::clamp((place(arc) - a).dot(way) / way.squaredLength(), 0.0, 1.0);
        least = std::min(least, (place(arc) - a - way * along).length());
      }
      EXPECT_LE(least, budget + 1e-9) << arc;
    }
  }
}

TEST(SimplifySeams, LeavesThreeVerticesOfALoop) {
  Seams seams;
  addLoop(seams, 24, 3);
  const SeamPolylines lines = simplified(seams, 1000);
  const auto vertices = verticesOf(lines, seams.curves[0]);
  const std::set<SeamIndex> distinct(vertices.begin(), vertices.end());
  EXPECT_GE(distinct.size(), 3U);
  EXPECT_LE(distinct.size(), 8U);
}

TEST(SimplifySeams, NeedsOneVertexBetweenTwoChunkEdges) {
  Seams seams;
  addCurve(seams, std::vector<double>(16, 3.5));
  seams.curves[0].begin = static_cast<SeamIndex>(seams.vertices.size());
  seams.vertices.push_back(vertexAt(0, 3.5));
  seams.curves[0].end = static_cast<SeamIndex>(seams.vertices.size());
  seams.vertices.push_back(vertexAt(16, 3.5));
  const SeamPolylines lines = simplified(seams, 0.1);
  EXPECT_EQ(verticesOf(lines, seams.curves[0]).size(), 1U);
  EXPECT_EQ(lines[16], 16U);
  EXPECT_EQ(lines[17], 17U);
}

// A curve that leads around a loop; simplified alone it would pass through.
TEST(SimplifySeams, DoesNotCrossOtherLinesOfTheFace) {
  Seams seams;
  std::vector<double> heights(40, 19.2);
  std::fill(heights.begin() + 16, heights.begin() + 25, 24.2);
  addCurve(seams, heights);
  ASSERT_EQ(verticesOf(simplified(seams, 100), seams.curves[0]).size(), 2U);
  addLoop(seams, 24, 2);
  const SeamPolylines lines = simplified(seams, 100);
  EXPECT_GT(verticesOf(lines, seams.curves[0]).size(), 2U);
  std::vector<FaceSegment> segments;
  for (std::size_t curve = 0; curve < 2; ++curve) {
    auto vertices = verticesOf(lines, seams.curves[curve]);
    if (curve == 1 && vertices.back() != vertices.front()) vertices.push_back(vertices.front());
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      const Vec3 a = placeOf(seams, vertices[i]), b = placeOf(seams, vertices[i + 1]);
      segments.push_back({curve, i, i + 1, {a[1], a[2]}, {b[1], b[2]}});
    }
  }
  for (const FaceSegment& s : segments) {
    for (const FaceSegment& t : segments) EXPECT_FALSE(&s != &t && intersectElsewhere(s, t));
  }
}

TEST(SimplifySeams, StaysOffTheSideThatFacesTheOtherWay) {
  Seams seams;
  std::vector<double> heights(15, 3.2);
  heights[6] = 3.6;
  addCurve(seams, heights);
  seams.arcs[6].clearance = 0.9F;  // a third of it may be used up
  const auto vertices = verticesOf(simplified(seams, 10), seams.curves[0]);
  EXPECT_EQ(std::count(vertices.begin(), vertices.end(), 6U), 1);
}

TEST(SimplifySeams, HasShortSegmentsWhereTheSurfaceIsBent) {
  Seams seams;
  addCurve(seams, std::vector<double>(40, 3.5));
  for (SeamIndex arc = 18; arc < 22; ++arc) seams.arcs[arc].flatness.fill(1);
  const auto vertices = verticesOf(simplified(seams, 0.1), seams.curves[0]);
  std::size_t shortest = 40;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    shortest = std::min<std::size_t>(shortest, vertices[i] - vertices[i - 1]);
  }
  EXPECT_GT(vertices.size(), 4U);
  EXPECT_LE(shortest, 5U);
}

TEST(SimplifySeams, IsFinerWhereATrialFindsFaults) {
  Seams seams;
  addCurve(seams, std::vector<double>(16, 3.5));
  int asked = 0;
  const PolylineValidation validation = [&](std::size_t begin, std::size_t end) -> FaceValidation {
    EXPECT_EQ(begin, 0U);
    EXPECT_EQ(end, 1U);
    return [&](const SeamPolylines& lines) {
      // Until vertex 7 or 8, in the middle, is there.
      ++asked;
      LineFaults faults;
      if (lines[7] != 7 && lines[8] != 8) faults.meeting = {lines[0]};
      return faults;
    };
  };
  EXPECT_EQ(verticesOf(simplified(seams, 0.1, validation), seams.curves[0]).size(), 3U);
  EXPECT_EQ(asked, 2);
}

TEST(QuadrantsOf, AreThoseOfTheLeastSquareThatHoldsTheLoop) {
  Seams seams;
  addLoop(seams, 40, 9);  // from 11 to 29 along both axes: parted at 16
  const auto quadrants = quadrantsOf(seams, seams.curves[0]);
  ASSERT_EQ(quadrants.size(), 40U);
  for (std::size_t i = 0; i < quadrants.size(); ++i) {
    const Coord& cell = seams.vertices[i].cell;
    EXPECT_EQ(quadrants[i], (cell[1] >= 16 ? 2 : 0) + (cell[2] >= 16 ? 1 : 0));
  }
}

TEST(QuadrantsOf, AreNoneInASingleCell) {
  Seams seams;
  addLoop(seams, 5, 0.1);
  EXPECT_TRUE(quadrantsOf(seams, seams.curves[0]).empty());
}

}  // namespace
}  // namespace tufa::chunks
