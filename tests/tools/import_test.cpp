// tufa import: raw stacks to volumes.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/import.h>
#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "support/expect_error.h"
#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::writeBytes;
using Json = nlohmann::json;

class Import : public CommandTest {
 protected:
  [[nodiscard]] openvdb::FloatGrid::Ptr gridOf(const std::string& file) const {
    return openvdb::gridPtrCast<openvdb::FloatGrid>(readGrid(folder / file));
  }
};

/// A ball of 200 in a field of 10, brighter along x.
double ballAt(int x, int y, int z) {
  const double r2 = std::pow(x - 9, 2) + std::pow(y - 8, 2) + std::pow(z - 10, 2);
  return r2 < 36 ? 200 + x : 10;
}

/// The image of ballAt() in a type of value.
template <class Value>
std::string bytesOf(bool bigEndian) {
  std::string bytes;
  for (int z = 0; z < 21; ++z) {
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 19; ++x) {
        const auto value = static_cast<Value>(ballAt(x, y, z));
        char one[sizeof(Value)];
        std::memcpy(one, &value, sizeof(Value));
        std::string text(one, sizeof(Value));
        bytes += bigEndian ? std::string(text.rbegin(), text.rend()) : text;
      }
    }
  }
  return bytes;
}

TEST_F(Import, EveryTypeGivesTheSameVolume) {
  writeBytes(folder / "u8", bytesOf<std::uint8_t>(false));
  writeBytes(folder / "u16", bytesOf<std::uint16_t>(false));
  writeBytes(folder / "i16", bytesOf<std::int16_t>(true));
  writeBytes(folder / "f32", "head" + bytesOf<float>(false));
  for (const std::string& options :
       {std::string("u8"), std::string("u16 --type u16"),
        std::string("i16 --type i16 --big-endian"), std::string("f32 --type f32 --header 4")}) {
    const Outcome made =
        run("import -o v.vdb --size 19,17,21 --spacing 0.5,1,2 --origin 1,2,3 "
            "--json " +
            options);
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const auto grid = gridOf("v.vdb");
    EXPECT_EQ(grid->background(), 10);
    EXPECT_EQ(grid->indexToWorld(openvdb::Vec3d(2, 3, 4)), openvdb::Vec3d(2, 5, 11));
    std::size_t active = 0;
    for (int z = 0; z < 21; ++z) {
      for (int y = 0; y < 17; ++y) {
        for (int x = 0; x < 19; ++x) {
          const double truth = ballAt(x, y, z);
          active += truth > 10 ? 1 : 0;
          ASSERT_EQ(grid->tree().getValue(openvdb::Coord(x, y, z)), truth) << options;
          ASSERT_EQ(grid->tree().isValueOn(openvdb::Coord(x, y, z)), truth > 10) << options;
        }
      }
    }
    EXPECT_EQ(grid->activeVoxelCount(), active);
    EXPECT_EQ(test::parseJson(made.out).at("active_voxels"), active);
  }
  EXPECT_EQ(run("mesh v.vdb -o v.ply --iso 100 --check").exitCode, 0);
}

TEST_F(Import, SlicesMayLieInFilesOfTheirOwn) {
  const std::string all = bytesOf<std::uint16_t>(false);
  std::string names;
  const std::size_t slice = 2 * 19 * 17;
  for (int z = 0; z < 21; ++z) {
    const std::string name = "s" + std::to_string(10 + z);
    writeBytes(folder / name, all.substr(slice * z, slice));
    names += " " + name;
  }
  ASSERT_EQ(run("import -o many.vdb --type u16 --size 19,17,21" + names).exitCode, 0);
  writeBytes(folder / "one", all);
  ASSERT_EQ(run("import -o one.vdb --type u16 --size 19,17,21 --threads 1 one").exitCode, 0);
  const auto many = gridOf("many.vdb");
  const auto one = gridOf("one.vdb");
  EXPECT_TRUE(many->tree().hasSameTopology(one->tree()));
  for (auto value = one->cbeginValueOn(); value; ++value) {
    ASSERT_EQ(many->tree().getValue(value.getCoord()), *value);
  }
}

TEST_F(Import, ThresholdsAndNaNAreBackground) {
  const std::vector<float> values = {1, 2, std::numeric_limits<float>::quiet_NaN(), 4, -5, 6, 7, 8};
  writeBytes(folder / "v", {reinterpret_cast<const char*>(values.data()), 4 * values.size()});
  ASSERT_EQ(run("import v -o v.vdb --type f32 --size 2,2,2 --threshold 3").exitCode, 0);
  const auto grid = gridOf("v.vdb");
  EXPECT_EQ(grid->activeVoxelCount(), 4u);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(0, 1, 0)), 3);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(1, 1, 1)), 8);
  ASSERT_EQ(run("import v -o v.vdb --type f32 --size 2,2,2").exitCode, 0);
  EXPECT_EQ(gridOf("v.vdb")->background(), -5);
}

TEST_F(Import, SignedDistancesAreALevelSet) {
  constexpr int kSide = 20;
  std::vector<float> values;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        values.push_back(static_cast<float>(std::hypot(x - 9.6, y - 9.3, z - 9.8) * 0.5 - 3));
      }
    }
  }
  const float greatest = *std::max_element(values.begin(), values.end());
  writeBytes(folder / "d", {reinterpret_cast<const char*>(values.data()), 4 * values.size()});
  const std::string command =
      "import d -o v.vdb --type f32 --size 20,20,20 --spacing 0.5,0.5,0.5 --distances ";
  ASSERT_EQ(run(command).exitCode, 0);
  EXPECT_EQ(gridOf("v.vdb")->background(), greatest);
  ASSERT_EQ(run(command + "--threshold 1.5").exitCode, 0);
  const auto grid = gridOf("v.vdb");
  EXPECT_EQ(grid->getName(), "surface");
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->background(), 1.5F);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(9, 9, 9)), values[9 * 421]);
  const Outcome made = run("mesh v.vdb -o v.ply --check --json");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const Json report = test::parseJson(made.out);
  EXPECT_EQ(report.at("isovalue"), 0);
  EXPECT_EQ(report.at("inside"), "below");
  EXPECT_NEAR(report.at("check").at("volume").get<double>(), 4.0 / 3 * 3.14159265 * 27, 1);
  expectFailure(command + "--threshold -1", 2, "the threshold of distances must be above 0");
  expectFailure(command + "--labels", 2, "labels or distances, not both");
  writeBytes(folder / "d", std::string(4 * values.size(), '\0'));
  expectFailure(command, 3, "none of the values is above 0");
}

TEST_F(Import, KeepsToTheRoomThatAReaderIsGiven) {
  ImageSlices image;
  image.size = {4, 4, 4};
  image.read = [](std::int64_t, std::int64_t, std::vector<float>& values) { values.resize(3); };
  test::expectError(ErrorCode::InvalidArgument, "64, and not resize them to 3",
                    [&] { (void)importSlices(image); });
}

TEST_F(Import, RefusesWhatDoesNotFit) {
  writeBytes(folder / "v", std::string(1000, 'a'));
  std::filesystem::create_directory(folder / "d");
  const auto refused = [&](const std::string& options, int code, const std::string& part) {
    expectFailure("import -o o.vdb " + options, code, part);
  };
  refused("v --size 10,10,11", 3, "it has 1000 bytes of values, but 10 x 10 x 11 of 1 make 1100");
  refused("v v --size 10,10,10", 3, "it and the others have 2000 bytes");
  refused("v --size 10,10,10 --header 1001", 3, "fewer than the header's 1001");
  refused("v --size 1000000,1000000,1000000", 3, "make 1000000000000000000");
  refused("v --size 0,10,10", 2, "1 to 1000000 voxels");
  refused("v --size=-10,-10,10", 2, "1 to 1000000 voxels");
  refused("v --size 10,10,1e7", 2, "1 to 1000000 voxels");
  refused("v --size 10,10,2.5", 2, "--size takes whole numbers");
  refused("v --size 10,10", 2, "--size takes 3 numbers");
  refused("v --size 10,10,10 --spacing 1,0,1", 2, "lengths above 0");
  refused("v --size 10,10,10 --origin 1,1e30,1", 2, "the origin must lie");
  refused("v --size 10,10,10 --threshold nan", 2, "threshold");
  refused("v --size 10,10,10 --type u32", 2, "--type");
  refused("none --size 10,10,10", 3, "cannot read none: there is no such file");
  refused("d --size 10,10,10", 3, "not a regular file");
  expectFailure("import v -o v --size 10,10,10", 2, ".vdb");
}

}  // namespace
}  // namespace tufa
