// What a program may hand to the library by mistake: InvalidArgument, not a crash or endless work.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <tufa/contour.h>
#include <tufa/fit.h>
#include <tufa/float_mesh.h>
#include <tufa/import.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <tufa/rays.h>
#include <tufa/shapes.h>
#include <tufa/voxelize.h>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using test::expectError;

class Misuse : public ::testing::Test {
 protected:
  openvdb::FloatGrid::Ptr ball = [] {
    ShapeOptions options;
    options.voxelSize = 0.2;
    return makeShape(Shape::Sphere, options);
  }();
  Mesh mesh = contour(*ball);
  ChunkSink sink = [](const ChunkIndex&, Chunk&&) {};

  template <class Work>
  static void expectRefused(const std::string& part, Work&& work) {
    expectError(ErrorCode::InvalidArgument, part, work);
  }

  /// For every call that takes these options.
  void expectRefusedByAll(const std::string& part, const ContourOptions& options) {
    LodOptions lods;
    ChunkOptions chunks;
    lods.contour = chunks.contour = options;
    expectRefused(part, [&] { (void)contour(*ball, options); });
    expectRefused(part, [&] { (void)buildLods(*ball, lods); });
    expectRefused(part, [&] { (void)buildChunks(*ball, chunks, sink); });
  }
};

TEST_F(Misuse, OfProgressThatIsNone) {
  bool (*pointer)(std::string_view, double) = nullptr;
  const std::function<bool(std::string_view, double)> function;
  for (const Progress& none : {Progress(pointer), Progress(function), Progress(nullptr)}) {
    EXPECT_FALSE(none);
    ContourOptions options;
    options.progress = none;
    EXPECT_GT(contour(*ball, options).triangleCount(), 0u);
  }
}

TEST_F(Misuse, OfMeshesWhoseIndicesPointNowhere) {
  Mesh broken = mesh;
  broken.triangles.at(0).vertices[1] = 1U << 30;
  Mesh few = mesh;
  few.normals.resize(1);
  const auto refused = [](const std::string& part, const Mesh& bad) {
    LodChain chain;
    chain.levels.emplace_back().mesh = bad;
    for (const MeshFormat format : {MeshFormat::Glb, MeshFormat::Usda}) {
      std::ostringstream stream;
      expectRefused(part, [&] { writeLods(chain, stream, format); });
    }
    expectRefused(part, [&] { (void)toFloat(bad); });
  };
  refused("a face names vertex", broken);
  refused("1 normals", few);
}

TEST_F(Misuse, OfChunksWhoseIndicesPointNowhere) {
  ChunkOptions options;
  options.chunkSize = 16;
  Chunk chunk;
  const ChunkIndex index = buildChunks(
      *ball, options, [&](const ChunkIndex&, Chunk&& each) { chunk = std::move(each); });
  const auto refused = [&](const char* part, const auto& damage) {
    Chunk bad = chunk;
    damage(bad.levels[0]);
    for (const ChunkFormat format : {ChunkFormat::Glb, ChunkFormat::Ply}) {
      expectRefused(part, [&] { (void)writeChunk(index, bad, ".", format); });
    }
    expectRefused(part, [&] { (void)meshForMask(bad, 0, 0); });
  };
  refused("a vertex that is not there",
          [](ChunkLevel& level) { level.interior.emplace_back(0, 1, 65538); });
  refused("normals differ", [](ChunkLevel& level) { level.normals.clear(); });
  refused("not finite", [](ChunkLevel& level) { level.positions[0].x = std::nan(""); });
  refused("values of an attribute", [](ChunkLevel& level) {
    level.attributes = {{"a", 2, AttributeRole::Value, {1}}};
  });
}

TEST_F(Misuse, OfThreads) {
  for (const int threads : {-1, 4097, 1000000000, std::numeric_limits<int>::max()}) {
    ContourOptions options;
    options.threads = threads;
    expectRefusedByAll("threads is", options);
    ShapeOptions shape;
    shape.threads = threads;
    expectRefused("threads is", [&] { (void)makeShape(Shape::Sphere, shape); });
    VoxelizeOptions voxels{0.1, 3, threads, {}};
    expectRefused("threads is", [&] { (void)voxelize(mesh, voxels); });
  }
}

TEST_F(Misuse, OfLevelsOfLeaves) {
  for (const int level : {-1, 32, 40, std::numeric_limits<int>::min()}) {
    const std::string part = "level " + std::to_string(level);
    expectRefused(part, [&] { (void)isRestricted({{Coord(0), level}}); });
  }
  EXPECT_TRUE(isRestricted({{Coord(0), 31}}));
  constexpr std::int32_t kGreatest = std::numeric_limits<std::int32_t>::max();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  EXPECT_TRUE(isRestricted({{Coord(kGreatest), 0}, {Coord(kLeast), 0}}));
}

TEST_F(Misuse, OfTheSink) {
  expectRefused("no sink", [&] { (void)buildChunks(*ball, {}, nullptr); });
}

TEST_F(Misuse, OfNothing) {
  expectRefused("no grid", [] { (void)makeRaySurface(std::shared_ptr<openvdb::GridBase>()); });
  expectRefused("no field", [] { (void)makeRaySurface(std::shared_ptr<implicit::Field>()); });
  const test::ScratchFolder folder;
  expectRefused("null", [&] { writeGrids({ball, nullptr}, folder / "g.vdb"); });
  expectRefused("nothing that writes",
                [&] { writeFile(std::function<void(std::ostream&)>(), folder / "f.txt"); });
  ImageSlices image;
  image.size = {2, 2, 2};
  expectRefused("no function that reads", [&] { (void)importSlices(image); });
  EXPECT_EQ(folder.fileCount(), 0);
}

// Writers of some formats aborted, or wrote files that cannot be read.
TEST_F(Misuse, OfFacesAndPositions) {
  const test::ScratchFolder folder;
  const auto expectRefusedByWriters = [&](const std::string& part, const Mesh& wrong) {
    for (const char* name : {"m.ply", "m.obj", "m.stl", "m.off", "m.glb", "m.usda"}) {
      for (const GlbCompression compression : {GlbCompression::None, GlbCompression::Meshopt}) {
        WriteOptions options;
        options.compression = compression;
        expectRefused(part, [&] { write(wrong, folder / name, options); });
      }
    }
    EXPECT_EQ(folder.fileCount(), 0);
  };
  Mesh wrong = mesh;
  wrong.triangles.emplace_back(0, 1, 4000000000U);
  expectRefusedByWriters("vertex 4000000000 of", wrong);
  expectRefused("vertex 4000000000 of", [&] { (void)fitBlobs(wrong, {}); });
  VoxelizeOptions voxels;
  voxels.voxelSize = 0.1;
  expectRefused("vertex 4000000000 of", [&] { (void)voxelize(wrong, voxels); });
  wrong = mesh;
  wrong.positions[3].y = std::numeric_limits<double>::quiet_NaN();
  expectRefusedByWriters("vertex 3 of the mesh is not finite", wrong);
}

TEST_F(Misuse, OfCameras) {
  const LodChain chain = buildLods(*ball);
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [&](const std::string& part, const Camera& camera, double pixels) {
    expectRefused(part, [&] { (void)selectLod(chain, camera, pixels); });
    expectRefused(part, [&] { (void)selectLods(ChunkIndex(), camera, pixels); });
  };
  refused("eye", {.eye = {infinity, 0, 0}}, 1);
  for (const double angle : {0.0, -1.0, 3.2, std::nan("")}) {
    refused("angle of view", {.verticalAngle = angle}, 1);
  }
  refused("height", {.screenHeight = 0}, 1);
  for (const double pixels : {0.0, -1.0, infinity, std::nan("")}) refused("pixels", {}, pixels);
  EXPECT_EQ(selectLod(chain, Camera()), 0u) << "the eye is in the ball";
}

TEST_F(Misuse, OfNumbersOfLevels) {
  LodOptions options;
  for (const int levels : {0, -1, 101, 1000000000}) {
    options.levels = levels;
    expectRefused("1 to 100 levels", [&] { (void)buildLods(*ball, options); });
  }
  options.levels = 100;
  EXPECT_FALSE(buildLods(*ball, options).levels.empty());
  options.tolerances.assign(101, 1);
  expectRefused("100 levels at most", [&] { (void)buildLods(*ball, options); });
}

TEST_F(Misuse, OfHalfWidths) {
  for (const double width : {1001.0, 1e9, 0.5, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    ShapeOptions shape;
    shape.halfWidth = width;
    expectRefused("half width", [&] { (void)makeShape(Shape::Sphere, shape); });
    expectRefused("half width", [&] { (void)voxelize(mesh, {0.1, width, 0, {}}); });
  }
}

TEST_F(Misuse, OfEnums) {
  for (const int number : {-1, 17, 1000000000}) {
    ContourOptions options;
    options.inside = static_cast<Inside>(number);
    expectRefusedByAll("has no meaning", options);
    options = {};
    options.ambiguity = static_cast<Ambiguity>(number);
    expectRefusedByAll("has no meaning", options);
    options = {};
    options.normals = static_cast<Normals>(number);
    expectRefusedByAll("has no meaning", options);
    options = {};
    options.nonFinite = static_cast<NonFinite>(number);
    expectRefusedByAll("has no meaning", options);

    const auto shape = static_cast<Shape>(number);
    expectRefused("has no meaning", [&] { (void)makeShape(shape); });
    expectRefused("has no meaning", [&] { (void)shapeDistance(shape, {0, 0, 0}); });
    expectRefused("has no meaning", [&] { (void)shapeCreasePoints(shape, 0.1); });

    const test::ScratchFolder folder;
    const LodChain chain = buildLods(*ball, {});
    LodWriteOptions writing;
    writing.up = static_cast<UpAxis>(number);
    expectRefused("has no meaning", [&] { writeLods(chain, folder / "m.glb", writing); });
    writing = {};
    writing.compression = static_cast<GlbCompression>(number);
    expectRefused("has no meaning", [&] { writeLods(chain, folder / "m.glb", writing); });
    expectRefused("has no meaning", [&] {
      (void)writeChunk({}, {}, (folder / "").string(), static_cast<ChunkFormat>(number));
    });
    EXPECT_EQ(folder.fileCount(), 0);
  }
}

TEST_F(Misuse, OfFactorsAndTolerances) {
  for (const double factor : {1e300, 1e7, 1.0, 0.0, -4.0, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN()}) {
    LodOptions lods;
    lods.factor = factor;
    expectRefused("factor", [&] { (void)buildLods(*ball, lods); });
    ChunkOptions chunks;
    chunks.factor = factor;
    expectRefused("factor", [&] { (void)buildChunks(*ball, chunks, sink); });
  }
  LodOptions lods;
  lods.tolerances = {0.1, 1e300};
  expectRefused("tolerance must be from 0 to 1e+06", [&] { (void)buildLods(*ball, lods); });
  ChunkOptions chunks;
  chunks.levels = 16;
  chunks.factor = 1e6;
  EXPECT_EQ(buildChunks(*ball, chunks, sink).tolerances.back(), 1e6);
}

TEST_F(Misuse, OfAToleranceGrid) {
  const auto frustum = openvdb::FloatGrid::create(1);
  const openvdb::BBoxd box(openvdb::Vec3d(0), openvdb::Vec3d(100));
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(box, 0.5, 10, 0.1));
  ContourOptions options;
  options.toleranceGrid = frustum;
  expectRefusedByAll("is a frustum", options);
}

}  // namespace
}  // namespace tufa
