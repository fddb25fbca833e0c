// Normals of an LOD split at creases, and its vertices moved to a lattice.

#include "chunks/chain/shaded_level.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cmath>

#include "chunks/chain/lattice.h"

namespace tufa::chunks {
namespace {

const grid::Transform kUnit(*openvdb::math::Transform::createLinearTransform(1.0));

// A roof over the plane x = 1 between two chunks: its ridge runs along x, from chunk to chunk.
// Vertices 0 to 2 at x = 0, 3 to 5 in the plane, 6 to 8 at x = 2; the middle one of three on the
// ridge.
struct Roof {
  ChainLevel level;
  base::Job job{1, {}};

  Roof() {
    const VertexIndex none = ChainLevel::kNone;
    for (const double x : {0.0, 1.0, 2.0}) {
      for (const double y : {-1.0, 0.0, 1.0}) {
        level.positions.emplace_back(x, y, 1 - std::abs(y));
        level.normals.emplace_back(eave(y));
      }
    }
    for (const VertexIndex v : {0U, 1U, 3U, 4U}) {
      level.triangles.emplace_back(v, v + 3, v + 1);
      level.triangles.emplace_back(v + 1, v + 3, v + 4);
    }
    level.cutVertex = {none, none, none, 3, 4, 5, none, none, none};
    level.curveVertex = level.cutVertex;
    level.chunkOf = {0, 0, 0, 0, 1, 1, 1, 1};
    level.own = 9;
    level.isEnd.assign(9, 0);
    level.into = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  }

  // Within ten degrees of the faces at the eaves, and straight up on the ridge.
  static Normal eave(double y) { return Normal(Vec3(0, 0.6 * y, y == 0 ? 1 : 0.8)); }

  [[nodiscard]] ShadedLevel shaded(double creaseAngle) {
    const CurveNormals curves({level}, creaseAngle, job);
    return shade(level, curves, creaseAngle, {}, job);
  }

  /// So flat that the ridge is no crease, with slopes of 17 degrees, and a normal to the left.
  void flatten() {
    for (Position& p : level.positions) p.z = 1 - 0.3 * std::abs(p.y);
    level.normals[4] = Normal(Vec3(0, -0.1, 0.995));
  }
};

const Normal& normalAt(const ShadedLevel& shaded, const Triangle& triangle, std::size_t corner) {
  return shaded.normals[triangle.vertices[corner]];
}

TEST(ShadedLevel, HasANormalForEachSideOfACrease) {
  Roof roof;
  const ShadedLevel shaded = roof.shaded(40);
  const float half = std::sqrt(0.5F);
  for (std::size_t t = 0; t < 8; ++t) {
    const bool isLeft = t % 4 < 2;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = shaded.triangles[t].vertices[i];
      EXPECT_EQ(shaded.sources[v], roof.level.triangles[t].vertices[i]);
      const bool isOnRidge = shaded.sources[v] % 3 == 1;
      const Normal expected =
          isOnRidge ? Normal(0, isLeft ? -half : half, half) : Roof::eave(isLeft ? -1 : 1);
      EXPECT_NEAR(shaded.normals[v].y, expected.y, 1e-6F) << t;
      EXPECT_NEAR(shaded.normals[v].z, expected.z, 1e-6F) << t;
    }
  }
  EXPECT_EQ(shaded.triangles, shaded.changed);
}

TEST(ShadedLevel, KeepsOneNormalWhereNoneAreSplit) {
  Roof roof;
  const ShadedLevel shaded = roof.shaded(180);
  for (const Triangle& t : shaded.triangles) {
    for (const VertexIndex v : t.vertices) {
      EXPECT_EQ(shaded.normals[v], roof.level.normals[shaded.sources[v]]);
    }
  }
}

// The next LOD has no ridge in the plane: both sides there run to the left eave.
TEST(ShadedLevel, TakesTheNormalsOfAChangedCornerByTheNewTriangle) {
  Roof roof;
  roof.level.into[4] = 3;
  const ShadedLevel shaded = roof.shaded(40);
  for (std::size_t t = 0; t < 8; ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex source = roof.level.triangles[t].vertices[i];
      EXPECT_EQ(shaded.sources[shaded.changed[t].vertices[i]], roof.level.into[source]);
      if (source % 3 == 1 && source != 4) {
        EXPECT_EQ(shaded.changed[t].vertices[i], shaded.triangles[t].vertices[i]);
      }
    }
  }
}

// Each face alone is nearer to one of the two normals that the ridge has of the LOD before.
TEST(ShadedLevel, HasOneNormalForAllFacesOfASmoothGroup) {
  Roof first, flat;
  flat.flatten();
  const CurveNormals curves({first.level, flat.level}, 40, first.job);
  ASSERT_EQ(curves.countAt(4), 2U);
  const ShadedLevel shaded = shade(flat.level, curves, 40, {}, flat.job);
  for (std::size_t t = 0; t < 8; ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (flat.level.triangles[t].vertices[i] != 4) continue;
      EXPECT_EQ(normalAt(shaded, shaded.triangles[t], i), curves.at(4, 0)) << t;
    }
  }
}

// The eave in the plane is another vertex at the next LOD, which has one normal on its ridge.
TEST(ShadedLevel, TakesTheNormalsOfTheNextLevelWhereBothMeetSmoothly) {
  Roof fine, next;
  next.flatten();
  next.level.positions[5] = {1, 0.9, 0.73};
  next.level.curveVertex[5] = 6;
  fine.level.positions.push_back(next.level.positions[5]);
  fine.level.normals.push_back(next.level.normals[5]);
  fine.level.cutVertex.push_back(5);
  fine.level.curveVertex.push_back(6);
  fine.level.into.push_back(9);
  fine.level.into[5] = 9;
  const CurveNormals curves({fine.level, next.level}, 40, fine.job);
  const ShadedLevel beyond = shade(next.level, curves, 40, {}, fine.job);
  const ShadedLevel shaded = shade(fine.level, curves, 40, beyond.sides, fine.job);
  // On its two sides: 2, 4 and 9, which was 5; and 4, 7 and 5.
  const Triangle &here = shaded.changed[3], &there = beyond.triangles[6];
  EXPECT_EQ(normalAt(shaded, here, 1), normalAt(beyond, there, 0));
  EXPECT_EQ(normalAt(shaded, here, 2), normalAt(beyond, there, 2));
  EXPECT_EQ(normalAt(shaded, shaded.triangles[3], 1), curves.at(4, 1));
  EXPECT_EQ(normalAt(shaded, here, 1), curves.at(4, 0));
  EXPECT_EQ(shaded.changed[2], shaded.triangles[2]);  // 1, 4 and 2 are drawn beside both
}

TEST(Lattice, HasStepsThatSixteenBitsCountThroughAChunk) {
  EXPECT_EQ(latticeStep(kUnit, 32, 1), 1.0 / 1024);
  EXPECT_EQ(latticeStep(kUnit, 64, 1), 1.0 / 512);
  int exponent = 0;
  EXPECT_EQ(std::frexp(latticeStep(kUnit, 64, 0.01) * 0.01, &exponent), 0.5);
  openvdb::math::Mat4d shear = openvdb::math::Mat4d::identity();
  shear[1][0] = 3;
  const grid::Transform sheared(*openvdb::math::Transform::createLinearTransform(shear));
  EXPECT_EQ(latticeStep(sheared, 64, 1), 1.0 / 128);
}

TEST(Lattice, TakesAllLevelsOrNone) {
  base::Job job(1, {});
  Roof fine;
  for (Position& p : fine.level.positions) p.y += 0.1;
  std::vector<ChainLevel> levels{fine.level, fine.level};
  ASSERT_TRUE(moveToLattice(levels, 0.25, job));
  EXPECT_EQ(levels[0].positions[4], Position(1, 0, 1));
  EXPECT_EQ(levels[1].positions, levels[0].positions);

  levels = {fine.level, fine.level};
  levels[1].positions[4] = {1, -0.95, 0.1};  // falls onto vertex 3
  EXPECT_FALSE(moveToLattice(levels, 0.25, job));
  EXPECT_EQ(levels[0].positions, fine.level.positions);

  levels = {fine.level};
  levels[0].positions[1] = {0.1, -0.95, 0.05};
  levels[0].positions[0] = {0.6, -0.95, 0.05};  // three on a line, but for rounding
  EXPECT_FALSE(moveToLattice(levels, 0.25, job));
}

}  // namespace
}  // namespace tufa::chunks
