#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reduce/reduction.h"
#include "support/mesh_oracle.h"
#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

std::uint64_t knotsOf(const OperationCounts& counts, Outcome outcome) {
  return counts.knots[static_cast<std::size_t>(outcome)];
}

// A wedge whose sharp edge has vertices in the wrong order, so close together that the triangles
// they fold over have no area to speak of.
test::FineMesh knottyWedge(float degrees) {
  test::FineMesh mesh = test::subdivided(test::wedge(20, degrees, 24), 5);
  std::vector<Index> crease;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    if (std::hypot(p.x, p.z) < 1e-4f) crease.push_back(v);
  }
  std::sort(crease.begin(), crease.end(),
            [&](Index a, Index b) { return mesh.positions[a].y < mesh.positions[b].y; });
  for (std::size_t i = 3; i + 4 < crease.size(); i += 5) {
    Vec3f &a = mesh.positions[crease[i]], &b = mesh.positions[crease[i + 1]];
    const float middle = 0.5f * (a.y + b.y);
    a.y = middle + 0.02f, b.y = middle - 0.02f;
  }
  return mesh;
}

TEST(Knots, OnSharpEdgesAreTakenAtOnce) {
  for (const float degrees : {35.0f, 70.0f}) {
    SCOPED_TRACE(degrees);
    const test::FineMesh fine = knottyWedge(degrees);
    base::Job job(1, {});
    Reduction reduction(fine.input(), fine.input(), {}, {}, {}, job);
    reduction.toTolerance(0.2f);
    EXPECT_GT(knotsOf(reduction.counts(), Outcome::Done), 0U);
    EXPECT_LT(reduction.triangleCount(), 30U);
    EXPECT_LE(reduction.certificate().largest, 0.2f);
    const ReducedMesh out = reduction.mesh();
    const Mesh mesh = test::toMesh(out.positions, out.triangles);
    const test::MeshTopology topology = test::inspect(mesh);
    EXPECT_TRUE(topology.closed() && topology.manifold()) << topology;
    EXPECT_EQ(topology.euler(), 2);
    EXPECT_EQ(test::intersectingPairs(mesh), 0U);
    EXPECT_EQ(test::folds(mesh), 0U);
  }
}

// Thin walls beside each other, where every guard is needed.
TEST(Knots, KeepTheirPromisesOnNoise) {
  std::uint64_t done = 0;
  for (unsigned seed = 0; seed < 2; ++seed) {
    SCOPED_TRACE(seed);
    const test::FineMesh fine = test::noiseSolid(12, 5, seed);
    const Mesh input = test::toMesh(fine.positions, fine.triangles);
    base::Job job(1, {});
    Reduction reduction(fine.input(), fine.input(), {}, {}, {}, job);
    for (const float tolerance : {0.1f, 0.5f, 2.0f}) {
      reduction.toTolerance(tolerance);
      const ReducedMesh out = reduction.mesh();
      const Mesh mesh = test::toMesh(out.positions, out.triangles);
      const test::MeshTopology topology = test::inspect(mesh);
      EXPECT_TRUE(topology.manifold()) << topology;
      EXPECT_EQ(topology.euler(), test::inspect(input).euler());
      EXPECT_EQ(test::intersectingPairs(mesh), test::intersectingPairs(input));
      const double most = static_cast<double>(reduction.certificate().largest) + 1e-4;
      EXPECT_LE(test::sampledDistance(mesh, input, 300), most);
      EXPECT_LE(test::sampledDistance(input, mesh, 300), most);
    }
    done += knotsOf(reduction.counts(), Outcome::Done);
  }
  EXPECT_GT(done, 0U);
}

}  // namespace
}  // namespace tufa::reduce
