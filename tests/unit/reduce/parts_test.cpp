#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "reduce/box_list.h"
#include "reduce/clearance.h"
#include "reduce/local_quadric.h"
#include "reduce/partition.h"
#include "reduce/reference_mesh.h"
#include "reduce/triangles.h"
#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

Vec3f randomPoint(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> uniform(-size, size);
  return {uniform(random), uniform(random), uniform(random)};
}

TEST(Triangles, DistanceToATriangleIsThatOfItsNearestPoint) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const Vec3f p = randomPoint(random, 2), a = randomPoint(random, 1), b = randomPoint(random, 1),
                c = randomPoint(random, 1);
    float best = std::numeric_limits<float>::max();
    constexpr int kSteps = 60;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        const float s = static_cast<float>(u) / kSteps, t = static_cast<float>(v) / kSteps;
        best = std::min(best, length(p - (a + (b - a) * s + (c - a) * t)));
      }
    }
    const float d = std::sqrt(squaredDistanceToTriangle(p, a, b, c));
    EXPECT_LE(d, best + 1e-5f);
    EXPECT_GE(d, best - 0.04f);
  }
}

TEST(Triangles, DistanceOfSegmentsIsThatOfTheirNearestPoints) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec3f a = randomPoint(random, 1), b = randomPoint(random, 1), c = randomPoint(random, 1),
                d = randomPoint(random, 1);
    float best = std::numeric_limits<float>::max();
    constexpr int kSteps = 80;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; v <= kSteps; ++v) {
        const float s = static_cast<float>(u) / kSteps, t = static_cast<float>(v) / kSteps;
        best = std::min(best, length(a + (b - a) * s - (c + (d - c) * t)));
      }
    }
    const float found = std::sqrt(squaredDistanceOfSegments(a, b, c, d));
    EXPECT_LE(found, best + 1e-5f);
    EXPECT_GE(found, best - 0.05f);
  }
}

TEST(Triangles, PlanesPartThemWhereTheyAreApart) {
  const Vec3f floor[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Vec3f above[3] = {{0, 0, 0.05f}, {4, 0, 0.05f}, {0, 4, 0.05f}};
  const Vec3f through[3] = {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}};
  const Vec3f beside[3] = {{3, 3, 0}, {5, 3, 0}, {3, 5, 0}};
  const Vec3f over[3] = {{1, 1, 0}, {5, 1, 0}, {1, 5, 0}};
  EXPECT_TRUE(planeParts(floor, above, 1e-3f));
  EXPECT_FALSE(planeParts(floor, above, 0.06f));
  EXPECT_FALSE(planeParts(floor, through, 1e-3f));
  EXPECT_TRUE(planeParts(floor, beside, 1e-3f));
  EXPECT_FALSE(planeParts(floor, over, 1e-3f));
}

TEST(LocalQuadric, IsTheSumOfSquaredDistancesWhereverItIsSeenFrom) {
  LocalQuadric quadric;
  const Vec3f normals[3] = {unit(Vec3f(1, 2, 3)), unit(Vec3f(-2, 1, 0.5f)),
                            unit(Vec3f(0.3f, -1, 2))};
  const Vec3f places[3] = {{1, 0, 0}, {0, 2, 1}, {-1, 1, 3}};
  Vec3f from{};
  for (int i = 0; i < 3; ++i) {  // each seen from its own place first
    quadric.moveBy(places[i] - from);
    from = places[i];
    quadric.addPlane(normals[i], static_cast<float>(i + 1));
  }
  const auto exact = [&](Vec3f p) {
    float sum = 0;
    for (int i = 0; i < 3; ++i) {
      const float d = dot(normals[i], p - places[i]);
      sum += static_cast<float>(i + 1) * d * d;
    }
    return sum;
  };
  EXPECT_NEAR(quadric.at({}), exact(from), 1e-4f);
  EXPECT_NEAR(quadric.at({2, -1, 1}), exact(from + Vec3f(2, -1, 1)), 1e-3f);
  EXPECT_NEAR(quadric.weight, 6, 1e-6f);
  const Vec3f least = quadric.minimum();
  EXPECT_LT(quadric.at(least), 1e-2f * quadric.at({}));
}

TEST(LocalQuadric, StaysWhereItsPlanesLeaveItFree) {
  LocalQuadric quadric;
  quadric.addPlane({0, 0, 1}, 1);
  quadric.moveBy({5, 6, 0.5f});
  const Vec3f least = quadric.minimum();
  EXPECT_NEAR(least.x, 0, 1e-6f);
  EXPECT_NEAR(least.y, 0, 1e-6f);
  EXPECT_NEAR(least.z, -0.5f, 1e-3f);
}

TEST(BoxList, FindsWhatATestOfAllBoxesFinds) {
  std::mt19937 random(4);
  const auto randomBox = [&] {
    Box3f box;
    box.add(randomPoint(random, 20));
    box.add(box.lower + randomPoint(random, 1));
    return box;
  };
  constexpr Index kCount = 700;
  std::vector<Box3f> boxes(kCount);
  std::vector<std::pair<Box3f, Index>> items;
  for (Index i = 0; i < kCount; ++i) {
    boxes[i] = randomBox();
    if (i % 7 != 0) items.emplace_back(boxes[i], i);
  }
  BoxList list;
  BoxList::Slots slots(kCount, kNone);
  list.build(items, slots);
  for (Index i = 0; i < kCount; i += 7) list.put(i, boxes[i], slots);
  for (Index i = 0; i < kCount; i += 5) list.put(i, boxes[i] = randomBox(), slots);
  for (Index i = 0; i < kCount; i += 11) list.remove(i, slots);
  for (int k = 0; k < 200; ++k) {
    Box3f query = randomBox();
    query.growBy(2);
    std::vector<Index> found, all;
    list.any(query, [&](Index i, const Box3f&) {
      found.push_back(i);
      return false;
    });
    for (Index i = 0; i < kCount; ++i) {
      if (i % 11 != 0 && boxes[i].meets(query)) all.push_back(i);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, all);
  }
}

class ReferenceMeshTest : public testing::Test {
 protected:
  base::Job job{1, {}};
  test::FineMesh mesh = test::subdivided(test::box(8, 8, 8), 4);
  ReferenceMesh reference{surfaceOf(mesh, job), {}, job};

  // A face at the vertex nearest to p.
  Index faceAt(Vec3f p) const {
    Index best = 0;
    for (Index v = 0; v < mesh.positions.size(); ++v) {
      if (length(mesh.positions[v] - p) < length(mesh.positions[best] - p)) best = v;
    }
    return reference.cornerOf(best) / 3;
  }
};

TEST_F(ReferenceMeshTest, IsRoughAtEdgesAndCorners) {
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    int sides = 0;
    for (int i = 0; i < 3; ++i) sides += mesh.positions[v][i] == 0 || mesh.positions[v][i] == 8;
    EXPECT_EQ(reference.isRough(v), sides == 3);  // 55 degrees; the sides of an edge have 45
  }
}

TEST_F(ReferenceMeshTest, BendsBothWaysAtCornersOnly) {
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    int sides = 0;
    for (int i = 0; i < 3; ++i) sides += mesh.positions[v][i] == 0 || mesh.positions[v][i] == 8;
    EXPECT_EQ(reference.isBent(v), sides == 3);
  }
  // Its upper side on a cylinder, and on a ball.
  constexpr float kRadius = 20;
  test::FineMesh cylinder = mesh, ball = mesh;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    const float a = (p.x - 4) / kRadius, b = (p.y - 4) / kRadius, r = kRadius + p.z;
    cylinder.positions[v] = {r * std::sin(a), p.y, r * std::cos(a)};
    ball.positions[v] =
        Vec3f{std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b)} * r;
  }
  const ReferenceMesh bent(surfaceOf(cylinder, job), {}, job), round(surfaceOf(ball, job), {}, job);
  int count = 0;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    if (p.z != 8 || p.x == 0 || p.x == 8 || p.y == 0 || p.y == 8) continue;
    ++count;
    EXPECT_FALSE(bent.isBent(v)) << v;
    EXPECT_TRUE(round.isBent(v)) << v;
  }
  EXPECT_EQ(count, 15 * 15);
}

TEST_F(ReferenceMeshTest, HoldsAShareFirstAndAllTheSecondTime) {
  const Vec3f middle(4, 4, 8);
  const Index face = faceAt(middle);
  const auto farthest = [&](float most) {
    float far = 0;
    for (Index v = 0; v < mesh.positions.size(); ++v) {
      if (reference.scaleAt(v) <= most) far = std::max(far, length(mesh.positions[v] - middle));
    }
    return far;
  };
  EXPECT_FALSE(reference.isScaled());
  reference.hold({&face, 1}, 2, 0.25f, job);
  EXPECT_TRUE(reference.isScaled());
  EXPECT_FALSE(reference.hasScales());
  EXPECT_TRUE(reference.isHeld(face));
  EXPECT_EQ(reference.scaleAt(reference.vertices(face)[0]), 0.25f);
  EXPECT_NEAR(farthest(0.25f), 2.5f, 1);
  EXPECT_EQ(farthest(0), 0);
  reference.hold({&face, 1}, 1, 0.25f, job);
  EXPECT_EQ(reference.scaleAt(reference.vertices(face)[0]), 0);
  EXPECT_LT(farthest(0), farthest(0.25f));
  EXPECT_EQ(reference.promisedScaleAt(reference.vertices(face)[0]), 1);
  reference.releaseAll();
  EXPECT_FALSE(reference.isScaled());
  EXPECT_FALSE(reference.isHeld(face));
  reference.hold({&face, 1}, 1, 0, job);
  EXPECT_GT(farthest(0), 0);
}

TEST_F(ReferenceMeshTest, LocatesTheFaceBelow) {
  const Vec3f p(6.3f, 2.2f, 9);
  const Index f = reference.locate(faceAt({1, 7, 8}), p, {0, 0, 1});
  ASSERT_NE(f, kNone);
  EXPECT_NEAR(reference.distance(f, p), 1, 1e-5f);
  EXPECT_EQ(reference.locate(faceAt({1, 7, 8}), p, {0, 0, 1}, 2), kNone);  // too far to walk
}

TEST_F(ReferenceMeshTest, FollowsASectionDownAWall) {
  // From the top over the edge at x = 8 and down: steep, as seen along the diagonal.
  const Vec3f start(6.3f, 4.2f, 8);
  const Index first = reference.locate(faceAt(start), start, {0, 0, 1});
  ASSERT_NE(first, kNone);
  std::vector<Vec3f> crossings;
  const ReferenceMesh::Section section{start, {1.7f, 0.01f, -4}, unit(Vec3f(1, 0, 1)), true};
  EXPECT_TRUE(reference.follow(first, section, [&](Index, Vec3f m, Vec3f, Vec3f) {
    crossings.push_back(m + start);
    return true;
  }));
  ASSERT_GT(crossings.size(), 6U);
  EXPECT_NEAR(crossings.front().z, 8, 1e-4f);
  EXPECT_NEAR(crossings.back().x, 8, 1e-4f);
  EXPECT_LT(crossings.back().z, 5);
  int visits = 0;
  EXPECT_FALSE(
      reference.follow(first, section, [&](Index, Vec3f, Vec3f, Vec3f) { return ++visits < 3; }));
  EXPECT_EQ(visits, 3);
}

// A section along an edge that leaves the surface passes over the edge's end.
TEST_F(ReferenceMeshTest, TellsWhereASectionPassesItsEnd) {
  const Vec3f start(6.3f, 4.2f, 8);
  const Index first = reference.locate(faceAt(start), start, {0, 0, 1});
  ASSERT_NE(first, kNone);
  const auto anywhere = [](Index, Vec3f, Vec3f, Vec3f) { return true; };
  for (const float depth : {0.0f, 4.0f}) {
    const Vec3f along{1.2f, 0.01f, -depth};
    const auto arrival = reference.follow(first, {start, along, {0, 0, 1}}, anywhere);
    ASSERT_TRUE(arrival);
    EXPECT_NEAR(length(arrival.at - along), depth, 1e-4f);
    EXPECT_NEAR(reference.distance(arrival.face, start + along), depth, 1e-4f);
  }
}

// In single precision a point of a long sliver is found that need not be the nearest: no distance
// is too small.
TEST(Triangles, DistancesToSliversAreNeverTooSmall) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(0, 1);
  float most = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f a = randomPoint(random, 200), along = randomPoint(random, 100);
    const Vec3f b = a + along, c = a + along * (2 * share(random)) + randomPoint(random, 0.1f);
    const Vec3f p = a + along * share(random) + randomPoint(random, 0.1f);
    const double exact = std::sqrt(exactSquaredDistanceToTriangle(p, a, b, c));
    const float found = std::sqrt(squaredDistanceToTriangle(p, a, b, c));
    EXPECT_GE(static_cast<double>(found), exact - 2e-4);
    const double s = static_cast<double>(share(random)), t = (1 - s) * 0.5;
    EXPECT_LE(exact, (Vec3(p) - (Vec3(a) + Vec3(b - a) * s + Vec3(c - a) * t)).length() + 1e-9);
    most = std::max(most, found - static_cast<float>(exact));
  }
  EXPECT_GT(most, 0.05f);
  // As found on the edge of a plate.
  const Vec3f p(-93.1259f, 39.5f, 90.7234f), a(-93.0248f, 188.3711f, 90.7239f),
      b(-93.9874f, -40.7796f, 91.0132f), c(-93.0284f, -110.1024f, 90.72f);
  EXPECT_NEAR(std::sqrt(exactSquaredDistanceToTriangle(p, a, b, c)), 0.0275, 1e-3);
}

// A vertex on a part's border may not move.
TEST(Partition, CutsBetweenVertices) {
  const test::FineMesh mesh = test::subdivided(test::box(24, 16, 8), 5);  // in rows
  base::Job job(1, {});
  const Surface surface = surfaceOf(mesh, job);
  for (const float share : {1.0f / 3, 0.5f}) {
    Partition partition;
    partition.build(surface, {300}, share, job);
    ASSERT_GT(partition.size(), 10U);
    for (Index p = 0; p < partition.size(); ++p) {
      for (const Index v : partition.vertices(p)) {
        EXPECT_TRUE(partition.box(p).hasInside(surface.position[v]));
      }
    }
  }
}

// Where a few triangles own most of the reference, as on a flat face, parts have fewer vertices.
TEST(Partition, DividesWhereThereAreManySamples) {
  const test::FineMesh mesh = test::bumpySphere(5, 20, 1, 1);
  base::Job job(1, {});
  Surface surface = surfaceOf(mesh, job);
  const ReferenceMesh reference(surface, {}, job);
  locateAll(surface, reference, {}, job);
  apply(surface, reference, {}, std::vector<std::uint8_t>(mesh.triangles.size(), 0), job);
  for (Index r = 0; r < surface.owner.size(); ++r) surface.owner[r] = r % 16;
  const auto sizesOf = [&](const PartSize& size) {
    Partition partition;
    partition.build(surface, size, 0.5f, job);
    std::vector<std::size_t> sizes;  // where triangle 0 is, and the largest elsewhere
    const Index first = partition.partOf(surface.triangles[0].vertices[0]);
    sizes.push_back(partition.vertices(first).size());
    sizes.push_back(0);
    for (Index p = 0; p < partition.size(); ++p) {
      if (partition.samples(p).empty()) sizes[1] = std::max(sizes[1], partition.vertices(p).size());
    }
    return sizes;
  };
  const std::vector<std::size_t> few = sizesOf({500, 100, 60});
  EXPECT_LE(few[0], 60U);
  EXPECT_GT(few[0], 20U);
  EXPECT_GT(few[1], 250U);
  EXPECT_GT(sizesOf({500, mesh.positions.size(), 60})[0], 250U);
}

// In ranges as all at once, each corner of a vertex once.
TEST(CornerRanges, HoldTheCornersOfAllVertices) {
  test::FineMesh mesh = test::bumpySphere(7, 60, 1, 1);
  base::Job job(2, {});
  ASSERT_GT(mesh.positions.size(), std::size_t{2} << 15);
  // Not in the order of the vertices.
  for (std::size_t t = 0; t + 1 < mesh.triangles.size(); t += 5) {
    std::swap(mesh.triangles[t], mesh.triangles[mesh.triangles.size() - 1 - t]);
  }
  const CornersOfVertices all(mesh.positions.size(), mesh.triangles, job);
  std::vector<int> isSame(mesh.positions.size(), 0);
  forCornerRanges(mesh.positions.size(), mesh.triangles, job, [&](const CornersOfVertices& some) {
    EXPECT_LT(some.end() - some.begin(), mesh.positions.size());
    for (Index v = some.begin(); v < some.end(); ++v) {
      const auto a = some.of(v), b = all.of(v);
      isSame[v] += std::equal(a.begin(), a.end(), b.begin(), b.end()) ? 1 : 100;
    }
  });
  EXPECT_EQ(std::count(isSame.begin(), isSame.end(), 1), std::ssize(isSame));
  for (const Index c : all.of(3)) EXPECT_EQ(mesh.triangles[c / 3].vertices[c % 3], 3U);
}

TEST(Partition, OwnsEachVertexAndTriangleOnce) {
  const test::FineMesh mesh = test::bumpySphere(5, 20, 1, 1);
  base::Job job(1, {});
  const ReferenceMesh reference(surfaceOf(mesh, job), {}, job);
  Surface surface = surfaceOf(mesh, job);
  locateAll(surface, reference, {}, job);
  apply(surface, reference, {}, std::vector<std::uint8_t>(mesh.triangles.size(), 0), job);
  Partition partition;
  partition.build(surface, {500}, 0.5f, job);
  ASSERT_GT(partition.size(), 8U);
  std::vector<int> vertices(mesh.positions.size()), triangles(mesh.triangles.size()),
      foreign(mesh.triangles.size());
  std::size_t samples = 0;
  for (Index p = 0; p < partition.size(); ++p) {
    EXPECT_LE(partition.vertices(p).size(), 500U);
    for (const Index v : partition.vertices(p)) ++vertices[v];
    for (const Index t : partition.triangles(p)) ++triangles[t];
    for (const Index t : partition.foreign(p)) ++foreign[t];
    samples += partition.samples(p).size();
    for (const Index v : partition.vertices(p)) {
      EXPECT_TRUE(!partition.isInner(v) || partition.box(p).hasInside(mesh.positions[v]));
    }
  }
  EXPECT_EQ(std::count(vertices.begin(), vertices.end(), 1), std::ssize(vertices));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    EXPECT_TRUE(triangles[t] == 1 ? foreign[t] == 0 : foreign[t] >= 2);
  }
  EXPECT_LT(samples, mesh.positions.size());
  EXPECT_GT(samples, mesh.positions.size() / 2);
}

// A collapse in the middle of an octahedron whose faces are in four, and nothing else.
TEST(Surface, AppliesChanges) {
  const test::FineMesh mesh = test::subdivided(test::octahedron(8), 1);
  base::Job job(1, {});
  Surface surface = surfaceOf(mesh, job);
  const ReferenceMesh reference(surface, {}, job);
  locateAll(surface, reference, {}, job);
  ASSERT_TRUE(surface.isWhole);
  EXPECT_TRUE(surface.triangles.shares(reference.faces()));
  const Index gone = mesh.triangles[3].vertices[0], kept = mesh.triangles[3].vertices[1];
  std::vector<std::uint8_t> dead(mesh.triangles.size(), 0);
  SurfaceChanges changes;
  changes.moved.push_back({kept, Vec3f(1, 2, 3), 5});
  for (Index t = 0; t < dead.size(); ++t) {
    Triangle now = mesh.triangles[t];
    const bool hasKept =
        std::find(now.vertices.begin(), now.vertices.end(), kept) != now.vertices.end();
    const auto at = std::find(now.vertices.begin(), now.vertices.end(), gone);
    if (at == now.vertices.end()) continue;
    *at = kept;
    if (hasKept) {
      dead[t] = 1;
    } else {
      changes.changed.push_back({t, now});
    }
  }
  ASSERT_EQ(std::count(dead.begin(), dead.end(), 1), 2);
  apply(surface, reference, {changes}, dead, job);
  EXPECT_FALSE(surface.isWhole);
  ASSERT_EQ(surface.position.size(), mesh.positions.size() - 1);
  ASSERT_EQ(surface.triangles.size(), mesh.triangles.size() - 2);
  const auto now = [&](Index v) { return v - (v > gone ? 1 : 0); };
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    if (v == gone) continue;
    EXPECT_EQ(surface.position[now(v)], v == kept ? Vec3f(1, 2, 3) : mesh.positions[v]);
    EXPECT_EQ(surface.source[now(v)], v == kept ? kNone : v);
    EXPECT_EQ(surface.face[now(v)], v == kept ? 5 : reference.cornerOf(v) / 3);
  }
  Index n = 0;
  for (Index t = 0; t < dead.size(); ++t) {
    if (dead[t] != 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index was = mesh.triangles[t].vertices[i];
      EXPECT_EQ(surface.triangles[n].vertices[i], now(was == gone ? kept : was));
    }
    ++n;
  }
  EXPECT_EQ(reference.positions()[kept], mesh.positions[kept]);
}

std::vector<std::vector<Index>> verticesOf(const Partition& partition) {
  std::vector<std::vector<Index>> all;
  for (Index p = 0; p < partition.size(); ++p) {
    all.emplace_back(partition.vertices(p).begin(), partition.vertices(p).end());
  }
  return all;
}

// Also where an object has held a larger surface before. As large as several threads share.
TEST(Partition, IsTheSameAlongItsOwnTreeAndForAnyThreads) {
  const test::FineMesh large = test::subdivided(test::box(160, 120, 80), 7);
  const test::FineMesh small = test::bumpySphere(5, 20, 1, 1);
  ASSERT_GT(large.positions.size(), 1U << 16);
  std::vector<std::vector<std::vector<Index>>> found;
  for (const int threads : {1, 2}) {
    base::Job job(threads, {});
    job.run([&] {
      Partition partition;
      for (const test::FineMesh* mesh : {&large, &small}) {
        const Surface surface = surfaceOf(*mesh, job);
        partition.build(surface, {500}, 0.5f, job);
        found.push_back(verticesOf(partition));
        const std::vector<PartTree::Node> tree = partition.tree();
        partition.build(surface, tree, job);
        found.push_back(verticesOf(partition));
      }
    });
  }
  ASSERT_EQ(found.size(), 8U);
  for (const std::size_t i : {0U, 2U}) {
    std::size_t count = 0;
    for (const auto& vertices : found[i]) count += vertices.size();
    EXPECT_EQ(count, (i == 0 ? large : small).positions.size());
    for (const std::size_t other : {1U, 4U, 5U}) EXPECT_EQ(found[i], found[i + other]);
  }
}

// Marks of a plate of this thickness, turned so that it lies across all axes or not.
std::size_t marksOfPlate(float thickness, float reach, bool isTurned = false) {
  test::FineMesh mesh = test::subdivided(test::box(16, 16, thickness), 5);
  const std::vector<Vec3f> flat = mesh.positions;
  const Vec3f up = unit(Vec3f(1, 1.1f, 0.9f));
  const base::Frame frame = base::frameAbout(up);
  for (Vec3f& p : mesh.positions) {
    if (isTurned) p = frame.x * p.x + frame.y * p.y + up * p.z;
  }
  base::Job job(1, {});
  const ReferenceMesh reference(surfaceOf(mesh, job), {}, job);
  Surface surface = surfaceOf(mesh, job);
  locateAll(surface, reference, {}, job);
  Partition partition;
  partition.build(surface, {500}, 0.5f, job);
  surface.flags.assign(surface.flags.size(), 0);
  markNarrow(surface, partition, reach, job);
  std::size_t marks = 0;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = flat[v];
    const bool isInside = std::min({p.x, p.y, 16 - p.x, 16 - p.y}) > 6;
    marks += isInside && (surface.flags[v] & kNarrow) != 0;
  }
  return marks;
}

TEST(Clearance, MarksSurfaceThatOtherSurfaceIsNear) {
  EXPECT_GT(marksOfPlate(1, 1.2f), 50U);
  EXPECT_EQ(marksOfPlate(1, 0.8f), 0U);
  EXPECT_GT(marksOfPlate(0.05f, 0.4f), 50U);
  EXPECT_EQ(marksOfPlate(6, 0.4f), 0U);
}

// Boxes around its triangles meet, a plane parts its sides.
TEST(Clearance, MarksNothingBetweenSidesThatAPlaneParts) {
  EXPECT_EQ(marksOfPlate(1, 0.8f, true), 0U);
  EXPECT_GT(marksOfPlate(1, 1.2f, true), 50U);
  EXPECT_GT(marksOfPlate(0.05f, 0.4f, true), 50U);
}

// Nothing is listed for each pair of a triangle and a part.
TEST(Clearance, MarksAllWhereEverythingIsNearEverything) {
  test::FineMesh ball = test::subdivided(test::octahedron(4), 2);
  for (Vec3f& p : ball.positions) p = unit(p) * 4;
  test::FineMesh many;
  for (int i = 0; i < 343; ++i) {
    const auto first = static_cast<Index>(many.positions.size());
    const Vec3f at(12 * static_cast<float>(i % 7), 12 * static_cast<float>(i / 7 % 7),
                   12 * static_cast<float>(i / 49));
    for (const Vec3f& p : ball.positions) many.positions.push_back(p + at);
    for (Triangle t : ball.triangles) {
      for (Index& v : t.vertices) v += first;
      many.triangles.push_back(t);
    }
  }
  base::Job job(1, {});
  for (const float reach : {0.1f, 100.0f}) {
    Surface surface = surfaceOf(many, job);
    Partition partition;
    partition.build(surface, {500}, 0.5f, job);
    ASSERT_GT(partition.size(), 10U);
    surface.flags.assign(surface.flags.size(), 0);
    markNarrow(surface, partition, reach, job);
    const auto marks = std::count_if(surface.flags.begin(), surface.flags.end(),
                                     [](unsigned flags) { return (flags & kNarrow) != 0; });
    EXPECT_EQ(marks, reach > 1 ? std::ssize(surface.flags) : 0);
  }
}

// A section that starts at a vertex may begin in any face there, not only in one that it passes.
TEST(Sections, StartAtAVertexInWhateverFaceIsGiven) {
  test::FineMesh ball = test::subdivided(test::octahedron(8), 3);
  for (Vec3f& p : ball.positions) p = unit(p) * 8;
  base::Job job(1, {});
  const ReferenceMesh reference(surfaceOf(ball, job), {}, job);
  for (Index v = 0; v < ball.positions.size(); ++v) {
    const Vec3f from = ball.positions[v];
    reference.allAround(v, [&](Index towards) {
      for (const Index w : reference.vertices(towards)) {
        if (w == v) continue;
        reference.allAround(v, [&](Index first) {
          const auto anywhere = [](Index, Vec3f, Vec3f, Vec3f) { return true; };
          EXPECT_TRUE(
              reference.follow(first, {from, ball.positions[w] - from, unit(from)}, anywhere))
              << v << " to " << w << " from face " << first;
          return true;
        });
      }
      return true;
    });
  }
}

// Of two fans whose ends have the same sum.
TEST(Surface, IsOpenAtPinchedVertices) {
  test::FineMesh fans;
  for (const Vec3f& p :
       {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(1, 1, 0), Vec3f(-1, 0, 0), Vec3f(-1, 1, 0)}) {
    fans.positions.push_back(p);
  }
  fans.triangles = {Triangle(0, 1, 2), Triangle(0, 4, 3)};
  base::Job job(1, {});
  const Surface surface = test::surfaceOf(fans, job);
  for (const std::uint8_t flags : surface.flags) EXPECT_NE(flags & kBorder, 0);
}

}  // namespace
}  // namespace tufa::reduce
