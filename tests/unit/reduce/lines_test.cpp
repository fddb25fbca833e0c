// Lines between regions: what they keep while all around them is reduced.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "reduce/reduction.h"
#include "support/mesh_oracle.h"
#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

constexpr float kMiddle = 8;

// A box that waves along x, with two regions, left and right of its middle plane.
test::FineMesh wavingBox(float height) {
  test::FineMesh box = test::subdivided(test::box(16, 16, 16), 5);
  for (Vec3f& p : box.positions) p.z += height * std::sin(0.7f * p.y) * std::cos(0.5f * p.x);
  return box;
}

Regions halvesOf(const test::FineMesh& mesh) {
  Regions regions;
  std::vector<Index> sides;
  for (const Triangle& t : mesh.triangles) {
    float sum = 0;
    for (const VertexIndex v : t.vertices) sum += mesh.positions[v].x;
    sides.push_back(sum < 3 * kMiddle ? 0 : 1);
  }
  regions.ofTriangle = std::move(sides);
  regions.planesOf = [positions = mesh.positions](Index v) {
    return LinePlanes{positions[v].x == kMiddle ? 0 : kNone, kNone, kNone};
  };
  regions.mayHold = [](Index region, Index plane, Vec3f place, Vec3f, Vec3f) {
    if (plane == 0) return place.x == kMiddle;
    return region == 0 ? place.x < kMiddle : place.x > kMiddle;
  };
  return regions;
}

struct Reducer {
  test::FineMesh input;
  base::Job job{1, {}};
  Reduction reduction;

  explicit Reducer(test::FineMesh mesh, std::vector<Vec3f> normals = {})
      : input(std::move(mesh)), reduction(input.input(), input.input(), {}, {}, {}, job) {
    Regions regions = halvesOf(input);
    regions.normals = std::move(normals);
    reduction.setRegions([regions] { return regions; });
  }

  [[nodiscard]] std::set<Index> lineSources() const {
    const Surface surface = reduction.surface();
    std::set<Index> sources;
    for (Index v = 0; v < surface.lineKind.size(); ++v) {
      if (surface.lineKind[v] != LineKind::Off) sources.insert(surface.sourceOf(v));
    }
    return sources;
  }
};

void expectWhole(const ReducedMesh& mesh) {
  const Mesh out = test::toMesh(mesh.positions, mesh.triangles);
  const test::MeshTopology topology = test::inspect(out);
  EXPECT_TRUE(topology.closed() && topology.manifold()) << topology;
  EXPECT_EQ(topology.euler(), 2);
  EXPECT_EQ(test::intersectingPairs(out), 0U);
}

// Each triangle on its side, and the line where they meet made of vertices of the input.
void expectApart(const Reducer& reducer) {
  const ReducedMesh mesh = reducer.reduction.mesh();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const VertexIndex v : mesh.triangles[t].vertices) {
      const float x = mesh.positions[v].x;
      EXPECT_TRUE(mesh.regions[t] == 0 ? x <= kMiddle : x >= kMiddle) << x;
    }
  }
  for (const Index source : reducer.lineSources()) {
    ASSERT_NE(source, kNone);
    EXPECT_EQ(reducer.input.positions[source].x, kMiddle);
  }
}

TEST(Lines, CoarsenWithTheSurfaceAndStayInTheirPlane) {
  Reducer box(test::subdivided(test::box(16, 16, 16), 5));
  const std::size_t before = box.lineSources().size();
  box.reduction.toTolerance(0.1f);
  expectWhole(box.reduction.mesh());
  expectApart(box);
  EXPECT_GT(before, 60U);
  EXPECT_LE(box.lineSources().size(), 6U);  // four corners are needed
  EXPECT_LE(box.reduction.triangleCount(), 28U);
}

TEST(Lines, FollowTheToleranceOnCurvedSurface) {
  Reducer box(wavingBox(0.8f));
  std::size_t vertices = box.lineSources().size();
  std::set<Index> before = box.lineSources();
  for (const float tolerance : {0.02f, 0.1f, 0.4f}) {
    box.reduction.toTolerance(tolerance);
    EXPECT_LE(box.reduction.certificate().largest, tolerance);
    expectWhole(box.reduction.mesh());
    expectApart(box);
    const std::set<Index> now = box.lineSources();
    EXPECT_LT(now.size(), vertices);
    for (const Index source : now) EXPECT_TRUE(before.contains(source));
    vertices = now.size();
    before = now;
  }
  const std::vector<float>& ofRegion = box.reduction.certificate().ofRegion;
  ASSERT_EQ(ofRegion.size(), 2U);
  EXPECT_EQ(std::max(ofRegion[0], ofRegion[1]), box.reduction.certificate().largest);
}

TEST(Lines, MayMoveInTheirPlaneWithTheRest) {
  Reducer kept(wavingBox(0.8f)), moving(wavingBox(0.8f), {{1, 0, 0}});
  for (Reducer* box : {&kept, &moving}) {
    box->reduction.toTolerance(0.1f);
    EXPECT_LE(box->reduction.certificate().largest, 0.1f);
    expectWhole(box->reduction.mesh());
    expectApart(*box);
  }
  EXPECT_LT(moving.lineSources().size(), kept.lineSources().size());
  EXPECT_LE(moving.reduction.triangleCount(), kept.reduction.triangleCount());
  std::size_t moved = 0;
  const Surface surface = moving.reduction.surface();
  for (Index v = 0; v < surface.lineKind.size(); ++v) {
    if (surface.lineKind[v] == LineKind::Off) continue;
    EXPECT_EQ(surface.position[v].x, kMiddle);
    moved += surface.position[v] == moving.input.positions[surface.sourceOf(v)] ? 0 : 1;
  }
  EXPECT_GT(moved, 4U);
}

// What a step of lines alone makes is the mesh before with other vertex numbers.
TEST(Lines, ReducedAloneChangeVertexNumbersOnly) {
  Reducer box(wavingBox(0.8f));
  box.reduction.toTolerance(0.02f);
  const ReducedMesh before = box.reduction.mesh();
  const std::set<Index> lines = box.lineSources();
  box.reduction.toTolerance(0.3f, LineMode::Alone);
  const ReducedMesh after = box.reduction.mesh();
  EXPECT_LT(box.lineSources().size(), lines.size());
  expectWhole(after);
  const std::vector<Index>& into = box.reduction.wentInto();
  const auto isOnLine = [&](Index v) {
    return before.sources[v] != kNone && lines.contains(before.sources[v]);
  };
  std::size_t gone = 0;
  const auto placeOf = [](const Vec3f& p) { return std::array{p.x, p.y, p.z}; };
  const auto keyOf = [&](const std::array<Vec3f, 3>& p) {
    return std::multiset{placeOf(p[0]), placeOf(p[1]), placeOf(p[2])};
  };
  std::multiset<std::multiset<std::array<float, 3>>> expected, found;
  for (const Triangle& t : before.triangles) {
    std::array<Vec3f, 3> p;
    std::set<std::array<float, 3>> different;
    for (std::size_t i = 0; i < 3; ++i) {
      Index v = t.vertices[i];
      gone += into[v] != v && !isOnLine(v) ? 1 : 0;
      while (into[v] != v) v = into[v];
      p[i] = before.positions[v];
      different.insert(placeOf(p[i]));
    }
    if (different.size() == 3) expected.insert(keyOf(p));
  }
  for (const Triangle& t : after.triangles) {
    found.insert(keyOf({after.positions[t.vertices[0]], after.positions[t.vertices[1]],
                        after.positions[t.vertices[2]]}));
  }
  EXPECT_EQ(expected, found);
  EXPECT_GT(gone, 0U) << "nothing beside the line";
}

// Two vertices of a line become one at a better place, which the step tells by the plane that the
// one that stays went for. All others are where they were.
TEST(Lines, MayMoveInTheirPlaneAlone) {
  std::size_t onKept = 0, onMoving = 0;
  for (const float height : {0.6f, 0.8f, 1.0f}) {
    Reducer kept(wavingBox(height)), moving(wavingBox(height), {{1, 0, 0}});
    for (Reducer* box : {&kept, &moving}) {
      box->reduction.toTolerance(0.02f, LineMode::Held);
      const ReducedMesh before = box->reduction.mesh();
      box->reduction.toTolerance(0.3f, LineMode::Alone);
      EXPECT_LE(box->reduction.certificate().largest, 0.3f);
      expectWhole(box->reduction.mesh());
      expectApart(*box);
      std::size_t moved = 0;
      const Surface surface = box->reduction.surface();
      for (Index v = 0; v < surface.lineKind.size(); ++v) {
        const Index name = surface.lineStep[v].name;
        const bool isMoved = !(surface.position[v] == before.positions[name]);
        EXPECT_EQ(box->reduction.wentInto()[name], name);
        EXPECT_EQ(isMoved, box->reduction.wentFor()[name] != kNone);
        EXPECT_TRUE(!isMoved || surface.position[v].x == kMiddle);
        moved += isMoved ? 1 : 0;
      }
      if (box == &kept) {
        EXPECT_EQ(moved, 0U);
      }
      if (box == &moving) {
        EXPECT_GT(moved, 4U);
      }
    }
    onKept += kept.lineSources().size(), onMoving += moving.lineSources().size();
  }
  EXPECT_LT(onMoving, onKept);
}

TEST(Lines, AreHeldWhileTheRestIsReduced) {
  Reducer box(wavingBox(0.8f));
  box.reduction.toTolerance(0.3f, LineMode::Held);
  EXPECT_EQ(box.lineSources().size(), Reducer(wavingBox(0.8f)).lineSources().size());
  EXPECT_LT(box.reduction.triangleCount(), box.input.triangles.size() / 8);
  expectWhole(box.reduction.mesh());
}

// The middle region is a cap whose only line has three vertices when it is as coarse as can be.
TEST(Lines, NeverVanishWithTheirRegion) {
  test::FineMesh ball = test::subdivided(test::octahedron(8), 4);
  for (Vec3f& p : ball.positions) p = unit(p) * 8;
  Regions regions;
  regions.planesOf = [](Index) { return kNoPlanes; };
  std::vector<Index> caps;
  for (const Triangle& t : ball.triangles) {
    float sum = 0;
    for (const VertexIndex v : t.vertices) sum += ball.positions[v].z;
    caps.push_back(sum > 3 * 7.2f ? 1 : 0);
  }
  regions.ofTriangle = std::move(caps);
  base::Job job(1, {});
  Reduction reduction(ball.input(), ball.input(), {}, {}, {}, job);
  reduction.setRegions([&] { return regions; });
  for (const float tolerance : {0.5f, 2.0f, 6.0f}) {
    reduction.toTolerance(tolerance, LineMode::Alone);
    reduction.toTolerance(tolerance, LineMode::Held);
    const std::vector<Index> left = reduction.mesh().regions;
    EXPECT_EQ(std::set<Index>(left.begin(), left.end()).size(), 2U) << tolerance;
  }
}

// A band around the line is reduced by itself, and takes the place of its triangles; one side then
// stays as it is, the line included, while the other one is reduced.
TEST(ReplacedParts, StayWhereTheirRegionIsHeld) {
  Reducer whole(wavingBox(0.2f));
  ReplacedPart part;
  test::FineMesh band;
  std::map<Index, Index> numbers;
  for (Index t = 0; t < whole.input.triangles.size(); ++t) {
    const auto& v = whole.input.triangles[t].vertices;
    if (std::any_of(v.begin(), v.end(), [&](Index corner) {
          return std::abs(whole.input.positions[corner].x - kMiddle) > 4;
        })) {
      continue;
    }
    part.faces.push_back(t);
    for (const Index corner : v) numbers.emplace(corner, 0);
  }
  for (auto& [vertex, number] : numbers) {
    number = static_cast<Index>(part.vertices.size());
    part.vertices.push_back(vertex);
    band.positions.push_back(whole.input.positions[vertex]);
  }
  for (const Index t : part.faces) {
    const auto& v = whole.input.triangles[t].vertices;
    band.triangles.emplace_back(numbers[v[0]], numbers[v[1]], numbers[v[2]]);
  }
  Reducer alone(band);
  alone.reduction.toTolerance(0.3f);
  EXPECT_LT(alone.reduction.triangleCount(), band.triangles.size() / 2);
  part.surface = alone.reduction.takeSurface();
  part.positions.assign(part.surface.position.begin(), part.surface.position.end());
  const std::size_t lines =
      std::count(part.surface.lineKind.begin(), part.surface.lineKind.end(), LineKind::On);
  const auto isRight = [](Index region) { return region == 1; };
  const std::size_t before = static_cast<std::size_t>(
      std::count_if(part.surface.region.begin(), part.surface.region.end(), isRight));
  std::size_t right = before;
  for (Index t = 0; t < whole.input.triangles.size(); ++t) {
    const bool isReplaced = std::binary_search(part.faces.begin(), part.faces.end(), t);
    right += !isReplaced && isRight(whole.reduction.surface().region[t]) ? 1 : 0;
  }
  const std::vector<ReplacedPart> parts{part};
  whole.reduction.replaceParts(parts, {0, 1});
  expectWhole(whole.reduction.mesh());
  whole.reduction.toTolerance(0.3f);
  const ReducedMesh mesh = whole.reduction.mesh();
  expectWhole(mesh);
  expectApart(whole);
  EXPECT_GT(whole.reduction.certificate().largest, 0);
  EXPECT_LE(whole.reduction.certificate().largest, 0.3f);
  EXPECT_LE(test::sampledDistance(test::toMesh(whole.input.positions, whole.input.triangles),
                                  test::toMesh(mesh.positions, mesh.triangles), 5000),
            0.301);
  EXPECT_EQ(std::count_if(mesh.regions.begin(), mesh.regions.end(), isRight), right);
  EXPECT_LT(mesh.triangles.size() - right, right / 4);
  EXPECT_EQ(std::count(whole.reduction.surface().lineKind.begin(),
                       whole.reduction.surface().lineKind.end(), LineKind::On),
            lines);
}

}  // namespace
}  // namespace tufa::reduce
