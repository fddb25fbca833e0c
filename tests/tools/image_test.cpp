// tufa import of what scanners and microscopes write, through ITK.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <zlib.h>

#include <tufa/import.h>
#include <tufa/io.h>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
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

/// All slices as pages, each of them behind its values.
std::string tiffPages() {
  std::string bytes = "II*" + std::string(5, '\0');
  std::size_t link = 4;
  const auto size = [&] { return static_cast<std::uint32_t>(bytes.size()); };
  for (int z = 0; z < kSize[2]; ++z) {
    const std::uint32_t values = size();
    bytes += slice(z);
    bytes.replace(link, 4, bytesOf(size()));
    const std::vector<std::array<std::uint32_t, 2>> tags = {{256, 5}, {257, 4}, {258, 16},
                                                            {259, 1}, {262, 1}, {273, values},
                                                            {277, 1}, {278, 4}, {279, 40}};
    bytes += bytesOf(static_cast<std::uint16_t>(tags.size()));
    for (const auto& [tag, value] : tags) {
      bytes += bytesOf(static_cast<std::uint16_t>(tag)) + bytesOf(std::uint16_t{4}) +
               bytesOf(std::uint32_t{1}) + bytesOf(value);
    }
    link = bytes.size();
    bytes += std::string(4, '\0');
  }
  return bytes;
}

/// In the format of zlib, or of gzip if `more` is 16.
std::string packed(const std::string& bytes, int more = 0) {
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + more, 8, Z_DEFAULT_STRATEGY);
  std::string in = bytes;
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

template <class Number>
std::string bigEndian(Number number) {
  const std::string bytes = bytesOf(number);
  return {bytes.rbegin(), bytes.rend()};
}

/// A slice in 16 bits of grey.
std::string png(int z) {
  std::string rows;
  for (int y = 0; y < kSize[1]; ++y) {
    rows += '\0';
    for (int x = 0; x < kSize[0]; ++x) rows += bigEndian(valueAt(x, y, z));
  }
  const auto chunk = [](const std::string& type, const std::string& data) {
    const std::string all = type + data;
    const auto sum =
        crc32(0, reinterpret_cast<const Bytef*>(all.data()), static_cast<uInt>(all.size()));
    return bigEndian(static_cast<std::uint32_t>(data.size())) + all +
           bigEndian(static_cast<std::uint32_t>(sum));
  };
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", bigEndian(std::uint32_t{5}) + bigEndian(std::uint32_t{4}) +
                           std::string("\x10\0\0\0\0", 5)) +
         chunk("IDAT", packed(rows)) + chunk("IEND", "");
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

  void writePackedMetaImage() const {
    writeBytes(folder / "packed.mha",
               "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
               "CompressedData = True\nCompressedDataSize = " +
                   std::to_string(packed(allSlices()).size()) +
                   "\nDimSize = 5 4 6\nElementType = MET_USHORT\nElementDataFile = LOCAL\n" +
                   packed(allSlices()));
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
  const std::array<openvdb::Vec3d, 3> steps = {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 2}}};
  expectImage("--spacing 0.5,0.5,2" + names, {0, 0, 0}, steps);
  names.clear();
  for (int z = 0; z < kSize[2]; ++z) {
    const std::string name = "p" + std::to_string(z) + ".png";
    writeBytes(folder / name, png(z));
    names += " " + name;
  }
  expectImage("--spacing 0.5,0.5,2" + names, {0, 0, 0}, steps);
  writeBytes(folder / "pages.tif", tiffPages());
  expectImage("--spacing 0.5,0.5,2 pages.tif", {0, 0, 0}, steps);
  writePackedMetaImage();
  expectImage("packed.mha --spacing 0.5,0.5,2", {0, 0, 0}, steps);
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

/// ITK takes what is missing for 0, or leaves out pages.
TEST_F(Images, ThatAreCutOrDamagedAreRefused) {
  writePackedMetaImage();
  writeBytes(folder / "pages.tif", tiffPages());
  writeBytes(folder / "p.png", png(1));
  writeBytes(folder / "n.nii", nifti());
  ASSERT_EQ(std::system(("gzip -k " + (folder / "n.nii").string()).c_str()), 0);
  for (const std::string name : {"packed.mha", "pages.tif", "p.png", "n.nii", "n.nii.gz"}) {
    ASSERT_EQ(run("import -o v.vdb " + name).exitCode, 0) << name;
    const std::string bytes = readBytes(folder / name);
    for (const std::size_t size : {bytes.size() - 1, bytes.size() - 9, bytes.size() * 3 / 4,
                                   bytes.size() / 2, std::size_t{30}, std::size_t{3}}) {
      writeBytes(folder / ("cut_" + name), bytes.substr(0, size));
      expectFailure("import -o o.vdb cut_" + name, 3, "cannot read cut_" + name);
    }
  }
  const auto cut = [&](const std::string& argument, const std::string& name, std::size_t header) {
    ASSERT_EQ(run("import -o v.vdb " + argument).exitCode, 0) << argument;
    const std::string bytes = readBytes(folder / name);
    for (const std::size_t left : {bytes.size() - 1, bytes.size() - 30, header + 1}) {
      writeBytes(folder / name, bytes.substr(0, left));
      expectFailure("import -o o.vdb " + argument, 3, "cannot read " + name);
    }
    writeBytes(folder / name, bytes);
  };
  // The header, and values in a file of their own.
  std::string header = nifti().substr(0, 348);
  header.replace(344, 4, std::string("ni1\0", 4));
  header.replace(108, 4, std::string(4, '\0'));
  writeBytes(folder / "n.hdr", header);
  writeBytes(folder / "n.img", allSlices());
  cut("n.hdr", "n.img", 0);
  const std::string nrrd =
      "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 5 4 6\nendian: little\nencoding: gzip\n";
  writeBytes(folder / "z.nrrd", nrrd + "\n" + packed(allSlices(), 16));
  cut("z.nrrd", "z.nrrd", nrrd.size() + 1);
  writeBytes(folder / "a.nhdr", nrrd + "data file: a.gz\n");
  writeBytes(folder / "a.gz", packed(allSlices(), 16));
  cut("a.nhdr", "a.gz", 1);
  std::filesystem::create_directory(folder / "ct");
  for (int z = 0; z < kSize[2]; ++z) {
    writeBytes(folder / "ct" / ("f" + std::to_string(z)), dicom(z, "1.2.3.7"));
  }
  cut("ct", "ct/f4", dicom(4, "1.2.3.7").size() - slice(4).size());
  std::string damaged = readBytes(folder / "n.nii.gz");
  damaged[damaged.size() - 6] = static_cast<char>(damaged[damaged.size() - 6] ^ 1);
  writeBytes(folder / "d.nii.gz", damaged);
  expectFailure("import -o o.vdb d.nii.gz", 3, "cannot read d.nii.gz");
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
