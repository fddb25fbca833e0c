#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <tufa/io.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <utility>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using test::expectError;
using test::readBytes;
using test::ScratchFolder;
using test::writeBytes;

openvdb::FloatGrid::Ptr makeBall(const std::string& name) {
  ShapeOptions options;
  options.voxelSize = 0.1;
  auto grid = makeShape(Shape::Sphere, options);
  grid->setName(name);
  return grid;
}

template <class GridT>
typename GridT::Ptr makeSingle(const std::string& name, const typename GridT::ValueType& value) {
  openvdb::initialize();
  auto grid = GridT::create();
  grid->setName(name);
  grid->tree().setValueOn(openvdb::Coord(0), value);
  return grid;
}

TEST(GridFiles, KeepTheGrid) {
  const ScratchFolder folder;
  const auto grid = makeBall("ball");
  writeGrids({grid}, folder / "m.vdb");
  EXPECT_EQ(folder.fileCount(), 1);
  const auto back = openvdb::gridPtrCast<openvdb::FloatGrid>(readGrid(folder / "m.vdb"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->activeVoxelCount(), grid->activeVoxelCount());
  EXPECT_EQ(back->background(), grid->background());
  EXPECT_EQ(back->transform(), grid->transform());
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    ASSERT_EQ(back->tree().getValue(value.getCoord()), *value);
  }
}

TEST(GridFiles, PreferTheFirstLevelSet) {
  const ScratchFolder folder;
  const auto fog = makeSingle<openvdb::FloatGrid>("fog", 1.0f);
  const auto vectors = makeSingle<openvdb::Vec3SGrid>("v", openvdb::Vec3f(1));
  writeGrids({vectors, fog, makeBall("a"), makeBall("b")}, folder / "m.vdb");
  EXPECT_EQ(readGrid(folder / "m.vdb")->getName(), "a");
  EXPECT_EQ(readGrid(folder / "m.vdb", "fog")->getName(), "fog");
  EXPECT_EQ(readGrid(folder / "m.vdb", "v")->getName(), "v");
  expectError(ErrorCode::UnknownGrid, R"("v", "fog", "a", "b")",
              [&] { (void)readGrid(folder / "m.vdb", "c"); });
  writeGrids({vectors, fog}, folder / "m.vdb");
  EXPECT_EQ(readGrid(folder / "m.vdb")->getName(), "fog");
}

TEST(GridFiles, TellGridsOfOneNameApart) {
  const ScratchFolder folder;
  auto second = makeBall("ball");
  second->tree().setValueOn(openvdb::Coord(500), 0.0f);
  writeGrids({makeBall("ball"), second}, folder / "m.vdb");
  const auto infos = describeGrids(folder / "m.vdb");
  ASSERT_EQ(infos.size(), 2u);
  EXPECT_EQ(infos[0].name, "ball[0]");
  EXPECT_EQ(infos[1].activeVoxels, infos[0].activeVoxels + 1);
  EXPECT_EQ(readGrid(folder / "m.vdb", "ball[1]")->activeVoxelCount(), infos[1].activeVoxels);
}

TEST(GridFiles, TellWhatMakersNote) {
  const ScratchFolder folder;
  const auto grid = makeBall("ball");
  grid->setCreator("a test");
  grid->insertMeta("frame", openvdb::Int32Metadata(12));
  writeGrids({grid}, folder / "m.vdb");
  using Metadata = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(describeGrids(folder / "m.vdb").at(0).metadata,
            (Metadata{{"creator", "a test"}, {"frame", "12"}}));
  EXPECT_EQ(describeGrid(*grid).metadata, describeGrids(folder / "m.vdb").at(0).metadata);
}

TEST(GridFile, IsChosenAsAGridThatIsRead) {
  const ScratchFolder folder;
  const auto fog = makeSingle<openvdb::FloatGrid>("fog", 1.0f);
  const auto vectors = makeSingle<openvdb::Vec3SGrid>("v", openvdb::Vec3f(1));
  writeGrids({vectors, fog, makeBall("a"), makeBall("b")}, folder / "m.vdb");
  const GridFile file(folder / "m.vdb");
  EXPECT_FALSE(file.isLoaded());
  EXPECT_EQ(file.outline()->getName(), "a");
  EXPECT_EQ(file.outline()->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(file.outline()->transform(), makeBall("a")->transform());
  EXPECT_EQ(file.outline()->activeVoxelCount(), makeBall("a")->activeVoxelCount());
  EXPECT_EQ(GridFile(folder / "m.vdb", "b").outline()->getName(), "b");
  expectError(ErrorCode::UnknownGrid, R"("v", "fog", "a", "b")",
              [&] { (void)GridFile(folder / "m.vdb", "c"); });
  expectError(ErrorCode::UnreadableFile, "No such file",
              [&] { (void)GridFile(folder / "none.vdb"); });
}

TEST(GridFile, WithoutLeavesToReadByAndByIsLoaded) {
  const ScratchFolder folder;
  const auto ball = makeBall("ball");
  const auto shared = ball->copy();  // has the ball's tree
  shared->setName("shared");
  writeGrids({ball, shared, makeSingle<openvdb::Vec3SGrid>("v", openvdb::Vec3f(1))},
             folder / "m.vdb");
  EXPECT_TRUE(GridFile(folder / "m.vdb", "shared").isLoaded());
  EXPECT_TRUE(GridFile(folder / "m.vdb", "v").isLoaded());
  std::ostringstream stream;
  writeGrids({ball}, stream);
  const std::string bytes = stream.str();
  GridFile inMemory(FileBytes{bytes, "bytes"});
  EXPECT_TRUE(inMemory.isLoaded());
  EXPECT_EQ(inMemory.load(), inMemory.outline());
  EXPECT_EQ(inMemory.outline()->activeVoxelCount(), ball->activeVoxelCount());
}

TEST(GridFile, OfBytesIsReadFromThem) {
  const ScratchFolder folder;
  writeGrids({makeBall("ball")}, folder / "m.vdb");
  const std::string bytes = readBytes(folder / "m.vdb");
  GridFile file(FileBytes{bytes, "bytes"});
  GridFile moved = std::move(file);
  EXPECT_FALSE(moved.isLoaded());
  EXPECT_EQ(moved.load()->activeVoxelCount(), makeBall("ball")->activeVoxelCount());
}

// OpenVDB goes on with a warning, on standard output where it was built with log4cplus.
TEST(GridFiles, OfUnknownVersionsAreRefused) {
  const ScratchFolder folder;
  writeGrids({makeBall("ball")}, folder / "m.vdb");
  const std::string bytes = readBytes(folder / "m.vdb");
  constexpr std::size_t kVersion = 8;
  const auto expectRefusal = [&](std::uint32_t version, const std::string& why) {
    std::string other = bytes;
    std::memcpy(other.data() + kVersion, &version, sizeof version);
    writeBytes(folder / "n.vdb", other);
    expectError(ErrorCode::UnreadableFile, "version " + std::to_string(version) + ", " + why,
                [&] { (void)readGrid(folder / "n.vdb"); });
  };
  expectRefusal(openvdb::OPENVDB_FILE_VERSION + 1, "newer than");
  expectRefusal(0xFFFFFFFF, "newer than");
  expectRefusal(100, "older than OpenVDB 1.0");
}

// The other functions refuse it.
TEST(GridFiles, WithoutAFiniteBackgroundCannotBeMeshed) {
  for (const float background :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const auto grid = openvdb::FloatGrid::create(background);
    grid->tree().setValueOn(openvdb::Coord(0), 1.0f);
    const GridInfo info = describeGrid(*grid);
    EXPECT_FALSE(info.meshable);
    EXPECT_NE(info.whyNot.find("background is not a finite number"), std::string::npos);
  }
}

TEST(GridFiles, ShareTrees) {
  const ScratchFolder folder;
  const auto grid = makeBall("ball");
  auto twin = grid->copy();
  twin->setName("twin");
  writeGrids({grid, twin}, folder / "m.vdb");
  EXPECT_EQ(readGrid(folder / "m.vdb", "twin")->activeVoxelCount(), grid->activeVoxelCount());
  EXPECT_EQ(describeGrids(folder / "m.vdb").at(1).activeVoxels, grid->activeVoxelCount());
}

TEST(GridFiles, AreReadAsStreamsToo) {
  const ScratchFolder folder;
  std::ofstream stream(folder / "m.vdb", std::ios::binary);
  openvdb::io::Stream(stream).write(openvdb::GridCPtrVec{makeBall("ball"), makeBall("other")});
  stream.close();
  EXPECT_EQ(readGrid(folder / "m.vdb", "other")->activeVoxelCount(),
            makeBall("ball")->activeVoxelCount());
}

TEST(GridFiles, SayWhyAGridCannotBeMeshed) {
  const ScratchFolder folder;
  auto frustum = makeBall("frustum");
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 1.0));
  auto empty = openvdb::FloatGrid::create();
  empty->setName("empty");
  writeGrids({frustum, makeSingle<openvdb::Int32Grid>("numbers", 1), empty}, folder / "m.vdb");
  const auto infos = describeGrids(folder / "m.vdb");
  ASSERT_EQ(infos.size(), 3u);
  for (const GridInfo& info : infos) EXPECT_FALSE(info.meshable) << info.name;
  EXPECT_NE(infos[0].whyNot.find("frustum"), std::string::npos);
  EXPECT_NE(infos[1].whyNot.find("int32"), std::string::npos);
  EXPECT_NE(infos[2].whyNot.find("no active voxels"), std::string::npos);
  writeGrids({frustum}, folder / "m.vdb");
  expectError(ErrorCode::UnsupportedGrid, "frustum", [&] { (void)readGrid(folder / "m.vdb"); });
}

TEST(GridFiles, DescribeValues) {
  auto grid = makeSingle<openvdb::DoubleGrid>("d", 2.5);
  grid->tree().setValueOn(openvdb::Coord(1), std::numeric_limits<double>::quiet_NaN());
  grid->tree().addTile(1, openvdb::Coord(64), -7.0, true);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  const GridInfo info = describeGrid(*grid);
  EXPECT_EQ(info.valueType, "double");
  EXPECT_EQ(info.activeVoxels, 2u + 512u);
  EXPECT_EQ(info.tiles, 1u);
  EXPECT_EQ(info.leaves, 1u);
  EXPECT_EQ(info.nonFiniteValues, 1u);
  EXPECT_EQ(info.minValue, -7.0);
  EXPECT_EQ(info.maxValue, 2.5);
  EXPECT_EQ(info.voxelSize[1], 0.5);
  EXPECT_EQ(info.boundsMax[2], 71);
  EXPECT_EQ(info.transform, "uniform scale");
  EXPECT_TRUE(info.meshable);
}

/// No size in their trees can be checked.
TEST(GridFiles, OfTypesOfApplicationsAreRefusedAlone) {
  using OtherGrid = openvdb::Grid<openvdb::tree::Tree4<std::uint8_t, 5, 4, 3>::Type>;
  const ScratchFolder folder;
  const auto other = makeSingle<OtherGrid>("other", 1);
  OtherGrid::registerGrid();
  writeGrids({other, makeBall("ball")}, folder / "m.vdb");
  EXPECT_EQ(readGrid(folder / "m.vdb")->getName(), "ball");
  expectError(ErrorCode::UnreadableFile, "grids of type Tree_uint8_5_4_3 cannot be checked",
              [&] { (void)readGrid(folder / "m.vdb", "other"); });
  OtherGrid::unregisterGrid();
}

TEST(GridFiles, RefuseForeignFiles) {
  const ScratchFolder folder;
  const auto refuse = [&](const std::string& bytes, const std::string& part) {
    writeBytes(folder / "m.vdb", bytes);
    expectError(ErrorCode::UnreadableFile, part, [&] { (void)readGrid(folder / "m.vdb"); });
  };
  refuse("", "empty");
  refuse("x", "not an OpenVDB file");
  refuse("NanoVDB0 and so on", "NanoVDB");
  refuse(std::string(" BDV\0\0\0\0", 8), "truncated");
  expectError(ErrorCode::UnreadableFile, "No such file",
              [&] { (void)readGrid(folder / "no.vdb"); });
  expectError(ErrorCode::UnreadableFile, "folder", [&] { (void)readGrid(folder / ""); });
}

/// A file cut anywhere is refused, and one with changed bytes never crashes the reader.
TEST(GridFiles, SurviveDamage) {
  const ScratchFolder folder;
  ShapeOptions options;
  options.voxelSize = 0.4;
  writeGrids({makeShape(Shape::Sphere, options)}, folder / "whole.vdb");
  const std::string whole = readBytes(folder / "whole.vdb");
  for (std::size_t length = 0; length < whole.size(); length += 1 + length / 64) {
    writeBytes(folder / "m.vdb", whole.substr(0, length));
    EXPECT_THROW((void)readGrid(folder / "m.vdb"), Error) << length;
  }
}

TEST(GridFiles, TellOfAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  expectError(ErrorCode::UnwritableFile, "space",
              [] { writeGrids({makeBall("ball")}, "/dev/full"); });
}

TEST(GridFiles, LeaveNothingBehindWhenTheyCannotBeWritten) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "taken.vdb");
  expectError(ErrorCode::UnwritableFile, "folder",
              [&] { writeGrids({makeBall("ball")}, folder / "taken.vdb"); });
  EXPECT_EQ(folder.fileCount(), 1);
}

TEST(GridFiles, ReadTheSampleVolumes) {
  const std::filesystem::path folder = TUFA_TEST_DATA;
  if (!std::filesystem::exists(folder / "openvdb_smoke.vdb")) {
    GTEST_SKIP() << "no samples in " << folder;
  }
  // The first two are stored in half precision.
  EXPECT_EQ(readGrid(folder / "openvdb_sphere.vdb")->activeVoxelCount(), 270638u);
  EXPECT_EQ(readGrid(folder / "openvdb_smoke.vdb")->activeVoxelCount(), 1049275u);
  EXPECT_EQ(readGrid(folder / "usd_smoke_000003.vdb")->activeVoxelCount(), 90197u);
  EXPECT_EQ(readGrid(folder / "zeno_sphere.vdb")->activeVoxelCount(), 40404u);
}

TEST(GridFiles, OfScalesOutOfRangeAreRefusedByName) {
  const ScratchFolder folder;
  writeGrids({makeBall("ball")}, folder / "m.vdb");
  std::string bytes = test::readBytes(folder / "m.vdb");
  const auto pattern = [](double voxelSize) {
    return std::string(reinterpret_cast<const char*>(&voxelSize), sizeof voxelSize);
  };
  const double voxelSize = makeBall("ball")->voxelSize()[0];
  for (const double scale : {1e-40, 1e300, 0.0, std::nan("")}) {
    std::string damaged = bytes;
    std::size_t places = 0;
    for (std::size_t at = 0; (at = damaged.find(pattern(voxelSize), at)) != std::string::npos;
         ++at) {
      damaged.replace(at, sizeof scale, pattern(scale));
      ++places;
    }
    ASSERT_GE(places, 6u);
    test::writeBytes(folder / "m.vdb", damaged);
    expectError(ErrorCode::UnsupportedGrid, "m.vdb", [&] { (void)readGrid(folder / "m.vdb"); });
    expectError(ErrorCode::UnsupportedGrid, "m.vdb cannot be meshed: its",
                [&] { (void)readGrid(folder / "m.vdb", "ball"); });
    EXPECT_FALSE(describeGrids(folder / "m.vdb").at(0).meshable);
  }
}

}  // namespace
}  // namespace tufa
