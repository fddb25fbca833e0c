#include "reduce/new_folds.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "unit/reduce/meshes.h"

namespace tufa::reduce {
namespace {

// A wedge measured against another one with the same vertices, by number.
std::vector<Index> newFolds(const test::FineMesh& mesh, const test::FineMesh& reference,
                            float tolerance) {
  base::Job job(1, {});
  const ReferenceMesh to(surfaceOf(reference, job), {}, job);
  Surface surface = surfaceOf(mesh, job);
  std::vector<Index> same(reference.positions.size());
  std::iota(same.begin(), same.end(), 0);
  locateAll(surface, to, same, job);
  return facesAtNewFolds(surface, to, tolerance, job);
}

test::FineMesh wedge(float degrees) { return test::subdivided(test::wedge(12, degrees, 4), 2); }

TEST(NewFolds, AreNotThoseOfTheReference) {
  EXPECT_TRUE(newFolds(wedge(20), wedge(20), 0.1f).empty());
  EXPECT_TRUE(newFolds(wedge(20), wedge(25), 0.5f).empty());
}

// Triangles of the reference may be much larger than the distance that is looked at.
TEST(NewFolds, AreNotThoseOfACoarseReference) {
  const test::FineMesh large = test::subdivided(test::wedge(96, 20, 32), 1);
  EXPECT_TRUE(newFolds(large, large, 0.1f).empty());
}

TEST(NewFolds, AreFoundOnAnEdgeThatIsBlunterInTheReference) {
  const test::FineMesh sharp = wedge(20), blunt = wedge(40);
  ASSERT_GT(test::folds(test::toMesh(sharp.positions, sharp.triangles)), 0U);
  const std::vector<Index> faces = newFolds(sharp, blunt, 0.5f);
  ASSERT_FALSE(faces.empty());
  for (const Index face : faces) {
    EXPECT_LT(face, blunt.triangles.size());
    bool isAtEdge = false;  // which runs along y through the origin
    for (const VertexIndex v : blunt.triangles[face].vertices) {
      const base::Vec3f p = blunt.positions[v];
      isAtEdge |= p.x * p.x + p.z * p.z < 1e-6f;
    }
    EXPECT_TRUE(isAtEdge) << face;
  }
  EXPECT_TRUE(newFolds(blunt, sharp, 0.5f).empty());
}

// Another wedge far away excuses nothing.
TEST(NewFolds, AreComparedWithWhatIsNear) {
  const auto both = [](float degrees) {
    test::FineMesh mesh = wedge(degrees);
    const test::FineMesh other = wedge(20);
    const auto first = static_cast<VertexIndex>(mesh.positions.size());
    for (const base::Vec3f& p : other.positions)
      mesh.positions.push_back(p + base::Vec3f(0, 40, 0));
    for (const Triangle& t : other.triangles) {
      mesh.triangles.push_back(
          {t.vertices[0] + first, t.vertices[1] + first, t.vertices[2] + first});
    }
    return mesh;
  };
  EXPECT_FALSE(newFolds(both(20), both(40), 0.5f).empty());
}

}  // namespace
}  // namespace tufa::reduce
