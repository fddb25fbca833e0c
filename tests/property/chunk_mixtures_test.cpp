// What chunks make together, whatever level each is drawn at.

#include <gtest/gtest.h>

#include <tufa/check.h>
#include <tufa/chunks.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "base/vec3.h"
#include "support/chunk_mixtures.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/nearest_triangle.h"
#include "support/print.h"
#include "support/shape.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

using test::expectMixturesToClose;
using test::Made;
using test::makeChunks;
using test::randomLods;

// With creases through the chunks' faces, and thin ridges beside them.
TEST(ChunkPairs, NoneAreLeft) {
  for (const Shape kind : {Shape::Terrain, Shape::Bracket}) {
    ChunkOptions options;
    options.chunkSize = 16;
    const Made made = makeChunks(*test::shapeOf(kind, 0.04), options);
    std::size_t left = 0;
    for (const ChunkEntry& entry : made.index.chunks) {
      for (const ChunkLevelEntry& level : entry.levels) left += level.intersectionsLeft;
    }
    EXPECT_EQ(left, 0u);
    std::mt19937 random(5);
    for (int round = 0; round < 3; ++round) {
      std::vector<std::size_t> lods = randomLods(made, random);
      restrictLods(made.index, lods);
      const CheckReport report = check(assembleChunks(made.chunks, lods));
      EXPECT_TRUE(report.watertight());
      EXPECT_EQ(report.selfIntersectingPairs, 0u);
    }
  }
}

// A plate with a round hole, four of its faces a hundredth of a voxel beside planes between chunks.
openvdb::FloatGrid::Ptr plateBesidePlanes() {
  const openvdb::CoordBBox box(openvdb::Coord(-5), openvdb::Coord(37, 37, 13));
  return test::levelSet<openvdb::FloatGrid>(
      box, 3,
      [](const openvdb::Coord& at) {
        const openvdb::Vec3d p = at.asVec3d();
        const double upper = std::max({p.x() - 32.011, p.y() - 32, p.z() - 8.009});
        const double lower = std::max({-p.x() - 0.013, -p.y() - 3.3, -p.z() - 0.012});
        return std::max({upper, lower, 7 - std::hypot(p.x() - 15, p.y() - 17)});
      },
      1);
}

TEST(ChunksOfFacesBesidePlanes, AreFewAndWithinWhatTheySay) {
  const openvdb::FloatGrid::Ptr grid = plateBesidePlanes();
  ChunkOptions options;
  options.chunkSize = 16;
  const Made made = makeChunks(*grid, options);
  test::expectTolerancesKept(made);
  // Else there are also those beyond all four faces, which hold nothing but these faces.
  EXPECT_LE(made.index.chunks.size(), 12U);
  const Mesh uniform = test::uniformMesh(*grid);
  for (std::size_t level = 0; level < 4; ++level) {
    double error = 0;
    for (const ChunkEntry& entry : made.index.chunks) {
      error = std::max(error, entry.levels[level].maxErrorVoxels);
    }
    const Mesh mesh = assembleChunks(made.chunks, std::vector(made.chunks.size(), level));
    EXPECT_TRUE(check(mesh).watertight()) << level;
    EXPECT_LE(test::largestDistance(mesh, uniform, 10), error + 1e-5) << level;
    EXPECT_LE(test::largestDistance(uniform, mesh, 10), error + 1e-5) << level;
  }
  (void)expectMixturesToClose(*grid, options, 4);
  // Of a tolerance that leaves too little they are not moved as far, and kept, too.
  options.contour.tolerance = 0.03;
  test::expectTolerancesKept(makeChunks(*grid, options));
}

// In noise strips of two faces of a chunk lie so close that many would meet beside coarser chunks
// on one face only: neither in all own forms nor in all others.
TEST(ChunkPairs, NoneAreLeftBetweenStripsOfTwoFaces) {
  ChunkOptions options;
  options.chunkSize = 8;
  const Made made = makeChunks(*test::shapeOf(Shape::Noise, 0.12), options);
  std::size_t left = 0;
  for (const ChunkEntry& entry : made.index.chunks) {
    for (const ChunkLevelEntry& level : entry.levels) left += level.intersectionsLeft;
  }
  EXPECT_EQ(left, 0u);
  std::mt19937 random(7);
  std::vector<std::size_t> lods = randomLods(made, random);
  restrictLods(made.index, lods);
  EXPECT_EQ(check(assembleChunks(made.chunks, lods)).selfIntersectingPairs, 0u);
}

// Triangles of all chunks at a level, without transition strips.
std::size_t trianglesOf(const ChunkIndex& index, std::size_t level) {
  std::size_t count = 0;
  for (const ChunkEntry& entry : index.chunks) {
    count += entry.levels[level].interiorTriangles + entry.levels[level].regularTriangles;
  }
  return count;
}

// Curves on faces follow the tolerance as all else does: what is left of them costs few triangles.
TEST(ChunkFaces, CostFewTrianglesAtAnyLevel) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Terrain, 0.02);
  ChunkOptions options;
  const Made made = makeChunks(*grid, options);
  LodOptions lods;
  lods.levels = options.levels;
  const LodChain chain = buildLods(*grid, lods);
  ASSERT_EQ(chain.levels.size(), made.index.tolerances.size());
  const double most[] = {1.15, 1.25, 2.2, 7};
  for (std::size_t level = 0; level < chain.levels.size(); ++level) {
    EXPECT_LT(static_cast<double>(trianglesOf(made.index, level)),
              most[level] * static_cast<double>(chain.levels[level].mesh.triangleCount()))
        << level;
  }
}

// Vertices of curves take part in collapses with those beside them, at places of their own.
TEST(ChunkFaces, CostFewTrianglesInSmallChunks) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Torus, 0.02);
  ChunkOptions options;
  options.chunkSize = 16;
  options.levels = 1;
  const double whole = static_cast<double>(contour(*grid, options.contour).triangleCount());
  EXPECT_LT(static_cast<double>(trianglesOf(makeChunks(*grid, options).index, 0)), 1.3 * whole);
}

TEST(ChunkErrors, KeepTheTolerances) {
  for (const Shape kind : {Shape::Terrain, Shape::Bracket, Shape::Gyroid}) {
    ChunkOptions options;
    options.chunkSize = 16;
    test::expectTolerancesKept(makeChunks(*test::shapeOf(kind, 0.04), options));
  }
}

TEST(ChunkOptions, RefuseWhatCollapsesCannotKeep) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Sphere, 0.1);
  ChunkOptions plain, cells;
  plain.contour.simplify = false;
  cells.contour.minCell = 2;
  for (const ChunkOptions& options : {plain, cells}) {
    test::expectError(ErrorCode::InvalidArgument, "made by collapsing edges",
                      [&] { (void)makeChunks(*grid, options); });
  }
}

class ChunkMixtures : public ::testing::TestWithParam<std::tuple<Shape, double, int>> {};

TEST_P(ChunkMixtures, AreClosedWithTheTopologyOfTheUniformMesh) {
  const auto& [kind, voxelSize, chunkSize] = GetParam();
  ChunkOptions options;
  options.chunkSize = chunkSize;
  expectMixturesToClose(*test::shapeOf(kind, voxelSize), options, 20);
}

INSTANTIATE_TEST_SUITE_P(Shapes, ChunkMixtures,
                         ::testing::Combine(::testing::Values(Shape::Sphere, Shape::Terrain,
                                                              Shape::Gyroid, Shape::Bracket),
                                            ::testing::Values(0.04), ::testing::Values(16, 32)));
INSTANTIATE_TEST_SUITE_P(Noise, ChunkMixtures,
                         ::testing::Combine(::testing::Values(Shape::Noise),
                                            ::testing::Values(0.08), ::testing::Values(16, 32)));

// On one lattice for all chunks: what meets in a face has the same bits as before.
TEST(ChunkMixturesOnALattice, AreClosed) {
  ChunkOptions options;
  options.chunkSize = 32;
  options.compression = GlbCompression::Quantized;
  options.scale = 0.01;
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Bracket, 0.04);
  expectMixturesToClose(*grid, options, 5);
  const Made made = makeChunks(*grid, options);
  ASSERT_GT(made.index.step, 0);
  for (const Chunk& chunk : made.chunks) {
    for (const ChunkLevel& level : chunk.levels) {
      for (const Position& p : level.positions) {
        EXPECT_EQ(std::round(p.x / made.index.step) * made.index.step, p.x);
      }
    }
  }
}

Vec3 normalOf(const Mesh& mesh, const Triangle& t) {
  const Vec3 a(mesh.positions[t.vertices[0]]);
  return (Vec3(mesh.positions[t.vertices[1]]) - a).cross(Vec3(mesh.positions[t.vertices[2]]) - a);
}

// The share of the surface where a corner's normal is off its face's by more than 30 degrees: as
// with one normal a vertex on creases.
double smearedShare(const std::vector<Mesh>& meshes) {
  double smeared = 0, whole = 0;
  for (const Mesh& mesh : meshes) {
    for (const Triangle& t : mesh.triangles) {
      const Vec3 face = normalOf(mesh, t);
      whole += face.length();
      const bool isOff = std::any_of(t.vertices.begin(), t.vertices.end(), [&](VertexIndex v) {
        return Vec3(mesh.normals[v]).dot(face) < std::sqrt(0.75) * face.length();
      });
      smeared += isOff ? face.length() : 0;
    }
  }
  return smeared / whole;
}

// What chunks are drawn as at an LOD.
std::vector<Mesh> meshesAt(const Made& made, std::size_t level) {
  std::vector<Mesh> meshes;
  for (const Chunk& chunk : made.chunks) meshes.push_back(meshForMask(chunk, level, 0));
  return meshes;
}

// What they are drawn as with one half of them at that LOD, like a chessboard, and one at the next.
std::vector<Mesh> meshesBetween(const Made& made, std::size_t level) {
  std::vector<std::size_t> lods;
  for (const Chunk& chunk : made.chunks) {
    const int sum = chunk.index[0] + chunk.index[1] + chunk.index[2];
    lods.push_back(level + (sum % 2 == 0 ? 0 : 1));
  }
  std::vector<Mesh> meshes;
  for (std::size_t i = 0; i < lods.size(); ++i) {
    meshes.push_back(meshForMask(made.chunks[i], lods[i], transitionMask(made.index, i, lods)));
  }
  return meshes;
}

// Of edges between two chunks where the surface turns by less than 20 degrees, those whose ends do
// not have the same normals on both sides.
std::size_t countSeams(const std::vector<Mesh>& meshes, std::size_t& edges) {
  struct End {
    std::array<double, 3> place;
    Normal normal;
  };
  struct Side {
    std::size_t mesh;
    Vec3 face;
    Normal from, to;
  };
  std::map<std::array<std::array<double, 3>, 2>, Side> sides;
  std::size_t seams = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m];
    for (const Triangle& t : mesh.triangles) {
      const Vec3 face = normalOf(mesh, t).unitOrX();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto endOf = [&](VertexIndex v) {
          const Position& p = mesh.positions[v];
          return End{{p.x, p.y, p.z}, mesh.normals[v]};
        };
        const End a = endOf(t.vertices[i]), b = endOf(t.vertices[(i + 1) % 3]);
        const auto other = sides.find({b.place, a.place});
        if (other == sides.end()) {
          sides.emplace(std::array{a.place, b.place}, Side{m, face, a.normal, b.normal});
        } else if (other->second.mesh != m && other->second.face.dot(face) > 0.94) {
          ++edges;
          seams += other->second.from == b.normal && other->second.to == a.normal ? 0 : 1;
        }
      }
    }
  }
  return seams;
}

TEST(ChunkNormals, AreSplitAtCreasesAndTheSameOnBothSidesOfAFace) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Bracket, 0.04);
  ChunkOptions options;
  options.chunkSize = 32;
  const Made made = makeChunks(*grid, options);
  for (std::size_t level = 0; level < 3; ++level) {
    std::size_t edges = 0;
    EXPECT_EQ(countSeams(meshesAt(made, level), edges), 0U) << level;
    EXPECT_GT(edges, 30U) << level;
    // A triangle that is drawn beside both LODs has one normal for both.
    edges = 0;
    EXPECT_LE(countSeams(meshesBetween(made, level), edges), edges / 50) << level;
    EXPECT_GT(edges, 20U) << level;
  }
  const double split = smearedShare(meshesAt(made, 0));
  options.creaseAngle = 180;
  const double unsplit = smearedShare(meshesAt(makeChunks(*grid, options), 0));
  EXPECT_GT(unsplit, 0.5);
  EXPECT_LT(split, 0.03);  // of the whole LOD: 0.011
}

TEST(ChunkMixturesFarAway, AreWhatTheyAreAtTheOrigin) {
  const auto trianglesOf = [](const Made& made) {
    double sum = 0;
    for (const Chunk& chunk : made.chunks) {
      for (const ChunkLevel& level : chunk.levels) {
        sum += static_cast<double>(level.interior.size());
        for (const auto& strip : level.regular) sum += static_cast<double>(strip.size());
      }
    }
    return sum;
  };
  double farTriangles = 0, nearTriangles = 0;
  for (const double voxelSize : {0.025, 0.0275, 0.03, 0.0325, 0.035, 0.04}) {
    const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Bracket, voxelSize);
    ChunkOptions options;
    options.chunkSize = 32;
    const Made near = makeChunks(*grid, options);
    EXPECT_EQ(near.index.origin, Position(0, 0, 0));
    // A million voxels away, where floats hold no place to a thousandth of a voxel.
    grid->setTransform(grid->transform().copy());
    grid->transform().postTranslate(openvdb::Vec3d(4e4, 0, 0));
    const Made far = makeChunks(*grid, options);
    EXPECT_NEAR(far.index.origin.x, 4e4, 10);
    std::mt19937 random(3);
    std::vector<std::size_t> lods = randomLods(near, random);
    restrictLods(near.index, lods);
    const Mesh nearby = assembleChunks(near.chunks, lods), away = assembleChunks(far.chunks, lods);
    const CheckReport report = check(away);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.selfIntersectingPairs, 0u);
    EXPECT_EQ(report.eulerCharacteristic, check(nearby).eulerCharacteristic);
    farTriangles += trianglesOf(far);
    nearTriangles += trianglesOf(near);
  }
  // Rounding alone parts them: where a cut vertex is joined to its neighbour in one and not in the
  // other, collapses around it come in another order. Counts of all LODs together stay near.
  EXPECT_NEAR(farTriangles, nearTriangles, 0.05 * nearTriangles);
}

// Parts of the surface are reduced at the same time, and chunks come in the same order all the
// same.
TEST(ChunkThreads, GiveTheSameBytes) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Bracket, 0.025);
  ChunkOptions options;
  options.levels = 2;
  const auto make = [&](int threads, double& lastFraction) {
    options.contour.threads = threads;
    options.contour.progress = [&](std::string_view, double fraction) {
      EXPECT_GE(fraction, lastFraction);
      lastFraction = fraction;
      return true;
    };
    std::vector<Chunk> chunks;
    (void)buildChunks(*grid, options, [&](const ChunkIndex&, Chunk&& chunk) {
      chunks.push_back(std::move(chunk));
    });
    return chunks;
  };
  double alone = 0, together = 0;
  const std::vector<Chunk> one = make(1, alone), three = make(3, together);
  EXPECT_EQ(alone, 1);
  EXPECT_EQ(together, 1);
  ASSERT_EQ(one.size(), three.size());
  EXPECT_LT(one.front().index[0], 0);
  EXPECT_GE(one.back().index[0], 0) << "all are in one region";
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].index, three[i].index);
    for (std::size_t level = 0; level < one[i].levels.size(); ++level) {
      const ChunkLevel &a = one[i].levels[level], &b = three[i].levels[level];
      EXPECT_EQ(a.positions, b.positions);
      EXPECT_EQ(a.normals, b.normals);
      EXPECT_EQ(a.interior, b.interior);
      EXPECT_EQ(a.regular, b.regular);
      EXPECT_EQ(a.transition, b.transition);
      EXPECT_EQ(a.maxErrorVoxels, b.maxErrorVoxels);
    }
  }
}

TEST(ChunkMasks, OccurAll) {
  ChunkOptions options;
  options.chunkSize = 8;
  options.levels = 3;
  const std::set<unsigned> masks =
      expectMixturesToClose(*test::shapeOf(Shape::Gyroid, 0.04), options, 12);
  EXPECT_EQ(masks.size(), 64u);
}

}  // namespace
}  // namespace tufa
