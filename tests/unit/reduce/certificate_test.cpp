#include "reduce/certificate.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

// For each reference vertex the corner of the nearest triangle that is nearest to it.
std::vector<Index> nearestVertices(const test::FineMesh& mesh, const test::FineMesh& reference) {
  std::vector<Index> nearest;
  for (const Vec3f p : reference.positions) {
    float best = std::numeric_limits<float>::max();
    Index triangle = 0;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t].vertices;
      const float d2 = squaredDistanceToTriangle(p, mesh.positions[v[0]], mesh.positions[v[1]],
                                                 mesh.positions[v[2]]);
      if (d2 < best) best = d2, triangle = t;
    }
    Index vertex = mesh.triangles[triangle].vertices[0];
    for (const Index v : mesh.triangles[triangle].vertices) {
      if (squaredLength(mesh.positions[v] - p) < squaredLength(mesh.positions[vertex] - p)) {
        vertex = v;
      }
    }
    nearest.push_back(vertex);
  }
  return nearest;
}

Certificate certified(const test::FineMesh& mesh, const test::FineMesh& reference, float expected) {
  base::Job job(1, {});
  const ReferenceMesh to(surfaceOf(reference, job), {}, job);
  Surface surface = surfaceOf(mesh, job);
  locateAll(surface, to, nearestVertices(mesh, reference), job);
  return certify(surface, to, expected, job);
}

double sampledBothWays(const test::FineMesh& mesh, const test::FineMesh& reference) {
  const Mesh a = test::toMesh(mesh.positions, mesh.triangles);
  const Mesh b = test::toMesh(reference.positions, reference.triangles);
  return std::max(test::sampledDistance(a, b, 2000), test::sampledDistance(b, a, 2000));
}

TEST(Certificate, OfTheReferenceItselfIsZero) {
  const test::FineMesh mesh = test::bumpySphere(3, 6, 1, 1);
  const Certificate c = certified(mesh, mesh, 0.1f);
  EXPECT_LT(c.largest, 1e-5f);
  EXPECT_LT(c.mean, 1e-5f);
}

TEST(Certificate, IsTheHeightOfABump) {
  const test::FineMesh coarse = test::subdivided(test::box(8, 8, 8), 1);
  test::FineMesh fine = test::subdivided(test::box(8, 8, 8), 3);
  std::size_t bump = 0;
  for (std::size_t v = 0; v < fine.positions.size(); ++v) {
    if (fine.positions[v] == Vec3f(3, 5, 8)) bump = v;
  }
  fine.positions[bump].z += 0.3f;
  for (const float expected : {0.01f, 0.1f, 0.31f, 1.0f}) {
    const Certificate c = certified(coarse, fine, expected);
    EXPECT_GE(c.largest, 0.2999f) << expected;
    EXPECT_LE(c.largest, std::max(0.3007f, expected)) << expected;
    EXPECT_NEAR(c.mean, 0.3f / static_cast<float>(fine.positions.size()), 1e-5f);
  }
}

// Two meshes of the same vertices: at every one of them the distance is 0, yet their edges pass
// each other at a distance.
TEST(Certificate, SeesWhereEdgesCross) {
  const test::FineMesh ridge{{{-10, 0, 0}, {10, 0, 0}, {0, -6, -1}, {0, 6, -1}, {0, 0, -20}},
                             {{2, 1, 0}, {3, 0, 1}, {0, 4, 2}, {2, 4, 1}, {1, 4, 3}, {3, 4, 0}}};
  test::FineMesh valley = ridge;
  valley.triangles[0] = {2, 3, 0};
  valley.triangles[1] = {3, 2, 1};
  const Certificate c = certified(valley, ridge, 0.1f);
  EXPECT_GE(c.largest, 0.98f);  // the ridge's middle from the two slopes; the edges: 1
  EXPECT_LE(c.largest, 1.01f);
  EXPECT_LT(c.mean, 1e-6f);
}

// A vertex 0.028 from a sliver, of which single precision finds a point 0.13 away. As met with on
// the edge of a plate.
TEST(Certificate, IsNotTooLargeAtASliver) {
  const Vec3f a(-93.0248f, 188.3711f, 90.7239f), b(-93.9874f, -40.7796f, 91.0132f),
      c(-93.0284f, -110.1024f, 90.72f), p(-93.1259f, 39.5f, 90.7234f), below(-93.5f, 0, 60);
  ASSERT_GT(std::sqrt(squaredDistanceToTriangle(p, a, b, c)), 0.12f);
  const test::FineMesh mesh{{a, b, c, below}, {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
  const test::FineMesh reference{
      {a, b, c, below, p}, {{0, 1, 4}, {1, 2, 4}, {2, 0, 4}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
  base::Job job(1, {});
  const ReferenceMesh to(surfaceOf(reference, job), {}, job);
  Surface surface = surfaceOf(mesh, job);
  locateAll(surface, to, nearestVertices(mesh, reference), job);
  surface.owner[4] = 0;
  const Certificate found = certify(surface, to, 0.08f, job);
  EXPECT_NEAR(found.largest, 0.0275f, 1e-3f);
  EXPECT_TRUE(found.beyond.empty());
}

// What the mesh has in addition is no nearer for the reference's being near the mesh.
TEST(Certificate, BoundsTheWayBackToo) {
  const test::FineMesh fine = test::subdivided(test::box(8, 8, 8), 2);
  test::FineMesh spiked = fine;
  for (std::size_t v = 0; v < fine.positions.size(); ++v) {
    if (fine.positions[v] == Vec3f(4, 2, 8)) spiked.positions[v].z += 1.5f;
  }
  for (const float expected : {0.01f, 0.4f, 2.0f}) {
    const Certificate c = certified(spiked, fine, expected);
    EXPECT_GE(c.largest, 1.5f * 0.99f) << expected;
    EXPECT_LE(c.largest, std::max(1.6f, expected)) << expected;
  }
}

// Both sides of a thin plate are near one side of the mesh; nothing goes to the other one, wherever
// it is.
TEST(Certificate, BoundsTheWayBackFromASideThatIsLeftOut) {
  const test::FineMesh plate = test::subdivided(test::box(8, 8, 0.04f), 3);
  test::FineMesh thick = plate;
  for (Vec3f& p : thick.positions) {
    if (p.z == 0) p.z = -0.3f;
  }
  for (const float expected : {0.1f, 0.5f}) {
    const Certificate c = certified(thick, plate, expected);
    EXPECT_GE(c.largest, 0.3f * 0.999f) << expected;
    EXPECT_LE(c.largest, std::max(0.31f, expected)) << expected;
    EXPECT_LE(c.mean, 0.04f);
  }
}

// A face with rings in it and a spike in their middle: none of the face's pieces is within a
// distance of all rings, so that nothing goes there.
TEST(Certificate, BoundsTheWayBackFromWhatAHalvedFaceEncloses) {
  const test::FineMesh plain = test::subdivided(test::box(8, 8, 8), 2);
  for (const float height : {0.0f, 1.0f, 5.0f}) {
    test::FineMesh spiked = plain;
    constexpr Index kFace = 20;
    std::array<Index, 3> outer = spiked.triangles[kFace].vertices;
    const std::array<Vec3f, 3> corners = {spiked.positions[outer[0]], spiked.positions[outer[1]],
                                          spiked.positions[outer[2]]};
    const Vec3f middle = (corners[0] + corners[1] + corners[2]) * (1.0f / 3);
    std::vector<Triangle> within;
    for (const float share : {0.6f, 0.3f, 0.05f}) {
      const auto first = static_cast<Index>(spiked.positions.size());
      const std::array<Index, 3> inner = {first, first + 1, first + 2};
      for (const Vec3f& p : corners) spiked.positions.push_back(middle + (p - middle) * share);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        within.emplace_back(outer[i], outer[j], inner[j]);
        within.emplace_back(outer[i], inner[j], inner[i]);
      }
      outer = inner;
    }
    const auto tip = static_cast<Index>(spiked.positions.size());
    const Vec3f normal = base::unit(cross(corners[1] - corners[0], corners[2] - corners[0]));
    spiked.positions.push_back(middle + normal * height);
    for (std::size_t i = 0; i < 3; ++i) within.emplace_back(outer[i], outer[(i + 1) % 3], tip);
    spiked.triangles[kFace] = within.back();
    within.pop_back();
    for (const Triangle& t : within) spiked.triangles.push_back(t);
    for (const float expected : {0.1f, 0.3f}) {
      base::Job job(1, {});
      const ReferenceMesh to(surfaceOf(plain, job), {}, job);
      Surface surface = surfaceOf(spiked, job);
      std::vector<Index> same(plain.positions.size());
      std::iota(same.begin(), same.end(), 0);
      locateAll(surface, to, same, job);
      const Certificate c = certify(surface, to, expected, job);
      EXPECT_GE(c.largest, 0.999f * height) << expected;
      EXPECT_LE(c.largest, std::max(1.01f * height, 0.5f)) << expected;
    }
  }
}

// The ways along a face's edges make a loop around vertices of the mesh that are inside it.
TEST(Certificate, PullsLoopsOverVerticesInsideAFace) {
  const test::FineMesh reference = test::subdivided(test::box(8, 8, 8), 1);
  test::FineMesh fine = test::subdivided(reference, 1);
  const Certificate same = certified(fine, reference, 0.1f);
  EXPECT_EQ(same.halved, 0U);
  EXPECT_LT(same.largest, 1e-5f);
  for (std::size_t v = reference.positions.size(); v < fine.positions.size(); ++v) {
    Vec3f& p = fine.positions[v];
    p.z += 0.2f * std::sin(p.x * 5 + p.y * 3);
  }
  const double sampled = sampledBothWays(fine, reference);
  const Certificate bumpy = certified(fine, reference, 0.3f);
  EXPECT_EQ(bumpy.halved, 0U);
  EXPECT_GE(bumpy.largest, sampled * 0.9999);
  EXPECT_LE(bumpy.largest, 0.3f);
}

// A prism over a long triangle, the far side of which has so many points: fans of needles.
test::FineMesh prismOfFans(Index points) {
  test::FineMesh mesh;
  for (const float z : {1.0f, -1.0f}) {
    mesh.positions.emplace_back(0.0f, 0.0f, z);
    for (Index i = 0; i < points; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(points - 1);
      mesh.positions.emplace_back(40.0f, 3 * share - 1.5f, z);
    }
  }
  const Index below = points + 1;
  for (Index i = 1; i < points; ++i) {
    mesh.triangles.emplace_back(0, i, i + 1);
    mesh.triangles.emplace_back(below, below + i + 1, below + i);
  }
  for (Index i = 0; i <= points; ++i) {
    const Index next = i == points ? 0 : i + 1;
    mesh.triangles.emplace_back(i, below + i, below + next);
    mesh.triangles.emplace_back(i, below + next, next);
  }
  return mesh;
}

// A face there lies over dozens of needles, all of which its edges pass.
TEST(Certificate, FollowsFacesOverFansOfNeedles) {
  const test::FineMesh reference = test::subdivided(prismOfFans(2), 1);
  for (const Index points : {9U, 17U, 33U}) {
    const Certificate c = certified(prismOfFans(points), reference, 0.01f);
    EXPECT_EQ(c.halved, 0U) << points;
    EXPECT_LT(c.largest, 1e-4f) << points;
  }
}

TEST(Certificate, IsNoLessThanTheSampledDistanceOfAnyTwoMeshes) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const float radius = 6;
    const test::FineMesh fine = test::bumpySphere(3, radius, 1.5f, seed);
    const test::FineMesh coarse = test::bumpySphere(2, radius, 1.2f, seed);
    const double sampled = sampledBothWays(coarse, fine);
    for (const float expected : {0.3f, 1.0f}) {
      const Certificate c = certified(coarse, fine, expected);
      EXPECT_GE(c.largest, sampled * 0.9999) << seed;
      EXPECT_LE(c.largest, sampled * 1.5 + 0.1) << seed;
    }
  }
}

}  // namespace
}  // namespace tufa::reduce
