// The helpers of seams: which chunk a cell lies in, segments on a face, the sides of a curve, and
// what is measured around an arc.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "chunks/seams/chunk_cells.h"
#include "chunks/seams/clearance.h"
#include "chunks/seams/curve_side.h"
#include "chunks/seams/face_segments.h"
#include "chunks/seams/flatness.h"
#include "support/print.h"

namespace tufa::chunks {
namespace {

const ChunkCells kChunks{4, {Coord(-1, 0, 2), Coord(1, 2, 3)}};

TEST(ChunkCells, LieInTheChunkBelowThem) {
  EXPECT_EQ(kChunks.chunkOf(Coord(0, 15, 16)), Coord(0, 0, 1));
  EXPECT_EQ(kChunks.chunkOf(Coord(-1, -16, -17)), Coord(-1, -1, -2));
}

TEST(ChunkCells, NumberTheChunksToBeMadeInOrder) {
  EXPECT_EQ(kChunks.count(), 3 * 3 * 2);
  Coord before(-100);
  for (std::int32_t number = 0; number < kChunks.count(); ++number) {
    const Coord chunk = kChunks.chunkAt(number);
    EXPECT_LT(before, chunk);
    EXPECT_EQ(kChunks.numberOf(chunk), number);
    before = chunk;
  }
  for (const Coord& other : {Coord(-2, 0, 2), Coord(0, 3, 2), Coord(0, 0, 1), Coord(0, 0, 4)}) {
    EXPECT_EQ(kChunks.numberOf(other), ChunkCells::kNotOwn) << other;
  }
}

TEST(ChunkCells, KeepPointsOffTheFacesOfTheirChunk) {
  const Coord cell(5, -1, 17), from(3, -4, 20);
  // The chunk of the cell, counted from `from`.
  const Vec3 lower = Vec3(Coord(0, -16, 16) - from), upper = lower + Vec3(16);
  for (const double beyond : {-40.0, -1.0, -1e-6, 0.0, 1e-3}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool atUpper : {false, true}) {
        Vec3 point = (lower + upper) * 0.5;
        point[axis] = atUpper ? upper[axis] - beyond : lower[axis] + beyond;
        const Vec3 kept = kChunks.keepInside(point, from, cell);
        EXPECT_GT(kept[axis], lower[axis]);
        EXPECT_LT(kept[axis], upper[axis]);
        const double off = atUpper ? upper[axis] - kept[axis] : kept[axis] - lower[axis];
        EXPECT_LE(off, ChunkCells::kOffFace) << "no farther than it must";
        for (int other = 0; other < 3; ++other) {
          EXPECT_TRUE(other == axis || kept[other] == point[other]);
        }
      }
    }
  }
}

TEST(ChunkCells, LeavePointsInsideWhereTheyAre) {
  const Vec3 point(0.02, 15.98, 7);
  EXPECT_EQ(kChunks.keepInside(point, Coord(0), Coord(3)), point);
}

TEST(ChunkCells, KeepDifferentPointsApartAndInOrder) {
  double before = -1;
  for (double x = -30; x < 1; x += 0.01) {
    const double kept = kChunks.keepInside(Vec3(x, 8, 8), Coord(0), Coord(3))[0];
    EXPECT_GT(kept, before) << x;
    before = kept;
  }
}

FaceSegment segment(std::size_t number, double ax, double ay, double bx, double by) {
  return {number, 0, 1, {ax, ay}, {bx, by}};
}

TEST(FaceSegments, MeetWhereTheyCrossOrTouch) {
  const FaceSegment along = segment(0, 0, 0, 4, 0);
  EXPECT_TRUE(intersectElsewhere(along, segment(1, 2, -1, 2, 1)));
  EXPECT_TRUE(intersectElsewhere(along, segment(1, 2, 0, 3, 1))) << "an end on the other";
  EXPECT_FALSE(intersectElsewhere(along, segment(1, 5, -1, 5, 1))) << "beyond the end";
  EXPECT_FALSE(intersectElsewhere(along, segment(1, 1, 1, 3, 1))) << "parallel";
}

TEST(FaceSegments, DoNotMeetInACommonEnd) {
  const FaceSegment along = segment(0, 0, 0, 4, 0);
  for (const FaceSegment& other :
       {segment(1, 4, 0, 5, 3), segment(1, 5, 3, 4, 0), segment(1, 0, 0, -1, 2)}) {
    EXPECT_FALSE(intersectElsewhere(along, other));
    EXPECT_FALSE(intersectElsewhere(other, along));
  }
}

TEST(FaceSegments, AreFoundInAllPairsThatMeet) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0, 10), length(-2, 2);
  std::vector<FaceSegment> segments;
  for (std::size_t i = 0; i < 150; ++i) {
    const double x = place(random), y = place(random);
    segments.push_back(segment(i, x, y, x + length(random), y + length(random)));
  }
  std::set<std::pair<std::size_t, std::size_t>> expected, found;
  for (const FaceSegment& s : segments) {
    for (const FaceSegment& t : segments) {
      if (s.line < t.line && intersectElsewhere(s, t)) expected.emplace(s.line, t.line);
    }
  }
  forCrossings(segments, [&](std::size_t i, std::size_t j) {
    const auto [low, high] = std::minmax(segments[i].line, segments[j].line);
    EXPECT_TRUE(found.emplace(low, high).second) << "twice";
  });
  EXPECT_GT(expected.size(), 100U);
  EXPECT_EQ(found, expected);
}

// Three arcs with base vertices 10, 11, 12 below the face and 20, 21, 22 above it.
struct ThreeArcs {
  Seams seams;
  SeamCurve curve;
  SeamPolylines lines = {0, 0, 2, 3, 4};

  ThreeArcs() {
    for (VertexIndex i = 0; i < 3; ++i) {
      seams.arcs.push_back({10 + i, 20 + i, 0, true});
      curve.arcs.push_back(i);
    }
    curve.begin = 3;
    curve.end = 4;
  }
  [[nodiscard]] ChunkSeam side(bool above) const {
    return sideOf(
        curve, above, seams, lines, [](VertexIndex vertex) { return vertex + 100; },
        [](SeamIndex vertex) { return vertex + 1000; });
  }
};

TEST(CurveSide, RunsAsTheCurveDoesSeenFromBelow) {
  const ChunkSeam below = ThreeArcs().side(false);
  EXPECT_EQ(below.tiles, (std::vector<VertexIndex>{110, 111, 112}));
  EXPECT_EQ(below.polyline, (std::vector<VertexIndex>{1000, 1000, 1002}));
  EXPECT_EQ(below.begin, 1003U);
  EXPECT_EQ(below.end, 1004U);
  EXPECT_FALSE(below.closed);
}

TEST(CurveSide, RunsTheOtherWaySeenFromAbove) {
  const ChunkSeam above = ThreeArcs().side(true);
  EXPECT_EQ(above.tiles, (std::vector<VertexIndex>{122, 121, 120}));
  EXPECT_EQ(above.polyline, (std::vector<VertexIndex>{1002, 1000, 1000}));
  EXPECT_EQ(above.begin, 1004U);
  EXPECT_EQ(above.end, 1003U);
}

TEST(CurveSide, OfALoopHasNoEnds) {
  ThreeArcs arcs;
  arcs.curve.begin = arcs.curve.end = kNoSeam;
  arcs.curve.closed = true;
  const ChunkSeam side = arcs.side(true);
  EXPECT_EQ(side.begin, ChunkSeam::kNone);
  EXPECT_EQ(side.end, ChunkSeam::kNone);
  EXPECT_TRUE(side.closed);
}

TEST(ForFaces, GivesTheCurvesOfEachFaceTogether) {
  std::vector<SeamCurve> curves(5);
  curves[0].chunk = curves[1].chunk = Coord(1, 0, 0);
  curves[2].chunk = Coord(2, 0, 0);
  curves[3].chunk = curves[4].chunk = Coord(2, 0, 0);
  curves[3].axis = curves[4].axis = 1;
  std::vector<std::pair<std::size_t, std::size_t>> faces;
  forFaces(curves, [&](std::size_t begin, std::size_t end) { faces.emplace_back(begin, end); });
  EXPECT_EQ(faces, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 2}, {2, 3}, {3, 5}}));
}

const grid::Affine kHalves{grid::Transform(*openvdb::math::Transform::createLinearTransform(0.5))};

// A curve along y on the face at x = 16, at a height, through the middles of cells.
void addCurve(Seams& seams, double height, const Normal& normal, int chunk = 1) {
  SeamCurve curve;
  curve.chunk = Coord(chunk, 0, 0);
  for (int y = 0; y < 10; ++y) {
    curve.arcs.push_back(static_cast<SeamIndex>(seams.arcs.size()));
    seams.arcs.emplace_back();
    const int z = static_cast<int>(std::floor(height));
    seams.vertices.push_back({Coord(16 * chunk, y, z), Vec3(0, 0.5, height - z), normal});
  }
  seams.curves.push_back(curve);
}

TEST(Clearance, IsTheWayToTheSurfaceThatFacesTheOtherWay) {
  Seams seams;
  addCurve(seams, 3.25, Normal(0, 0, 1));
  addCurve(seams, 2.0, Normal(0, 0, 1));
  addCurve(seams, 5.5, Normal(0, 0, -1));
  measureClearance(kHalves, seams);
  for (SeamIndex arc = 0; arc < 10; ++arc) {
    EXPECT_NEAR(seams.arcs[arc].clearance, 2.25 * 0.5, 1e-6) << "in world units";
    EXPECT_NEAR(seams.arcs[10 + arc].clearance, 3.5 * 0.5, 1e-6);
    EXPECT_NEAR(seams.arcs[20 + arc].clearance, 2.25 * 0.5, 1e-6);
  }
}

TEST(Clearance, IsEndlessWhereNothingIsNearOrOnAnotherFace) {
  Seams seams;
  addCurve(seams, 3.25, Normal(0, 0, 1));
  addCurve(seams, 40.5, Normal(0, 0, -1));
  addCurve(seams, 3.5, Normal(0, 0, -1), 2);
  measureClearance(kHalves, seams);
  for (SeamIndex arc = 0; arc < 20; ++arc) EXPECT_TRUE(std::isinf(seams.arcs[arc].clearance));
}

// A strip of quads along x, in voxels, bent upward from some vertex on. Vertices 2 i and 2 i + 1.
Mesh bentStrip(int bend) {
  Mesh mesh;
  for (int i = 0; i < 16; ++i) {
    const double height = std::max(0, i - bend) * 0.5;
    for (int y = 0; y < 2; ++y) mesh.positions.emplace_back(i * 0.5, y * 0.5, height);
  }
  for (VertexIndex i = 0; i < 15; ++i) {
    mesh.quads.emplace_back(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  }
  return mesh;
}

TEST(Flatness, TellsHowFarTheSurfaceLeavesThePlaneOfAnArc) {
  const Mesh mesh = bentStrip(6);
  Seams seams;
  // Between the vertices at 3 and 4, so that the bend is two steps away.
  seams.arcs.push_back({6, 8, 0, true});
  seams.vertices.push_back({Coord(3, 0, 0), Vec3(0.5, 0, 0), Normal(0, 0, 1)});
  measureFlatness(mesh, mesh, kHalves, seams);
  // Up to 1, 2, 4 and 5 steps on from 4: as far as 5, 6, 8 and 9.
  EXPECT_FLOAT_EQ(seams.arcs[0].flatness[0], 0);
  EXPECT_FLOAT_EQ(seams.arcs[0].flatness[1], 0);
  EXPECT_FLOAT_EQ(seams.arcs[0].flatness[2], 1);
  EXPECT_FLOAT_EQ(seams.arcs[0].flatness[3], 1.5);
}

TEST(Flatness, IsMeasuredBeforeTheRepair) {
  const Mesh before = bentStrip(100);
  Seams seams;
  seams.arcs.push_back({6, 8, 0, true});
  seams.vertices.push_back({Coord(3, 0, 0), Vec3(0.5, 0, 0), Normal(0, 0, 1)});
  measureFlatness(bentStrip(4), before, kHalves, seams);
  EXPECT_EQ(seams.arcs[0].flatness, (std::array<float, 4>{}));
}

}  // namespace
}  // namespace tufa::chunks
