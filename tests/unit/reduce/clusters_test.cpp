#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "reduce/reduction.h"
#include "support/mesh_oracle.h"
#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

struct Clustered {
  Mesh mesh;
  Certificate certificate;
  OperationCounts counts;

  [[nodiscard]] std::uint64_t contractions(Outcome outcome) const {
    return counts.contractions[static_cast<std::size_t>(outcome)];
  }
};

Clustered clustered(const test::FineMesh& mesh, float tolerance, Options options = {}) {
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, std::move(options), job);
  reduction.toTolerance(tolerance);
  const ReducedMesh out = reduction.mesh();
  return {test::toMesh(out.positions, out.triangles), reduction.certificate(), reduction.counts()};
}

void expectPromises(const test::FineMesh& fine, const Clustered& result, float tolerance) {
  const Mesh input = test::toMesh(fine.positions, fine.triangles);
  const test::MeshTopology before = test::inspect(input), after = test::inspect(result.mesh);
  EXPECT_TRUE(after.closed() && after.manifold()) << after;
  EXPECT_EQ(after.euler(), before.euler());
  EXPECT_EQ(test::intersectingPairs(result.mesh), 0U);
  EXPECT_LE(result.certificate.largest, tolerance * 1.001f);
  const double most = static_cast<double>(result.certificate.largest) + 1e-4;
  EXPECT_LE(test::sampledDistance(result.mesh, input, 300), most);
  EXPECT_LE(test::sampledDistance(input, result.mesh, 300), most);
}

test::FineMesh torus(int size, double radius, double tube) {
  const double middle = 0.5 * size;
  return test::levelSet(size, [=](double x, double y, double z) {
    const double around = std::hypot(x - middle, y - middle) - radius;
    return std::hypot(around, z - middle) - tube;
  });
}

TEST(Clusters, TakeMostVerticesOfFineMeshes) {
  const std::vector<test::FineMesh> meshes = {test::subdivided(test::box(30, 20, 10), 5),
                                              test::bumpySphere(5, 20, 0.05f, 1), torus(60, 18, 8)};
  for (const test::FineMesh& mesh : meshes) {
    const Clustered result = clustered(mesh, 0.2f);
    expectPromises(mesh, result, 0.2f);
    EXPECT_GT(result.contractions(Outcome::Done), 20U);
    EXPECT_LT(2 * result.counts.collapsed(), mesh.positions.size());
    EXPECT_EQ(test::folds(result.mesh), 0U);
  }
}

TEST(Clusters, AreNotMadeWhereTheyAreSwitchedOff) {
  Options options;
  options.clusters = false;
  const Clustered result = clustered(torus(40, 10, 5), 0.2f, options);
  EXPECT_EQ(result.contractions(Outcome::Done), 0U);
  EXPECT_GT(result.counts.collapsed(), 500U);
}

// A tube of two voxels in a cube of eight is an annulus, not a disk.
TEST(Clusters, ThatAreNoDisksStay) {
  const test::FineMesh thin = torus(40, 14, 1.6);
  const Clustered result = clustered(thin, 0.14f);
  expectPromises(thin, result, 0.14f);
  EXPECT_GT(result.contractions(Outcome::Link), 0U);
}

TEST(Clusters, KeepTheirPromisesOnNoise) {
  for (const unsigned seed : {1U, 2U}) {
    const test::FineMesh noise = test::noiseSolid(20, 9, seed);
    const Clustered result = clustered(noise, 0.15f);
    expectPromises(noise, result, 0.15f);
    EXPECT_GT(result.contractions(Outcome::Done), 20U);
  }
}

// Contractions count as the collapses that they stand for.
TEST(Clusters, StopAtANumberOfTriangles) {
  const test::FineMesh mesh = test::subdivided(test::box(30, 20, 10), 5);
  base::Job job(1, {});
  Reduction reduction(mesh.input(), mesh.input(), {}, {}, {}, job);
  const auto asked = static_cast<Index>(mesh.triangles.size() * 2 / 3);
  EXPECT_LT(reduction.toCount(asked, 100), 1);
  EXPECT_LE(reduction.triangleCount(), asked);
  EXPECT_GT(reduction.triangleCount(), asked * 19 / 20);
  EXPECT_GT(reduction.counts().contractions[0], 0U);
}

TEST(Clusters, LeaveOpenBordersAlone) {
  test::FineMesh sheet = test::subdivided(test::box(30, 30, 4), 5);
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    return sheet.positions[t.vertices[0]].z + sheet.positions[t.vertices[1]].z +
               sheet.positions[t.vertices[2]].z <
           9;
  });
  const auto border = [](const Mesh& m) { return test::inspect(m).boundaryEdges; };
  const Clustered result = clustered(sheet, 0.2f);
  EXPECT_GT(result.contractions(Outcome::Done), 20U);
  EXPECT_GT(border(result.mesh), 0U);
  EXPECT_EQ(border(result.mesh), border(test::toMesh(sheet.positions, sheet.triangles)));
}

}  // namespace
}  // namespace tufa::reduce
