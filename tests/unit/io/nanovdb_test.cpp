// .nvdb: what NanoVDB's own writer makes of a grid is read back as that grid.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <tufa/contour.h>
#include <tufa/io.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <cmath>
#include <random>
#include <sstream>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

#ifdef TUFA_HAS_NANOVDB
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#endif

namespace tufa {
namespace {

using openvdb::FloatGrid;
using openvdb::GridBase;
using test::expectError;

#ifdef TUFA_HAS_NANOVDB

using nanovdb::io::Codec;
using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

FloatGrid::Ptr makeSphere() {
  ShapeOptions options;
  options.voxelSize = 0.1;
  const auto grid = makeShape(Shape::Sphere, options);
  grid->transform().postRotate(0.4, openvdb::math::Z_AXIS);
  grid->transform().postTranslate({1, -2, 3});
  grid->setName("sphere");
  return grid;
}

std::string bytesOf(std::vector<Handle> handles, Codec codec = Codec::NONE) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("tufa-made-" + std::to_string(::getpid()) + ".nvdb");
  nanovdb::io::writeGrids<nanovdb::HostBuffer, std::vector>(path.string(), handles, codec);
  const std::string bytes = test::readBytes(path);
  std::filesystem::remove(path);
  return bytes;
}

std::string bytesOf(const GridBase::Ptr& grid, Codec codec = Codec::NONE) {
  std::vector<Handle> handles;
  handles.push_back(nanovdb::openToNanoVDB(grid));
  return bytesOf(std::move(handles), codec);
}

template <class GridT>
void expectSame(const GridBase& read, const GridT& made) {
  ASSERT_TRUE(read.isType<GridT>()) << read.type();
  const auto& grid = static_cast<const GridT&>(read);
  EXPECT_EQ(grid.getName(), made.getName());
  EXPECT_EQ(grid.getGridClass(), made.getGridClass());
  EXPECT_EQ(grid.background(), made.background());
  EXPECT_EQ(grid.activeVoxelCount(), made.activeVoxelCount());
  for (const openvdb::Vec3d& p : {openvdb::Vec3d(0), openvdb::Vec3d(7, -8, 9)}) {
    EXPECT_TRUE(grid.indexToWorld(p).eq(made.indexToWorld(p), 1e-6));
  }
  openvdb::CoordBBox box = made.evalActiveVoxelBoundingBox();
  box.expand(9);  // over tiles beside the band too
  const auto values = grid.getConstAccessor();
  const auto expected = made.getConstAccessor();
  for (auto at = box.begin(); at; ++at) {
    ASSERT_EQ(values.getValue(*at), expected.getValue(*at)) << *at;
    ASSERT_EQ(values.isValueOn(*at), expected.isValueOn(*at)) << *at;
  }
}

TEST(NanoVdb, IsReadByEveryCodec) {
  const auto sphere = makeSphere();
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    const std::string bytes = bytesOf(sphere, codec);
    expectSame(*readGrid(FileBytes{bytes}), *sphere);
    EXPECT_EQ(contour(*readGrid(FileBytes{bytes})).positions, contour(*sphere).positions);
  }
  const test::ScratchFolder folder;
  test::writeBytes(folder / "s.nvdb", bytesOf(sphere));
  expectSame(*readGrid(folder / "s.nvdb", "sphere"), *sphere);
  EXPECT_EQ(describeGrids(folder / "s.nvdb").at(0).activeVoxels, sphere->activeVoxelCount());
}

TEST(NanoVdb, HasGridsOfSeveralTypesAndNames) {
  const auto sphere = makeSphere();
  const auto velocity = openvdb::Vec3SGrid::create({1, 2, 3});
  velocity->setName("vel");
  velocity->setGridClass(openvdb::GRID_STAGGERED);
  velocity->tree().setValueOn({-5, 6, 700}, {4, 5, 6});
  const auto doubles = openvdb::DoubleGrid::create(0.5);
  doubles->setName("sphere");
  doubles->fill({{-300, 0, 0}, {300, 40, 40}}, 0.25);  // tiles
  std::vector<Handle> handles;
  for (const GridBase::Ptr& grid :
       {GridBase::Ptr(sphere), GridBase::Ptr(velocity), GridBase::Ptr(doubles)}) {
    handles.push_back(nanovdb::openToNanoVDB(grid));
  }
  const std::string bytes = bytesOf(std::move(handles));
  const auto names = listGrids(FileBytes{bytes});
  ASSERT_EQ(names.size(), 3u);
  EXPECT_EQ(names[0].name, "sphere[0]");
  EXPECT_EQ(names[1].name, "vel");
  EXPECT_FALSE(names[1].meshable);
  EXPECT_TRUE(names[2].meshable);
  expectSame(*readGrid(FileBytes{bytes}, "sphere[0]"), *sphere);
  expectSame(*readGrid(FileBytes{bytes}, "vel"), *velocity);
  expectSame(*readGrid(FileBytes{bytes}, "sphere[1]"), *doubles);
  expectError(ErrorCode::UnknownGrid, "no grid \"cube\"",
              [&] { static_cast<void>(readGrid(FileBytes{bytes}, "cube")); });
}

template <class BuildT>
std::string quantized(const FloatGrid& grid) {
  std::vector<Handle> handles;
  handles.push_back(nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, BuildT>(grid));
  return bytesOf(std::move(handles));
}

TEST(NanoVdb, QuantizedValuesBecomeFloats) {
  const auto sphere = makeSphere();
  const double range = 2 * static_cast<double>(sphere->background());
  const auto expectNear = [&](const std::string& bytes, double error) {
    const auto read = openvdb::gridPtrCast<FloatGrid>(readGrid(FileBytes{bytes}));
    ASSERT_EQ(read->activeVoxelCount(), sphere->activeVoxelCount());
    for (auto value = sphere->cbeginValueOn(); value; ++value) {
      ASSERT_NEAR(read->tree().getValue(value.getCoord()), *value, error);
    }
  };
  expectNear(quantized<nanovdb::Fp4>(*sphere), range / 15);
  expectNear(quantized<nanovdb::Fp8>(*sphere), range / 255);
  expectNear(quantized<nanovdb::Fp16>(*sphere), range / 65535);
  expectNear(quantized<nanovdb::FpN>(*sphere), range / 15);
}

TEST(NanoVdb, OfOtherTypesSaysWhich) {
  const auto mask = openvdb::BoolGrid::create(false);
  mask->setName("mask");
  const std::string bytes = bytesOf(mask);
  expectError(ErrorCode::UnreadableFile, "grid \"mask\" holds values of NanoVDB's type bool",
              [&] { static_cast<void>(readGrid(FileBytes{bytes})); });
}

/// Reads what may be damaged: it is read or refused, and nothing else happens.
void expectReadOrRefused(const std::string& bytes) {
  try {
    const auto grid = readGrid(FileBytes{bytes});
    EXPECT_LT(grid->activeVoxelCount(), openvdb::Index64{1} << 40U);
  } catch (const Error& error) {
    const bool known =
        error.code() == ErrorCode::UnreadableFile || error.code() == ErrorCode::UnsupportedGrid;
    EXPECT_TRUE(known) << error.what();
  }
}

TEST(NanoVdb, IsRefusedWhereItEndsTooEarly) {
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    const std::string bytes = bytesOf(makeSphere(), codec);
    for (const std::size_t size : {9ul, 17ul, 100ul, 195ul, 250ul, 900ul, bytes.size() - 1}) {
      expectError(ErrorCode::UnreadableFile, "", [&] {
        static_cast<void>(readGrid(FileBytes{std::string_view(bytes).substr(0, size)}));
      });
    }
  }
}

TEST(NanoVdb, SurvivesDamage) {
  std::mt19937 random(22);
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    const std::string sound = bytesOf(makeSphere(), codec);
    for (int run = 0; run < 150; ++run) {
      std::string bytes = sound;
      // Near the beginning, where sizes and offsets are, and anywhere.
      const std::size_t reach =
          run % 2 == 0 ? std::min<std::size_t>(bytes.size(), 1500) : bytes.size();
      for (int i = 0; i < 1 + run % 4; ++i) bytes[random() % reach] = static_cast<char>(random());
      expectReadOrRefused(bytes);
    }
  }
}

TEST(NanoVdb, OfSharedNodesIsRefused) {
  std::string bytes = bytesOf(makeSphere());
  nanovdb::io::MetaData meta;
  std::memcpy(static_cast<void*>(&meta), bytes.data() + sizeof(nanovdb::io::Header), sizeof meta);
  const std::size_t grid = sizeof(nanovdb::io::Header) + sizeof meta + meta.nameSize;
  const auto numberAt = [&](std::size_t place) {
    std::int64_t number = 0;
    std::memcpy(&number, bytes.data() + place, sizeof number);
    return number;
  };
  nanovdb::TreeData<3> tree;
  std::memcpy(static_cast<void*>(&tree), bytes.data() + grid + sizeof(nanovdb::GridData),
              sizeof tree);
  using Root = nanovdb::NanoRoot<float>::DataType;
  using Upper = nanovdb::NanoUpper<float>::DataType;
  const std::size_t root = grid + sizeof(nanovdb::GridData) + tree.mNodeOffset[3];
  const std::size_t upper =
      root + static_cast<std::size_t>(numberAt(root + sizeof(Root) + offsetof(Root::Tile, child)));
  // All children of that node are its first one.
  const std::size_t mask = upper + offsetof(Upper, mChildMask);
  std::size_t first = 0;
  while ((bytes[mask + first / 8] >> first % 8 & 1) == 0) ++first;
  const std::size_t table = upper + offsetof(Upper, mTable);
  const std::int64_t child = numberAt(table + first * sizeof child);
  for (std::size_t n = 0; n < 4096; ++n) {
    std::memcpy(bytes.data() + table + n * sizeof child, &child, sizeof child);
    bytes[mask + n / 8] = static_cast<char>(0xFF);
  }
  expectError(ErrorCode::UnreadableFile, "used twice",
              [&] { static_cast<void>(readGrid(FileBytes{bytes})); });
}

/// Bytes of little entropy that claim gigabytes, and leaves of few bytes that OpenVDB makes more
/// of.
TEST(NanoVdb, ThatTakesMemoryOutOfProportionIsRefused) {
  std::string claim = bytesOf(makeSphere(), Codec::ZIP);
  claim.resize(std::size_t{1} << 20);
  const std::uint64_t gridSize = 300ULL << 20;
  const std::uint64_t fileSize = claim.size() / 2;
  const std::size_t meta = sizeof(nanovdb::io::Header);
  std::memcpy(claim.data() + meta + offsetof(nanovdb::io::MetaData, gridSize), &gridSize, 8);
  std::memcpy(claim.data() + meta + offsetof(nanovdb::io::MetaData, fileSize), &fileSize, 8);
  const auto refuse = [](const std::string& bytes) {
    expectError(ErrorCode::UnreadableFile, "its grids would take more than",
                [&] { static_cast<void>(readGrid(FileBytes{bytes})); });
  };
  refuse(claim);
  const auto solid = FloatGrid::create(0);
  constexpr int kSide = 49;
  for (auto at = openvdb::CoordBBox({0, 0, 0}, openvdb::Coord(kSide - 1)).begin(); at; ++at) {
    const openvdb::Coord& c = *at;
    solid->tree().touchLeaf({8 * c[0], 8 * c[1], 8 * c[2]})->fill(1, true);
  }
  std::vector<Handle> handles;
  handles.push_back(
      nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, nanovdb::Fp4>(*solid));
  const std::string bomb = bytesOf(std::move(handles), Codec::ZIP);
  EXPECT_LT(200 * bomb.size(), std::size_t{256} << 20);
  refuse(bomb);
}

TEST(NanoVdb, OfTheSamplesIsTheVolumeThatItWasMadeOf) {
  const std::filesystem::path nano = TUFA_TEST_DATA "/openvdb_fvdb_smoke-blosc.nvdb";
  if (!std::filesystem::exists(nano)) GTEST_SKIP() << nano << " is missing";
  const auto grid = readGrid(nano);
  EXPECT_GT(grid->activeVoxelCount(), 100000u);
  ContourOptions options;
  options.isovalue = 0.1;
  options.uniform = true;
  options.repair = false;
  EXPECT_GT(contour(*grid, options).triangleCount(), 1000u);
}

#else

TEST(NanoVdb, IsRefusedWithoutItsHeaders) {
  expectError(ErrorCode::UnreadableFile, "nanovdb_convert",
              [] { static_cast<void>(readGrid(FileBytes{"NanoVDB0 and more"})); });
}

#endif

}  // namespace
}  // namespace tufa
