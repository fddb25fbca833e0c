#include "reduce/reduction.h"

#include <gtest/gtest.h>
#include <tufa/error.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "reduce/triangles.h"
#include "support/mesh_oracle.h"
#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

// What must hold of any result, by oracles that know nothing of the engine.
void expectSound(const test::FineMesh& before, const ReducedMesh& after,
                 const Certificate& certificate) {
  const Mesh reference = test::toMesh(before.positions, before.triangles);
  const Mesh mesh = test::toMesh(after.positions, after.triangles);
  const test::MeshTopology was = test::inspect(reference), is = test::inspect(mesh);
  EXPECT_TRUE(is.manifold()) << is;
  EXPECT_TRUE(is.closed()) << is;
  EXPECT_EQ(is.euler(), was.euler());
  EXPECT_EQ(is.components, was.components);
  EXPECT_EQ(test::intersectingPairs(mesh), 0U);
  const double there = test::sampledDistance(mesh, reference, 500);
  const double back = test::sampledDistance(reference, mesh, 500);
  EXPECT_LE(std::max(there, back), certificate.largest * 1.0001 + 1e-4);
}

ReducedMesh reduced(const test::FineMesh& mesh, float tolerance, int threads) {
  base::Job job(threads, {});
  ReducedMesh out;
  job.run([&] {
    Options options;
    options.partSize.vertices = 500;  // so that there are several parts
    Reduction reduction(mesh.input(), mesh.input(), {}, {}, options, job);
    reduction.toTolerance(tolerance);
    out = reduction.mesh();
  });
  return out;
}

class RandomMeshes : public testing::TestWithParam<unsigned> {};

TEST_P(RandomMeshes, StaySound) {
  const unsigned seed = GetParam();
  const double wavelength = 3.5 + seed % 5 * 1.5;
  const test::FineMesh mesh = seed % 3 == 0
                                  ? test::bumpySphere(4, 8, static_cast<float>(seed % 4), seed)
                                  : test::noiseSolid(10, wavelength, seed);
  const float tolerance = 0.03f * std::pow(1.6f, static_cast<float>(seed * 7 % 8));
  base::Job job(1, {});
  Options options;
  if (seed % 2 == 0) {
    options.partSize.vertices = 4096;
  } else {
    options.partSize = {300, 1500, 100};
  }
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, options, job);
  reduction.toTolerance(tolerance);
  Certificate certificate = reduction.certificate();
  EXPECT_LE(certificate.largest, tolerance * 1.15f) << tolerance;
  expectSound(mesh, reduction.mesh(), certificate);
  // On to a count in the same run.
  const Index count = reduction.triangleCount() / 2;
  reduction.toCount(count, 3);
  certificate = reduction.certificate();
  expectSound(mesh, reduction.mesh(), certificate);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomMeshes, testing::Range(1U, 19U));

// Shares of triangles under an angle, by an oracle of its own.
double shareUnder(const ReducedMesh& mesh, double degrees) {
  std::size_t under = 0;
  for (const Triangle& t : mesh.triangles) {
    const Mesh one = test::toMesh(mesh.positions, {t});
    under += test::anglesOf(one).smallest < degrees ? 1 : 0;
  }
  return static_cast<double>(under) / static_cast<double>(mesh.triangles.size());
}

ReducedMesh reducedAtAngle(const test::FineMesh& mesh, double asked) {
  constexpr float kTolerance = 0.2f;
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, optionsForAngle(asked), job);
  reduction.toTolerance(kTolerance);
  EXPECT_LE(reduction.certificate().largest, kTolerance * 1.15f) << asked;
  expectSound(mesh, reduction.mesh(), reduction.certificate());
  return reduction.mesh();
}

// Four in five of the triangles under the angle that is asked for are gone, or more.
TEST(Reduction, KeepsAnAngle) {
  const test::FineMesh meshes[] = {test::bumpySphere(5, 10, 1.5f, 1), test::noiseSolid(12, 6, 2)};
  for (const test::FineMesh& mesh : meshes) {
    const ReducedMesh any = reducedAtAngle(mesh, 0);
    for (const double asked : {20.0, 30.0}) {
      const ReducedMesh kept = reducedAtAngle(mesh, asked);
      EXPECT_LT(shareUnder(kept, asked), shareUnder(any, asked) / 5) << asked;
      EXPECT_LT(kept.triangles.size(), 3 * any.triangles.size()) << asked;
    }
  }
}

// A long cylinder has the fewest triangles in strips of needles along it.
TEST(Reduction, MakesFewSliversAndNoLongFans) {
  const test::FineMesh cylinder = test::levelSet(60, [](double x, double y, double z) {
    return std::max(std::hypot(x - 30, y - 30) - 8.2, std::abs(z - 30) - 26.3);
  });
  const auto reducedWith = [&](const Options& options) {
    base::Job job(1, {});
    Reduction reduction(cylinder.input(), cylinder.input(), {}, {}, options, job);
    reduction.toTolerance(0.1f);
    return reduction.mesh();
  };
  Options any;
  any.sliverShare = 1;
  EXPECT_GT(shareUnder(reducedWith(any), any.leastAngle), 0.2);
  const ReducedMesh few = reducedWith({});
  EXPECT_LT(shareUnder(few, Options().leastAngle), 0.1);
  std::vector<int> valence(few.positions.size(), 0);
  for (const Triangle& t : few.triangles) {
    for (const VertexIndex v : t.vertices) ++valence[v];
  }
  EXPECT_LE(*std::max_element(valence.begin(), valence.end()), 12);
}

// On blobs thin triangles follow nothing, so hardly any are made.
TEST(Reduction, MakesHardlyAnySliversWhereTheSurfaceBendsBothWays) {
  const test::FineMesh blobs = test::noiseSolid(64, 16, 1);
  const auto reducedWith = [&](const Options& options) {
    base::Job job(1, {});
    Reduction reduction(blobs.input(), blobs.input(), {}, {}, options, job);
    reduction.toTolerance(1);
    return reduction.mesh();
  };
  Options any;
  any.bentSliverShare = any.sliverShare;
  const ReducedMesh many = reducedWith(any), few = reducedWith({});
  EXPECT_GT(shareUnder(many, any.leastAngle), 0.03);
  EXPECT_LT(shareUnder(few, any.leastAngle), 0.02);
  EXPECT_LT(20 * few.triangles.size(), 21 * many.triangles.size());
}

// A torus of quads with waves, as quads and as their halves.
TEST(Reduction, IsTheSameOfQuadsAndOfTheirHalves) {
  constexpr Index kAround = 90, kAcross = 40;
  std::vector<Vec3f> positions;
  std::vector<Quad> quads;
  for (Index i = 0; i < kAround; ++i) {
    for (Index j = 0; j < kAcross; ++j) {
      const float u = 6.2831853f * static_cast<float>(i) / kAround;
      const float v = 6.2831853f * static_cast<float>(j) / kAcross;
      const float r = 15 + 5 * std::cos(v) + 0.3f * std::sin(5 * u);
      positions.emplace_back(r * std::cos(u), r * std::sin(u), 5 * std::sin(v));
      const Index right = (i + 1) % kAround, up = (j + 1) % kAcross;
      quads.emplace_back(i * kAcross + j, right * kAcross + j, right * kAcross + up,
                         i * kAcross + up);
    }
  }
  std::vector<Triangle> triangles;
  for (const auto& [v] : quads) {
    triangles.emplace_back(v[0], v[1], v[2]);
    triangles.emplace_back(v[0], v[2], v[3]);
  }
  const auto reducedFrom = [&](base::TriangleArray faces) {
    const InputMesh mesh{base::SharedArray<Vec3f>(positions), std::move(faces)};
    base::Job job(1, {});
    Options options;
    options.partSize.vertices = 500;
    Reduction reduction(mesh, mesh, {}, {}, options, job);
    reduction.toTolerance(0.2f);
    return std::pair(reduction.mesh(), reduction.certificate().largest);
  };
  const auto [ofHalves, errorOfHalves] = reducedFrom(std::vector(triangles));
  const auto [ofQuads, errorOfQuads] = reducedFrom(std::move(quads));
  EXPECT_LT(ofQuads.triangles.size(), triangles.size() / 2);
  EXPECT_EQ(ofQuads.triangles, ofHalves.triangles);
  EXPECT_EQ(ofQuads.sources, ofHalves.sources);
  EXPECT_EQ(ofQuads.faces, ofHalves.faces);
  EXPECT_EQ(errorOfQuads, errorOfHalves);
}

TEST(Reduction, GivesTheSameBytesForAnyThreads) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const test::FineMesh mesh = test::noiseSolid(16, 6, seed);
    const ReducedMesh one = reduced(mesh, 0.2f, 1), four = reduced(mesh, 0.2f, 4);
    EXPECT_EQ(one.positions, four.positions);
    EXPECT_EQ(one.triangles, four.triangles);
    EXPECT_EQ(one.sources, four.sources);
  }
}

TEST(Reduction, SaysWhichVerticesAreTheInputs) {
  const test::FineMesh mesh = test::noiseSolid(10, 6, 3);
  const ReducedMesh out = reduced(mesh, 0.02f, 1);
  std::size_t kept = 0;
  for (std::size_t v = 0; v < out.positions.size(); ++v) {
    if (out.sources[v] == kNone) continue;
    ++kept;
    EXPECT_EQ(out.positions[v], mesh.positions[out.sources[v]]);
  }
  EXPECT_GT(kept, 10U);
  EXPECT_LT(kept, out.positions.size());
}

TEST(Reduction, OfAChainGoesOnFromLevelToLevel) {
  const test::FineMesh mesh = test::bumpySphere(4, 8, 1, 4);
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
  Index last = reduction.triangleCount();
  EXPECT_EQ(last, mesh.triangles.size());
  EXPECT_LT(reduction.certificate().largest, 1e-5f);
  for (const float tolerance : {0.1f, 0.2f, 0.4f, 0.8f}) {
    reduction.toTolerance(tolerance);
    EXPECT_LT(reduction.triangleCount(), last);
    last = reduction.triangleCount();
    EXPECT_LE(reduction.certificate().largest, tolerance);
  }
}

// The vertices lie over faces of the mesh that came in, whatever they were measured against.
void expectFacesNear(const test::FineMesh& input, const ReducedMesh& mesh, float most) {
  ASSERT_EQ(mesh.faces.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    ASSERT_LT(mesh.faces[v], input.triangles.size());
    const auto& [a, b, c] = input.triangles[mesh.faces[v]].vertices;
    const float d2 = squaredDistanceToTriangle(mesh.positions[v], input.positions[a],
                                               input.positions[b], input.positions[c]);
    EXPECT_LE(std::sqrt(d2), most);
  }
}

class ChainsByProxy : public testing::TestWithParam<unsigned> {};

// From 0.3 on distances are measured to the mesh of the first tolerance.
TEST_P(ChainsByProxy, KeepToTheMeshThatCameIn) {
  const unsigned seed = GetParam();
  const test::FineMesh mesh =
      seed % 2 == 0 ? test::bumpySphere(5, 8, 1, seed) : test::noiseSolid(12, 6, seed);
  base::Job job(1, {});
  Options options;
  options.partSize.vertices = 1000;
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, options, job);
  Index last = reduction.triangleCount();
  for (const float tolerance : {0.02f, 0.1f, 0.3f, 0.6f, 2.0f}) {
    reduction.toTolerance(tolerance);
    EXPECT_LT(reduction.triangleCount(), last);
    last = reduction.triangleCount();
    const Certificate certificate = reduction.certificate();
    EXPECT_LE(certificate.largest, tolerance);
    EXPECT_GT(certificate.largest, 0.6f * tolerance);
    EXPECT_LE(certificate.mean, certificate.largest);
    expectSound(mesh, reduction.mesh(), certificate);
    expectFacesNear(mesh, reduction.mesh(), 3 * tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ChainsByProxy, testing::Range(1U, 7U));

// The mesh at 1.45 may be farther from the one at 0.1 than is left of the next tolerance.
TEST(Reduction, IsMeasuredByProxyOnlyWhereThatIsWithinTheTolerance) {
  const test::FineMesh mesh = test::bumpySphere(5, 16, 3, 4);
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
  for (const float tolerance : {0.1f, 1.45f, 1.5f, 3.0f}) {
    reduction.toTolerance(tolerance);
    EXPECT_LE(reduction.certificate().largest, tolerance);
  }
}

TEST(Reduction, ReachesACount) {
  const test::FineMesh mesh = test::bumpySphere(4, 8, 1, 4);
  for (const Index count : {1000U, 300U, 60U}) {
    base::Job job(1, {});
    Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
    const float tolerance = reduction.toCount(count, 8);
    EXPECT_LE(reduction.triangleCount(), count + 1);
    EXPECT_GE(reduction.triangleCount(), count * 95 / 100);
    EXPECT_LE(reduction.certificate().largest, tolerance);
    EXPECT_LT(tolerance, 8);
  }
}

TEST(Reduction, GivesUpACountOutOfReach) {
  const test::FineMesh mesh = test::bumpySphere(3, 8, 1, 4);
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
  EXPECT_EQ(reduction.toCount(10, 0.2f), 0.2f);
  EXPECT_GT(reduction.triangleCount(), 10U);
  EXPECT_LE(reduction.certificate().largest, 0.2f);
}

// A blade has 94 triangles without new slivers and fans.
TEST(Reduction, TakesSliversNearTheLeastCount) {
  test::FineMesh mesh = test::bumpySphere(4, 8, 1, 4);
  for (Vec3f& p : mesh.positions) p = {6 * p.x, p.y, 0.1f * p.z};
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
  EXPECT_LT(reduction.toCount(75, 1000), 1000);
  EXPECT_LE(reduction.triangleCount(), 75U);
}

// Starts from a cut, each of whose vertices stands for some of the reference's.
TEST(Reduction, MeasuresToAReferenceThatIsNotItsInput) {
  const test::FineMesh fine = test::bumpySphere(5, 8, 0.6f, 4);
  const test::FineMesh coarse = test::bumpySphere(4, 8, 0.6f, 4);
  std::vector<Index> standsFor;
  for (const Vec3f p : fine.positions) {
    Index nearest = 0;
    for (Index v = 1; v < coarse.positions.size(); ++v) {
      if (length(coarse.positions[v] - p) < length(coarse.positions[nearest] - p)) nearest = v;
    }
    standsFor.push_back(nearest);
  }
  base::Job job(1, {});
  Reduction reduction(coarse.input(), fine.input(), standsFor, {}, {}, job);
  reduction.toTolerance(0.3f);
  EXPECT_LT(reduction.triangleCount(), coarse.triangles.size() / 2);
  const Certificate certificate = reduction.certificate();
  EXPECT_LE(certificate.largest, 0.3f);
  expectSound(fine, reduction.mesh(), certificate);
}

// As a cut mesh may be whose vertices were separated.
TEST(Reduction, MeasuresWhatCameInAtAToleranceOfNothing) {
  const test::FineMesh plain = test::subdivided(test::box(8, 8, 8), 2);
  test::FineMesh moved = plain;
  moved.positions[30] = moved.positions[30] * 1.01f;
  const float off = length(moved.positions[30] - plain.positions[30]);
  std::vector<Index> same(plain.positions.size());
  for (Index v = 0; v < same.size(); ++v) same[v] = v;
  base::Job job(1, {});
  Reduction reduction(moved.input(), plain.input(), same, {}, {}, job);
  reduction.toTolerance(0);
  EXPECT_EQ(reduction.triangleCount(), plain.triangles.size());
  EXPECT_GT(reduction.certificate().largest, 0.3f * off);
  EXPECT_LE(reduction.certificate().largest, std::max(1.01f * off, 0.1f));
}

TEST(Reduction, StopsWhenItIsCancelled) {
  const test::FineMesh mesh = test::noiseSolid(14, 5, 3);
  int calls = 0;
  base::Job job(1, [&](std::string_view, double) { return ++calls < 10; });
  const auto reduce = [&] {
    job.beginStage("collapse", 1);
    Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
    reduction.toTolerance(0.5f);
  };
  try {
    job.run(reduce);
    FAIL() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
}

TEST(Reduction, OfNothingIsNothing) {
  base::Job job(1, {});
  Reduction reduction({}, {}, {}, {}, {}, job);
  reduction.toTolerance(0.1f);
  EXPECT_EQ(reduction.certificate().largest, 0);
  EXPECT_TRUE(reduction.mesh().triangles.empty());
}

}  // namespace
}  // namespace tufa::reduce
