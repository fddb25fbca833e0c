#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <set>

#include "reduce/reduction.h"
#include "support/mesh_oracle.h"
#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

struct Result {
  Mesh mesh;
  Certificate certificate;
  OperationCounts counts;
};

Result reduced(const test::FineMesh& mesh, float tolerance, Outcome switchedOff = Outcome::Done) {
  base::Job job(1, {});
  Options options;
  options.switchedOff = switchedOff;
  options.attempts = 0;
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, options, job);
  reduction.toTolerance(tolerance);
  const ReducedMesh out = reduction.mesh();
  return {test::toMesh(out.positions, out.triangles), reduction.certificate(), reduction.counts()};
}

std::uint64_t refused(const OperationCounts& counts, Outcome by) {
  return counts.collapses[static_cast<std::size_t>(by)];
}

// A low roof over a deep pyramid. A flip of its ridge, long as it is, would make rounder triangles
// with the same vertices, one voxel below it.
const test::FineMesh kRoof{{{-20, 0, 0}, {20, 0, 0}, {0, -6, -1}, {0, 6, -1}, {0, 0, -20}},
                           {{2, 1, 0}, {3, 0, 1}, {0, 4, 2}, {2, 4, 1}, {1, 4, 3}, {3, 4, 0}}};

TEST(Guards, RefuseAnEdgeThatIsFarWhereNoVertexIs) {
  const Result kept = reduced(kRoof, 0.3f);
  EXPECT_EQ(kept.counts.flipped(), 0U);
  EXPECT_GT(kept.counts.flips[static_cast<std::size_t>(Outcome::Crossing)], 0U);
  EXPECT_LT(kept.certificate.largest, 0.3f);
  const Result flipped = reduced(kRoof, 0.3f, Outcome::Crossing);
  EXPECT_GT(flipped.counts.flipped(), 0U);
  EXPECT_GT(flipped.certificate.largest, 0.9f);
  EXPECT_LT(flipped.certificate.mean, 1e-5f);  // at every vertex it is 0
}

TEST(Guards, AllowWhatKeepsTheTolerance) { EXPECT_GT(reduced(kRoof, 1.1f).counts.flipped(), 0U); }

// A plate whose upper side waves: flattened, it would come through the lower side, which is `gap`
// below the lowest places.
test::FineMesh wavingPlate(float gap, float height, float bend) {
  test::FineMesh plate = test::subdivided(test::box(24, 24, 1), 5);
  for (Vec3f& p : plate.positions) {
    const float wave = height * (1 + std::sin(p.x * 1.1f) * std::sin(p.y * 0.9f));
    p.z = p.z * (gap + wave) + bend * std::sin(p.x * 0.8f);
  }
  return plate;
}

TEST(Guards, RefuseToReachASheetThatIsNear) {
  const test::FineMesh plate = wavingPlate(0.05f, 0.35f, 0.5f);
  for (const float tolerance : {0.3f, 1.0f}) {
    const Result kept = reduced(plate, tolerance);
    EXPECT_EQ(test::intersectingPairs(kept.mesh), 0U);
    EXPECT_GT(refused(kept.counts, Outcome::Intersection), 0U);
    EXPECT_LE(kept.certificate.largest, tolerance * 1.001f);
    EXPECT_LT(kept.mesh.triangles.size(), plate.triangles.size() / 4);
    EXPECT_GT(test::intersectingPairs(reduced(plate, tolerance, Outcome::Intersection).mesh), 0U);
  }
}

TEST(Guards, LetAcuteEdgesCoarsen) {
  EXPECT_LE(reduced(test::subdivided(test::tetrahedron(20), 4), 0.1f).mesh.triangles.size(), 12U);
  for (const float degrees : {20.0f, 35.0f, 50.0f, 70.0f}) {
    const test::FineMesh prism = test::subdivided(test::wedge(16, degrees, 12), 4);
    const Result result = reduced(prism, 0.1f);
    EXPECT_LE(result.mesh.triangles.size(), 24U) << degrees;
    EXPECT_LE(result.certificate.largest, 0.1f) << degrees;
    EXPECT_EQ(test::intersectingPairs(result.mesh), 0U) << degrees;
  }
}

// A sheet with a hole, bent: borders stay, vertex by vertex.
TEST(Guards, KeepOpenBordersAsTheyAre) {
  constexpr VertexIndex kSide = 33;
  test::FineMesh sheet;
  for (VertexIndex i = 0; i < kSide * kSide; ++i) {
    const auto x = static_cast<float>(i % kSide), y = static_cast<float>(i / kSide);
    sheet.positions.emplace_back(x, y, 0.02f * x * x + std::sin(y / 5));
  }
  for (VertexIndex y = 0; y + 1 < kSide; ++y) {
    for (VertexIndex x = 0; x + 1 < kSide; ++x) {
      if (x > 10 && x < 15 && y > 20 && y < 24) continue;
      const VertexIndex i = y * kSide + x;
      sheet.triangles.emplace_back(i, i + 1, i + kSide + 1);
      sheet.triangles.emplace_back(i, i + kSide + 1, i + kSide);
    }
  }
  const Mesh before = test::toMesh(sheet.positions, sheet.triangles);
  const auto borderOf = [](const Mesh& mesh) {
    const auto key = [&](VertexIndex v) {
      const Position& p = mesh.positions[v];
      return std::array<double, 3>{p.x, p.y, p.z};
    };
    std::multiset<std::pair<std::array<double, 3>, std::array<double, 3>>> edges;
    for (const Triangle& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) edges.emplace(key(t.vertices[i]), key(t.vertices[(i + 1) % 3]));
    }
    std::set<std::pair<std::array<double, 3>, std::array<double, 3>>> border;
    for (const auto& [a, b] : edges) {
      if (!edges.contains({b, a})) border.emplace(a, b);
    }
    return border;
  };
  const Result result = reduced(sheet, 0.2f);
  EXPECT_LT(result.mesh.triangles.size(), sheet.triangles.size() / 4);
  EXPECT_EQ(borderOf(result.mesh), borderOf(before));
  EXPECT_TRUE(test::inspect(result.mesh).manifold());
  EXPECT_LE(result.certificate.largest, 0.2f);
}

// A flat component of few triangles. Without the guard it is turned inside out within the
// tolerance.
TEST(Guards, KeepSmallComponentsOutsideOut) {
  for (const float height : {0.05f, 0.1f, 0.2f}) {
    test::FineMesh flat = test::bumpySphere(1, 1, 0, 1);
    for (Vec3f& p : flat.positions) p.z *= height;
    const Result kept = reduced(flat, 3);
    EXPECT_LT(kept.mesh.triangles.size(), flat.triangles.size());
    EXPECT_GT(test::volume(kept.mesh), 0) << height;
  }
}

// The roof over a pyramid less deep than its eaves are low: a flip of the ridge turns the component
// inside out. No two of its triangles are without a common vertex, and it is so small that folds
// are none.
TEST(Guards, KeepSmallComponentsOutsideOutWhereEdgesAreFlipped) {
  test::FineMesh shallow = kRoof;
  shallow.positions[4].z = -0.5f;
  for (Vec3f& p : shallow.positions) p = p * 0.01f;
  const Result kept = reduced(shallow, 0.02f);
  EXPECT_GT(kept.counts.flips[static_cast<std::size_t>(Outcome::Side)], 0U);
  EXPECT_GT(test::volume(kept.mesh), 0);
  EXPECT_LT(test::volume(reduced(shallow, 0.02f, Outcome::Side).mesh), 0);
}

// Boxes a few thousandths of a voxel wide. A tetrahedron of four of their corners may have hardly a
// volume, which is another one once places are rounded.
TEST(Guards, KeepSmallComponentsAsThickAsRoundingAsksFor) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> width(0.002f, 0.05f);
  const auto thinnest = [](const Result& result) {
    return 2 * std::abs(test::volume(result.mesh)) / test::area(result.mesh);
  };
  int thin = 0;
  for (int round = 0; round < 100; ++round) {
    test::FineMesh box;
    const Vec3f size(width(random), width(random), width(random));
    for (int i = 0; i < 8; ++i) {
      box.positions.emplace_back(size.x * float(i >> 2), size.y * float((i >> 1) & 1),
                                 size.z * float(i & 1));
    }
    const Index quads[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                               {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& q : quads) {
      box.triangles.emplace_back(q[0], q[1], q[2]);
      box.triangles.emplace_back(q[0], q[2], q[3]);
    }
    const Result kept = reduced(box, 1);
    EXPECT_LT(kept.mesh.triangles.size(), 12U);
    EXPECT_GT(test::volume(kept.mesh), 0);
    EXPECT_GE(thinnest(kept), 0.999e-3) << round;
    thin += thinnest(reduced(box, 1, Outcome::Side)) < 0.5e-3 ? 1 : 0;
  }
  EXPECT_GT(thin, 5) << "what the guard is for";
}

// A speck between the ridge and the place where it would be after a flip: it would come out of the
// solid, or into it, and no triangle meets another.
TEST(Guards, FlipNoEdgeOverAComponent) {
  test::FineMesh roof = kRoof;
  for (const Vec3f& p :
       {Vec3f(0, 0, -0.6f), Vec3f(0.1f, 0, -0.5f), Vec3f(0, 0.1f, -0.5f), Vec3f(0, 0, -0.5f)}) {
    roof.positions.push_back(p);
  }
  // A cavity.
  for (const Triangle& t :
       {Triangle(5, 6, 7), Triangle(5, 7, 8), Triangle(5, 8, 6), Triangle(6, 8, 7)}) {
    roof.triangles.push_back(t);
  }
  const Result kept = reduced(roof, 1.1f);
  EXPECT_EQ(kept.counts.flipped(), 0U);
  EXPECT_GT(kept.counts.flips[static_cast<std::size_t>(Outcome::Side)], 0U);
  EXPECT_GT(reduced(roof, 1.1f, Outcome::Side).counts.flipped(), 0U);
}

// What an audit of a mesh sees, without a look at how it was made.
struct Audit {
  explicit Audit(const Result& result)
      : largest(result.certificate.largest),
        pairs(test::intersectingPairs(result.mesh)),
        folds(test::folds(result.mesh)),
        smallestAngle(test::anglesOf(result.mesh).smallest) {}
  float largest;
  std::size_t pairs, folds;
  double smallestAngle;
};

// Whether an audit sees that a mesh made with a guard switched off lacks what the other one has.
bool isHarmed(const Audit& off, const Audit& on, float tolerance) {
  return off.largest > tolerance * 1.1f || off.pairs > 0 || off.folds > on.folds + 5 ||
         off.smallestAngle < 0.5 * on.smallestAngle;
}

test::FineMesh plate(unsigned seed) {
  const float gaps[] = {0.05f, 0.1f, 0.4f}, heights[] = {0.35f, 0.5f};
  return wavingPlate(gaps[seed % 3], heights[seed / 3 % 2], 0.5f * static_cast<float>(seed / 6));
}
test::FineMesh sphere(unsigned seed) { return test::bumpySphere(4, 10, 1.5f, seed + 1); }
test::FineMesh noise(unsigned seed) { return test::noiseSolid(12, 4, seed + 1); }

// Each guard switched off in turn does harm on one of some meshes. What another guard refuses in
// its place differs from mesh to mesh. Link and Place have no switch: without them the tables
// themselves would break. What Star, Flat and Turn refuse others refuse on most meshes: see
// star_test.cpp, and the test below.
TEST(Guards, AreFoundMissingByAnAudit) {
  struct Case {
    Outcome guard;
    test::FineMesh (*mesh)(unsigned seed);
    float tolerance;
    unsigned first;  // where harm was seen last: tried first
  };
  const Case cases[] = {
      {Outcome::Sample, sphere, 0.3f, 0},  {Outcome::Apex, sphere, 0.2f, 0},
      {Outcome::Crossing, noise, 0.2f, 0}, {Outcome::Face, noise, 0.2f, 1},
      {Outcome::Fold, noise, 0.3f, 3},     {Outcome::Intersection, plate, 0.3f, 0},
      {Outcome::Round, plate, 0.02f, 4},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(static_cast<int>(c.guard));
    bool isSeen = false;
    for (unsigned i = 0; i < 12 && !isSeen; ++i) {
      const unsigned seed = (c.first + i) % 12;
      const test::FineMesh mesh = c.mesh(seed);
      const Audit on(reduced(mesh, c.tolerance)), off(reduced(mesh, c.tolerance, c.guard));
      EXPECT_EQ(on.pairs, 0U) << seed;
      isSeen = on.largest <= c.tolerance * 1.005f && isHarmed(off, on, c.tolerance);
    }
    EXPECT_TRUE(isSeen);
  }
}

// Triangles may neither lose their area nor turn far, even within the tolerance. A plate of two
// sheets at a tolerance above their distance has many that would.
TEST(Guards, RefuseTrianglesThatAreFlatOrTurnFar) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Result kept = reduced(plate(seed), 1);
    EXPECT_GT(refused(kept.counts, Outcome::Flat), 0U) << seed;
    EXPECT_GT(refused(kept.counts, Outcome::Turn), 0U) << seed;
    EXPECT_EQ(refused(reduced(plate(seed), 1, Outcome::Turn).counts, Outcome::Turn), 0U) << seed;
  }
}

}  // namespace
}  // namespace tufa::reduce
