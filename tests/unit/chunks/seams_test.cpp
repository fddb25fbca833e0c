#include "chunks/seams/seams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "chunks/seams/seam_crossings.h"
#include "grid/vdb_coord.h"
#include "grid/volume.h"
#include "support/fields.h"
#include "support/print.h"
#include "uniform/uniform_surface.h"

namespace tufa::chunks {
namespace {

constexpr int kChunk = 16;

double planeAt(const Vec3& p) { return p[2] - 7.3137 - 0.1034 * p[0] + 0.0317 * p[1]; }

// A plane that rises along x, through chunks of 16 voxels around the origin.
struct Plane {
  openvdb::FloatGrid::Ptr grid = test::sampled<openvdb::FloatGrid>(
      {openvdb::Coord(-20, -20, -4), openvdb::Coord(52, 52, 24)}, 9,
      [](const openvdb::Coord& at) { return planeAt(Vec3(grid::fromVdb(at))); });
  base::Job job{1, {}};
  uniform::UniformSurface surface = makeSurface();
  std::vector<Coord> cells;

  Plane() {
    const grid::Affine& affine = surface.affine();
    for (const Position& p : surface.mesh.positions) {
      cells.push_back(affine.origin() + floorCoord(affine.latticePoint(p, affine.origin())));
    }
  }
  uniform::UniformSurface makeSurface() {
    ContourOptions options;
    options.isovalue = 0;
    options.inside = Inside::Below;
    return uniform::makeUniformSurface(grid::openVolume(*grid, options, job), options, {}, job);
  }
  Seams find(const base::IndexBox& own) {
    return findSeams(surface.view(), surface.mesh, surface.mesh, cells, {4, own}, job);
  }
};

const base::IndexBox kFour{Coord(0), Coord(1, 1, 0)};

Vec3 placeOf(const SeamVertex& vertex) { return Vec3(vertex.cell) + vertex.offset; }

bool isOnFace(double x) { return std::fmod(x, kChunk) == 0; }

TEST(FindSeams, HasACurveForEachFaceThatTheSurfacePasses) {
  const Seams seams = Plane().find(kFour);
  // Four inside, and eight around the four chunks.
  ASSERT_EQ(seams.curves.size(), 12U);
  std::map<std::pair<int, Coord>, int> faces;
  for (const SeamCurve& curve : seams.curves) {
    ++faces[{curve.axis, curve.chunk}];
    EXPECT_GE(curve.arcs.size(), 16U);
    EXPECT_FALSE(curve.closed);
  }
  EXPECT_EQ(faces.size(), 12U);
  for (int i = 0; i <= 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      EXPECT_EQ((faces[{0, Coord(i, j, 0)}]), 1);
      EXPECT_EQ((faces[{1, Coord(j, i, 0)}]), 1);
    }
  }
}

TEST(FindSeams, PutsItsVerticesOnTheFacesAndOnTheSurface) {
  const Seams seams = Plane().find(kFour);
  for (const SeamCurve& curve : seams.curves) {
    for (const SeamIndex arc : curve.arcs) {
      const SeamVertex& vertex = seams.vertices[arc];
      EXPECT_EQ(placeOf(vertex)[curve.axis], curve.chunk[curve.axis] * kChunk);
      EXPECT_NEAR(planeAt(placeOf(vertex)), 0, 1e-3);
      EXPECT_LT((Vec3(vertex.normal) - Vec3(-0.1034, 0.0317, 1).unitOrX()).length(), 1e-3);
    }
    for (const SeamIndex end : {curve.begin, curve.end}) {
      ASSERT_NE(end, kNoSeam);
      const Vec3 place = placeOf(seams.vertices[end]);
      EXPECT_TRUE(isOnFace(place[0]) && isOnFace(place[1])) << place;
      EXPECT_NEAR(planeAt(place), 0, 1e-3);
    }
  }
}

TEST(FindSeams, TracesCurvesWithTheLowerChunkOnTheRight) {
  const Seams seams = Plane().find(kFour);
  for (const SeamCurve& curve : seams.curves) {
    std::vector<SeamIndex> nodes = {curve.begin};
    nodes.insert(nodes.end(), curve.arcs.begin(), curve.arcs.end());
    nodes.push_back(curve.end);
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      const SeamVertex &a = seams.vertices[nodes[i - 1]], &b = seams.vertices[nodes[i]];
      const Vec3 way = placeOf(b) - placeOf(a);
      EXPECT_GT(way.length(), 0);
      EXPECT_LT(way.length(), 2) << "a step from cell to cell";
      EXPECT_LT(way.cross(Vec3(b.normal))[curve.axis], 0);
    }
  }
}

TEST(FindSeams, PartsTheQuadsThatPassAFace) {
  Plane plane;
  const Seams seams = plane.find(kFour);
  ASSERT_EQ(seams.quads.size(), plane.surface.mesh.quads.size());
  int whole = 0, parted = 0;
  std::vector<VertexIndex> beside;
  for (std::size_t i = 0; i < seams.quads.size(); ++i) {
    const auto& v = plane.surface.mesh.quads[i].vertices;
    const auto chunkOf = [&](VertexIndex vertex) { return plane.cells[vertex] >> 4; };
    const bool one = std::all_of(
        v.begin(), v.end(), [&](VertexIndex vertex) { return chunkOf(vertex) == chunkOf(v[0]); });
    const bool own = std::any_of(
        v.begin(), v.end(), [&](VertexIndex vertex) { return kFour.contains(chunkOf(vertex)); });
    if (one && own) {
      EXPECT_EQ(seams.quads[i], plane.surface.mesh.quads[i]);
      ++whole;
      continue;
    }
    EXPECT_EQ(seams.quads[i].vertices[0], seams.quads[i].vertices[2]) << "nothing of it";
    if (!own) continue;
    ++parted;
    for (const VertexIndex vertex : v) {
      if (kFour.contains(chunkOf(vertex))) beside.push_back(vertex);
    }
  }
  EXPECT_GT(whole, 4 * 14 * 14);
  EXPECT_GT(parted, 6 * 32);
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  EXPECT_EQ(seams.beside, beside);
  // The mesh has the seams' vertices behind its own.
  EXPECT_EQ(seams.mesh.positions.size(),
            plane.surface.mesh.positions.size() + seams.vertices.size());
}

// What a chunk's neighbour makes of their face must be the same.
TEST(FindSeams, GivesTheSameBitsWhicheverChunkAsks) {
  Plane plane;
  const auto faceOf = [&](const base::IndexBox& own) {
    const Seams seams = plane.find(own);
    std::vector<std::tuple<Coord, Vec3, float, float, float>> vertices;
    for (const SeamCurve& curve : seams.curves) {
      if (curve.axis != 0 || curve.chunk != Coord(1, 0, 0)) continue;
      std::vector<SeamIndex> nodes = curve.arcs;
      nodes.insert(nodes.end(), {curve.begin, curve.end});
      for (const SeamIndex node : nodes) {
        const SeamVertex& v = seams.vertices[node];
        vertices.emplace_back(v.cell, v.offset, v.normal.x, v.normal.y, v.normal.z);
      }
    }
    return vertices;
  };
  const auto all = faceOf(kFour);
  EXPECT_GT(all.size(), 16U);
  EXPECT_EQ(faceOf({Coord(0), Coord(0)}), all);
  EXPECT_EQ(faceOf({Coord(1, 0, 0), Coord(1, 0, 0)}), all);
}

TEST(FindSeams, FindsALoopWhereASolidPassesAFace) {
  Plane plane;
  plane.grid = test::levelSet<openvdb::FloatGrid>(
      {openvdb::Coord(-4), openvdb::Coord(30)}, 3, [](const openvdb::Coord& at) {
        return (at - openvdb::Coord(16, 8, 8)).asVec3d().length() - 5.2;
      });
  plane.surface = plane.makeSurface();
  plane.cells.clear();
  const grid::Affine& affine = plane.surface.affine();
  for (const Position& p : plane.surface.mesh.positions) {
    plane.cells.push_back(affine.origin() + floorCoord(affine.latticePoint(p, affine.origin())));
  }
  const Seams seams = plane.find(kFour);
  ASSERT_EQ(seams.curves.size(), 1U);
  EXPECT_TRUE(seams.curves[0].closed);
  EXPECT_EQ(seams.curves[0].begin, kNoSeam);
  EXPECT_GT(seams.curves[0].arcs.size(), 24U);
  for (const SeamIndex arc : seams.curves[0].arcs) {
    const Vec3 place = placeOf(seams.vertices[arc]);
    EXPECT_EQ(place[0], 16);
    EXPECT_NEAR((place - Vec3(16, 8, 8)).length(), 5.2, 0.1);
  }
}

TEST(WorldPositions, AreTheTransformsOfTheVertices) {
  Seams seams;
  seams.vertices.push_back({Coord(16, -3, 5), Vec3(0, 0.3, 0.7), Normal(0, 0, 1)});
  const auto transform = openvdb::math::Transform::createLinearTransform(0.1);
  transform->postTranslate(openvdb::Vec3d(1, 2, 3));
  const grid::Transform world(*transform);
  const Position p = worldPositions(seams, world, false)[0];
  EXPECT_LT((Vec3(p) - Vec3(2.6, 1.73, 3.57)).length(), 1e-12);
  const Position single = worldPositions(seams, world, true)[0];
  EXPECT_EQ(single.y, static_cast<double>(static_cast<float>(p.y)));
}

TEST(SeamCrossings, LieWhereTheSurfaceCrossesTheEdgesOfTheirQuads) {
  Plane plane;
  const Mesh& mesh = plane.surface.mesh;
  std::vector<std::uint32_t> quads;
  for (std::uint32_t i = 0; i < mesh.quads.size(); i += 3) quads.push_back(i);
  const auto crossings = seamCrossings(plane.surface.view(), quads, plane.job);
  ASSERT_EQ(crossings.size(), quads.size());
  int inner = 0;
  for (std::size_t i = 0; i < quads.size(); ++i) {
    const SeamCrossing& crossing = crossings[i];
    Vec3 place(crossing.start);
    place[crossing.axis] += crossing.along;
    // The four cells around the edge are the quad's.
    for (const VertexIndex vertex : mesh.quads[quads[i]].vertices) {
      const Coord step = crossing.start - plane.cells[vertex];
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(step[axis] == 0 || (step[axis] == 1 && axis != crossing.axis)) << step;
      }
    }
    const base::IndexBox inside{Coord(-18, -18, -2), Coord(50, 50, 22)};
    if (!inside.contains(crossing.start)) continue;
    ++inner;
    EXPECT_NEAR(planeAt(place), 0, 1.1e-3) << "off by the margin of ends: " << place;
    const auto& n = crossing.normal;
    EXPECT_LT((Vec3(n[0], n[1], n[2]) - Vec3(-0.1034, 0.0317, 1).unitOrX()).length(), 1e-3);
  }
  EXPECT_GT(inner, 1000);
}

}  // namespace
}  // namespace tufa::chunks
