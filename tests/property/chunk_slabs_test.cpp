// Chunks of volumes whose first LOD is made in slabs.

#include <gtest/gtest.h>

#include <tufa/check.h>
#include <tufa/chunks.h>
#include <tufa/grid_files.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <ostream>
#include <random>

#include "support/chunk_mixtures.h"
#include "support/expect_error.h"
#include "support/scratch_folder.h"
#include "support/shape.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

using test::Made;

// Slabs of the report's call, those that were made again with another one included.
std::size_t slabsOf(const ContourReport& report) {
  return static_cast<std::size_t>(
      std::count_if(report.stages.begin(), report.stages.end(),
                    [](const StageTime& time) { return time.stage.starts_with("slab "); }));
}

std::size_t trianglesOf(const Made& made, std::size_t level) {
  std::size_t count = 0;
  for (const ChunkEntry& entry : made.index.chunks) {
    count += entry.levels[level].interiorTriangles + entry.levels[level].regularTriangles;
  }
  return count;
}

ChunkOptions inSlabs(int chunkSize) {
  ChunkOptions options;
  options.chunkSize = chunkSize;
  options.slabVoxels = 1;
  return options;
}

// White noise in a bar of 144 x 12 x 12 voxels: pairs and repairs everywhere.
openvdb::FloatGrid::Ptr noisyBar() {
  const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(1);
  auto to = grid->getAccessor();
  std::mt19937 random(5);
  const openvdb::CoordBBox box(openvdb::Coord(-70, 0, 0), openvdb::Coord(73, 11, 11));
  for (auto at = box.begin(); at; ++at) {
    to.setValueOn(*at, static_cast<float>(random()) / 2147483648.0F - 1);
  }
  return grid;
}

struct Case {
  const char* name;
  openvdb::FloatGrid::Ptr (*make)();
  int chunkSize;
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class ChunkSlabs : public ::testing::TestWithParam<Case> {};

TEST_P(ChunkSlabs, MeetInMixturesThatAreClosed) {
  (void)test::expectMixturesToClose(*GetParam().make(), inSlabs(GetParam().chunkSize), 6);
}

TEST_P(ChunkSlabs, KeepTheTolerancesWithAsManyTriangles) {
  const openvdb::FloatGrid::Ptr grid = GetParam().make();
  ChunkOptions options = inSlabs(GetParam().chunkSize);
  ContourReport report, wholeReport;
  const Made made = test::makeChunks(*grid, options, &report);
  EXPECT_GE(slabsOf(report), 2U);
  test::expectTolerancesKept(made);
  options.slabVoxels = ChunkOptions().slabVoxels;
  const Made whole = test::makeChunks(*grid, options, &wholeReport);
  EXPECT_EQ(slabsOf(wholeReport), 0U);
  ASSERT_EQ(made.index.chunks.size(), whole.index.chunks.size());
  EXPECT_EQ(report.surfaceCells, wholeReport.surfaceCells);
  EXPECT_EQ(report.openEdges, wholeReport.openEdges);
  EXPECT_EQ(report.activeVoxels, wholeReport.activeVoxels);
  EXPECT_EQ(report.faceFlips, wholeReport.faceFlips);
  // A part of each later tolerance is the first LOD's: a third more triangles at the second one.
  const double most[] = {1.1, 1.6, 1.3, 1.3};
  for (std::size_t level = 0; level < 4; ++level) {
    EXPECT_LT(static_cast<double>(trianglesOf(made, level)),
              most[level] * static_cast<double>(trianglesOf(whole, level)) + 50)
        << level;
  }
}

template <Shape shape>
openvdb::FloatGrid::Ptr fine() {
  return test::shapeOf(shape, 0.015);
}

INSTANTIATE_TEST_SUITE_P(Volumes, ChunkSlabs,
                         ::testing::Values(Case{"sphere", fine<Shape::Sphere>, 32},
                                           Case{"terrain", fine<Shape::Terrain>, 16},
                                           Case{"gyroid", fine<Shape::Gyroid>, 64},
                                           Case{"bracket", fine<Shape::Bracket>, 32},
                                           Case{"noise", noisyBar, 16}),
                         [](const auto& test) { return test.param.name; });

void expectSameChunks(const Made& one, const Made& other) {
  EXPECT_EQ(one.index.surface, other.index.surface);
  EXPECT_EQ(one.index.origin, other.index.origin);
  EXPECT_EQ(one.index.grid, other.index.grid);
  ASSERT_EQ(one.chunks.size(), other.chunks.size());
  for (std::size_t i = 0; i < one.chunks.size(); ++i) {
    ASSERT_EQ(one.chunks[i].levels.size(), other.chunks[i].levels.size());
    for (std::size_t level = 0; level < one.chunks[i].levels.size(); ++level) {
      const ChunkLevel &a = one.chunks[i].levels[level], &b = other.chunks[i].levels[level];
      EXPECT_EQ(a.positions, b.positions);
      EXPECT_EQ(a.normals, b.normals);
      EXPECT_EQ(a.transition, b.transition);
      EXPECT_EQ(a.maxErrorVoxels, b.maxErrorVoxels);
    }
  }
}

TEST(ChunkSlabThreads, GiveTheSameBytes) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Terrain, 0.015);
  ChunkOptions options = inSlabs(32);
  options.contour.threads = 1;
  const Made one = test::makeChunks(*grid, options);
  options.contour.threads = 3;
  double lastFraction = 0;
  options.contour.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, lastFraction);
    lastFraction = fraction;
    return true;
  };
  const Made three = test::makeChunks(*grid, options);
  EXPECT_EQ(lastFraction, 1);
  expectSameChunks(one, three);
}

// Compares chunks of a grid that stays in its file with those of the same grid in memory.
void expectSameFromFile(const openvdb::FloatGrid::Ptr& grid, const ChunkOptions& options) {
  const test::ScratchFolder folder;
  writeGrids({grid}, folder / "m.vdb");
  GridFile file(folder / "m.vdb");
  ASSERT_FALSE(file.isLoaded());
  ContourReport fromMemory, fromFile;
  expectSameChunks(test::makeChunks(*readGrid(folder / "m.vdb"), options, &fromMemory),
                   test::makeChunks(file, options, &fromFile));
  EXPECT_FALSE(file.isLoaded());
  EXPECT_EQ(slabsOf(fromFile), slabsOf(fromMemory));
  EXPECT_EQ(fromFile.isovalue, fromMemory.isovalue);
  EXPECT_EQ(fromFile.distanceField, fromMemory.distanceField);
  EXPECT_EQ(fromFile.activeVoxels, fromMemory.activeVoxels);
  EXPECT_EQ(fromFile.nonFiniteValues, fromMemory.nonFiniteValues);
  EXPECT_EQ(fromFile.surfaceCells, fromMemory.surfaceCells);
  EXPECT_EQ(fromFile.creaseCells, fromMemory.creaseCells);
  EXPECT_EQ(fromFile.faceFlips, fromMemory.faceFlips);
  EXPECT_EQ(fromFile.openEdges, fromMemory.openEdges);
}

TEST_P(ChunkSlabs, HaveTheSameBytesFromAFile) {
  const openvdb::FloatGrid::Ptr grid = GetParam().make();
  expectSameFromFile(grid, inSlabs(GetParam().chunkSize));
}

// Of one slab, and with an isovalue half way between the least and the greatest value, and values
// that are not finite.
TEST(ChunkFiles, OfSmallVolumesHaveTheSameBytes) {
  ChunkOptions options;
  options.chunkSize = 16;
  options.contour.nonFinite = NonFinite::Outside;
  const openvdb::FloatGrid::Ptr noise = noisyBar();
  noise->tree().setValue(openvdb::Coord(3), std::numeric_limits<float>::infinity());
  noise->tree().setValue(openvdb::Coord(-30, 4, 4), std::numeric_limits<float>::quiet_NaN());
  expectSameFromFile(noise, options);
  expectSameFromFile(test::shapeOf(Shape::Bracket, 0.05), options);
  options.slabVoxels = 1;
  expectSameFromFile(noise, options);
}

TEST(ChunkFiles, ThatAreCutWhileTheyAreReadAreRefused) {
  const test::ScratchFolder folder;
  writeGrids({test::shapeOf(Shape::Bracket, 0.015)}, folder / "m.vdb");
  GridFile file(folder / "m.vdb");
  std::filesystem::resize_file(folder / "m.vdb", std::filesystem::file_size(folder / "m.vdb") / 2);
  test::expectError(ErrorCode::UnreadableFile, "m.vdb: the file ends inside grid \"bracket\"",
                    [&] { (void)test::makeChunks(file, inSlabs(32)); });
}

TEST(ChunkSlabsThatAreCancelled, EndAtOnce) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Terrain, 0.015);
  ChunkOptions options = inSlabs(32);
  for (const double most : {0.02, 0.3, 0.6, 0.9}) {
    bool isCancelled = false;
    options.contour.progress = [&](std::string_view, double fraction) {
      EXPECT_FALSE(isCancelled);
      isCancelled = fraction > most;
      return !isCancelled;
    };
    test::expectError(ErrorCode::Cancelled, "cancelled",
                      [&] { (void)test::makeChunks(*grid, options); });
    EXPECT_TRUE(isCancelled);
  }
}

// The same solid, its axes in each cyclic order, far from the origin, where positions have more
// digits than floats.
TEST(ChunkSlabsOfAnyAxis, MeetFarAway) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Bracket, 0.015);
  for (int axis = 0; axis < 3; ++axis) {
    const openvdb::FloatGrid::Ptr turned = openvdb::FloatGrid::create(grid->background());
    turned->setGridClass(grid->getGridClass());
    turned->setTransform(grid->transform().copy());
    turned->transform().postTranslate(openvdb::Vec3d(4e4, 0, 0));
    auto to = turned->getAccessor();
    for (auto value = grid->cbeginValueAll(); value; ++value) {
      if (!value.isVoxelValue()) continue;
      const openvdb::Coord at = value.getCoord();
      const openvdb::Coord now(at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]);
      value.isValueOn() ? to.setValueOn(now, *value) : to.setValueOff(now, *value);
    }
    ContourReport report;
    const Made made = test::makeChunks(*turned, inSlabs(32), &report);
    EXPECT_GE(slabsOf(report), 2U) << axis;
    std::mt19937 random(3);
    std::vector<std::size_t> lods = test::randomLods(made, random);
    restrictLods(made.index, lods);
    const CheckReport found = check(assembleChunks(made.chunks, lods));
    const CheckReport uniform = check(test::uniformMesh(*turned));
    EXPECT_TRUE(found.watertight()) << axis;
    EXPECT_EQ(found.eulerCharacteristic, uniform.eulerCharacteristic) << axis;
    EXPECT_EQ(found.selfIntersectingPairs, 0U) << axis;
  }
}

TEST(ChunkSlabsOfScaledTolerances, AreNone) {
  const openvdb::FloatGrid::Ptr grid = test::shapeOf(Shape::Terrain, 0.015);
  ChunkOptions options = inSlabs(32);
  options.contour.toleranceGrid = grid->deepCopy();
  ContourReport report;
  (void)test::makeChunks(*grid, options, &report);
  EXPECT_EQ(slabsOf(report), 0U);
}

}  // namespace
}  // namespace tufa
