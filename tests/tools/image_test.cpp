// tufa import of what scanners and microscopes write, through ITK.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/import.h>
#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::readBytes;
using test::writeBytes;

constexpr std::array<int, 3> kSize = {5, 4, 6};

/// Every voxel has a value of its own; the first one is background.
std::uint16_t valueAt(int x, int y, int z) {
  return static_cast<std::uint16_t>(x + 10 * y + 100 * z);
}

template <class Number>
std::string bytesOf(Number number) {
  std::string bytes(sizeof(Number), '\0');
  std::memcpy(bytes.data(), &number, sizeof(Number));
  return bytes;
}

std::string slice(int z) {
  std::string bytes;
  for (int y = 0; y < kSize[1]; ++y) {
    for (int x = 0; x < kSize[0]; ++x) bytes += bytesOf(valueAt(x, y, z));
  }
  return bytes;
}

std::string allSlices() {
  std::string bytes;
  for (int z = 0; z < kSize[2]; ++z) bytes += slice(z);
  return bytes;
}

/// A data element of DICOM with explicit types, in little endian.
std::string element(std::uint16_t group, std::uint16_t number, const std::string& type,
                    std::string value) {
  if (value.size() % 2 != 0) value += type == "UI" ? '\0' : ' ';
  std::string bytes = bytesOf(group) + bytesOf(number) + type;
  if (type == "OB" || type == "OW") {
    bytes += std::string(2, '\0') + bytesOf(static_cast<std::uint32_t>(value.size()));
  } else {
    bytes += bytesOf(static_cast<std::uint16_t>(value.size()));
  }
  return bytes + value;
}

/// A CT slice, turned about x, at a step of 1.5 along (0, -0.6, 0.8).
std::string dicom(int z, const std::string& series) {
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2";
  const std::string instance = series + "." + std::to_string(z + 1);
  const std::string meta = element(2, 1, "OB", std::string("\0\1", 2)) + element(2, 2, "UI", ct) +
                           element(2, 3, "UI", instance) +
                           element(2, 0x10, "UI", "1.2.840.10008.1.2.1") +
                           element(2, 0x12, "UI", "1.2.3.4");
  const auto text = [](double number) { return std::to_string(number).substr(0, 12); };
  const std::string place = "10\\" + text(20 - 0.9 * z) + "\\" + text(30 + 1.2 * z);
  const auto number = [](std::uint16_t n) { return bytesOf(n); };
  return std::string(128, '\0') + "DICM" +
         element(2, 0, "UL", bytesOf(static_cast<std::uint32_t>(meta.size()))) + meta +
         element(8, 0x16, "UI", ct) + element(8, 0x18, "UI", instance) +
         element(8, 0x60, "CS", "CT") + element(0x18, 0x50, "DS", "1.5") +
         element(0x20, 0xd, "UI", "1.2.3") + element(0x20, 0xe, "UI", series) +
         element(0x20, 0x13, "IS", std::to_string(z + 1)) + element(0x20, 0x32, "DS", place) +
         element(0x20, 0x37, "DS", "1\\0\\0\\0\\0.8\\0.6") + element(0x28, 2, "US", number(1)) +
         element(0x28, 4, "CS", "MONOCHROME2") + element(0x28, 0x10, "US", number(kSize[1])) +
         element(0x28, 0x11, "US", number(kSize[0])) + element(0x28, 0x30, "DS", "0.5\\0.7") +
         element(0x28, 0x100, "US", number(16)) + element(0x28, 0x101, "US", number(16)) +
         element(0x28, 0x102, "US", number(15)) + element(0x28, 0x103, "US", number(0)) +
         element(0x28, 0x1052, "DS", "0") + element(0x28, 0x1053, "DS", "1") +
         element(0x7fe0, 0x10, "OW", slice(z));
}

std::string tiff(int z) {
  const std::string values = slice(z);
  std::string bytes = "II*" + std::string(1, '\0') +
                      bytesOf(static_cast<std::uint32_t>(8 + values.size())) + values;
  const std::vector<std::array<std::uint32_t, 2>> tags = {
      {256, 5}, {257, 4}, {258, 16}, {259, 1}, {262, 1}, {273, 8}, {277, 1}, {278, 4}, {279, 40}};
  bytes += bytesOf(static_cast<std::uint16_t>(tags.size()));
  for (const auto& [tag, value] : tags) {
    bytes += bytesOf(static_cast<std::uint16_t>(tag)) + bytesOf(std::uint16_t{4}) +
             bytesOf(std::uint32_t{1}) + bytesOf(value);
  }
  return bytes + std::string(4, '\0');
}

/// The 348 bytes of NIfTI-1 and the four behind them.
std::string nifti() {
  std::string head(352, '\0');
  const auto put = [&](std::size_t at, const std::string& bytes) {
    head.replace(at, bytes.size(), bytes);
  };
  put(0, bytesOf(std::int32_t{348}));
  const std::array<int, 8> dim = {3, kSize[0], kSize[1], kSize[2], 1, 1, 1, 1};
  for (std::size_t n = 0; n < 8; ++n) put(40 + 2 * n, bytesOf(static_cast<std::int16_t>(dim[n])));
  put(70, bytesOf(std::int16_t{512}) + bytesOf(std::int16_t{16}));
  const std::array<float, 4> spacing = {1, 0.5F, 2, 3};
  for (std::size_t n = 0; n < 4; ++n) put(76 + 4 * n, bytesOf(spacing[n]));
  put(108, bytesOf(352.0F) + bytesOf(1.0F));
  put(252, bytesOf(std::int16_t{0}) + bytesOf(std::int16_t{1}));
  // Rows of an affine map to x to the right, y to the front; ITK turns both round.
  const std::array<float, 12> rows = {-0.5F, 0, 0, -10, 0, -2, 0, -20, 0, 0, 3, 30};
  for (std::size_t n = 0; n < 12; ++n) put(280 + 4 * n, bytesOf(rows[n]));
  put(344, std::string("n+1\0", 4));
  return head + allSlices();
}

class Images : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    const Outcome help = run("import --help");
    if (help.out.find("built without ITK") != std::string::npos) {
      GTEST_SKIP() << "this tufa was built without ITK";
    }
  }

  /// Imports, and expects every value at the place that three points give.
  void expectImage(const std::string& inputs, const openvdb::Vec3d& origin,
                   const std::array<openvdb::Vec3d, 3>& steps) {
    const Outcome made = run("import -o v.vdb " + inputs);
    ASSERT_EQ(made.exitCode, 0) << inputs << ": " << made.err;
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(readGrid(folder / "v.vdb"));
    ASSERT_TRUE(grid);
    for (int z = 0; z < kSize[2]; ++z) {
      for (int y = 0; y < kSize[1]; ++y) {
        for (int x = 0; x < kSize[0]; ++x) {
          const openvdb::Coord at(x, y, z);
          ASSERT_EQ(grid->tree().getValue(at), valueAt(x, y, z)) << inputs << at;
          const openvdb::Vec3d place = grid->indexToWorld(at);
          const openvdb::Vec3d due = origin + x * steps[0] + y * steps[1] + z * steps[2];
          ASSERT_LT((place - due).length(), 1e-4) << inputs << at << place << due;
        }
      }
    }
    EXPECT_EQ(grid->activeVoxelCount(), 5u * 4 * 6 - 1) << inputs;
  }

  void writeMetaImage(const std::string& name, const std::string& more = "") const {
    writeBytes(folder / (name + ".raw"), allSlices());
    writeBytes(folder / (name + ".mhd"),
               "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
               "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 0.5 2 3\n"
               "DimSize = 5 4 6\nElementType = MET_USHORT\n" +
                   more + "ElementDataFile = " + name + ".raw\n");
  }
};

TEST_F(Images, OfAllFormatsKeepValuesAndPlaces) {
  writeMetaImage("m");
  expectImage("m.mhd", {1, 2, 3}, {{{0, 0.5, 0}, {-2, 0, 0}, {0, 0, 3}}});
  expectImage("m.mhd --spacing 1,1,1 --origin 0,0,0", {0, 0, 0},
              {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}});
  writeBytes(folder / "n.nrrd",
             "NRRD0004\ntype: uint16\ndimension: 3\nspace: left-posterior-superior\n"
             "sizes: 5 4 6\nspace directions: (0.5,0,0) (0,2,0) (0,0.6,3)\nendian: little\n"
             "encoding: raw\nspace origin: (1,2,3)\n\n" +
                 allSlices());
  // ITK takes the lengths of the axes apart from their directions.
  expectImage("n.nrrd", {1, 2, 3}, {{{0.5, 0, 0}, {0, 2, 0}, {0, 0.6, 3}}});
  writeBytes(folder / "n.nii", nifti());
  expectImage("n.nii", {10, 20, 30}, {{{0.5, 0, 0}, {0, 2, 0}, {0, 0, 3}}});
  std::string names;
  for (int z = 0; z < kSize[2]; ++z) {
    const std::string name = "t" + std::to_string(z) + ".tif";
    writeBytes(folder / name, tiff(z));
    names += " " + name;
  }
  expectImage("--spacing 0.5,0.5,2" + names, {0, 0, 0}, {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 2}}});
}

TEST_F(Images, OfADicomSeriesAreOrderedByTheirPlaces) {
  std::filesystem::create_directory(folder / "ct");
  for (int z = 0; z < kSize[2]; ++z) {
    // Names in another order than the slices.
    writeBytes(folder / "ct" / ("f" + std::to_string((5 * z + 3) % 6) + ".dcm"),
               dicom(z, "1.2.3.7"));
  }
  const std::array<openvdb::Vec3d, 3> steps = {{{0.7, 0, 0}, {0, 0.4, 0.3}, {0, -0.9, 1.2}}};
  expectImage("ct", {10, 20, 30}, steps);
  writeBytes(folder / "ct" / "other.dcm", dicom(0, "1.2.3.8"));
  expectFailure("import ct -o o.vdb", 2, "2 DICOM series; choose one by --series");
  std::filesystem::remove(folder / "ct" / "other.dcm");
  // One slice of the middle is missing.
  std::filesystem::remove(folder / "ct" / "f1.dcm");
  expectFailure("import ct -o o.vdb", 3, "evenly spaced");
}

TEST_F(Images, KeepLabelsAsIntegers) {
  writeMetaImage("m");
  ASSERT_EQ(run("import m.mhd -o l.vdb --labels").exitCode, 0);
  const auto grid = openvdb::gridPtrCast<openvdb::Int32Grid>(readGrid(folder / "l.vdb", "labels"));
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->getName(), "labels");
  EXPECT_EQ(grid->background(), 0);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(4, 3, 5)), valueAt(4, 3, 5));
}

/// Raw values need no ITK.
class LabelMeshes : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    // A block of 2 in one of 7, and a bar of 300 that touches both.
    std::string bytes;
    for (int z = 0; z < 20; ++z) {
      for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
          const auto in = [&](int least, int most) {
            return std::min({x, y, z}) >= least && std::max({x, y, z}) <= most;
          };
          const bool bar = x >= 10 && std::max(y, z) <= 11 && std::min(y, z) >= 9 && x <= 17;
          bytes += bytesOf(static_cast<std::uint16_t>(bar         ? 300
                                                      : in(6, 9)  ? 2
                                                      : in(3, 14) ? 7
                                                                  : 0));
        }
      }
    }
    writeBytes(folder / "l.raw", bytes);
    ASSERT_EQ(run("import l.raw -o l.vdb --size 20,20,20 --type u16 --labels").exitCode, 0);
  }
};

TEST_F(LabelMeshes, AreClosedEachOfItsOwn) {
  const Outcome made = run("mesh l.vdb -o 'm_{}.ply' --labels all --check --json --uniform");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const auto json = nlohmann::json::parse(made.out);
  const std::vector<std::string> names = {"label_2", "label_7", "label_300"};
  // Voxels of each, less what the corners and edges lose.
  const std::vector<double> voxels = {4 * 4 * 4, 12 * 12 * 12 - 64 - 5 * 9, 8 * 9};
  ASSERT_EQ(json.at("grids").size(), names.size());
  for (std::size_t n = 0; n < names.size(); ++n) {
    const auto& grid = json.at("grids").at(n);
    EXPECT_EQ(grid.at("grid"), names[n]);
    EXPECT_EQ(grid.at("active_voxels"), voxels[n]);
    const double volume = grid.at("check").at("volume");
    EXPECT_GT(volume, 0.8 * voxels[n]) << names[n];
    EXPECT_LT(volume, 1.05 * voxels[n]) << names[n];
    EXPECT_TRUE(std::filesystem::exists(folder / ("m_" + names[n] + ".ply")));
  }
  EXPECT_EQ(run("mesh l.vdb -o m.obj --labels 300,2 --check").exitCode, 0);
  EXPECT_EQ(run("mesh l.vdb -o m.ply --labels 7 --smooth gaussian --check").exitCode, 0);
}

TEST_F(LabelMeshes, RefuseWhatIsNoLabel) {
  expectFailure("mesh l.vdb -o m.ply --labels 3", 3, "no label 3");
  expectFailure("mesh l.vdb -o m.ply --labels x", 2, "--labels takes all");
  expectFailure("mesh l.vdb -o m.ply --labels 2,2", 2, "asked for twice");
  expectFailure("mesh l.vdb -o m.ply --labels all", 2, "would hold 3");
  expectFailure("mesh l.vdb -o m.ply --labels 2 --iso 1", 2, "no --iso");
  ASSERT_EQ(run("make sphere -o s.vdb --voxel 0.2").exitCode, 0);
  expectFailure("mesh s.vdb -o m.ply --labels all", 3, "no grid of 32- or 64-bit integers");
  expectFailure("mesh s.vdb -o m.ply --labels all --grid '*'", 3, "no grid");
}

TEST_F(Images, RefuseWhatIsNone) {
  writeBytes(folder / "empty.nrrd", "");
  writeBytes(folder / "text.mhd", "no image");
  writeMetaImage("m", "CompressedData = True\n");
  std::filesystem::create_directory(folder / "d");
  expectFailure("import none.nii -o o.vdb", 3, "there is no such file");
  expectFailure("import empty.nrrd -o o.vdb", 3, "cannot read empty.nrrd");
  expectFailure("import text.mhd -o o.vdb", 3, "cannot read text.mhd");
  // Claims of gigabytes, and of a little more than there is.
  const std::string claims = readBytes(folder / "m.mhd");
  for (const std::string size : {"30000 30000 1000", "5 4 7"}) {
    std::string more = claims.substr(0, claims.find("CompressedData"));
    more.replace(more.find("5 4 6"), 5, size);
    writeBytes(folder / "more.mhd", more + "ElementDataFile = m.raw\n");
    expectFailure("import more.mhd -o o.vdb", 3, "cannot read more.mhd");
  }
  writeBytes(folder / "short.nii", nifti().substr(0, 500));
  expectFailure("import short.nii -o o.vdb", 3, "cannot read short.nii");
  writeBytes(folder / "short.tif", tiff(1).substr(0, 100));
  expectFailure("import short.tif -o o.vdb", 3, "cannot read short.tif");
  expectFailure("import d -o o.vdb", 3, "no DICOM series in the folder");
  writeMetaImage("m");
  expectFailure("import m.mhd -o o.vdb --type u8", 2, "--type is for raw values");
  expectFailure("import m.mhd -o o.vdb --labels --threshold 3", 2, "labels have no threshold");
  expectFailure("import m.mhd -o o.vdb --series 1.2", 2, "--series is for a folder");
}

}  // namespace
}  // namespace tufa
