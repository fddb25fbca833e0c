// Chunks in files: what is written is read back, and what is damaged is refused.

#include <gtest/gtest.h>

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "support/expect_error.h"
#include "support/json.h"
#include "support/scratch_folder.h"
#include "unit/chunks/hand_made.h"

namespace tufa {
namespace {

using test::readBytes;
using test::ScratchFolder;
using test::writeBytes;

class ChunkFiles : public ::testing::Test {
 protected:
  void write(ChunkFormat format) {
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const std::vector<ChunkFile> files = writeChunk(index, chunks[i], name, format);
      for (std::size_t k = 0; k < files.size(); ++k) {
        index.chunks[i].levels[k].file = files[k].name;
        // Those who test other guards leave this one out.
        if (summed) index.chunks[i].levels[k].checksum = files[k].checksum;
      }
    }
    writeChunkIndex(index, name);
  }

  void expectSame(const ChunkLevel& read, const ChunkLevel& made) {
    EXPECT_EQ(read.positions, made.positions);
    EXPECT_EQ(read.normals, made.normals);
    EXPECT_EQ(read.interior, made.interior);
    EXPECT_EQ(read.regular, made.regular);
    EXPECT_EQ(read.transition, made.transition);
    EXPECT_EQ(read.maxErrorVoxels, made.maxErrorVoxels);
    EXPECT_EQ(read.transitionErrorVoxels, made.transitionErrorVoxels);
  }

  void expectUnreadable(const std::string& part) {
    test::expectError(ErrorCode::UnreadableFile, part,
                      [&] { static_cast<void>(readChunk(readChunkIndex(name), 0, name)); });
  }

  /// Reads what may be damaged: it is read or refused, and nothing else happens.
  void expectReadOrRefused() {
    try {
      static_cast<void>(readChunk(readChunkIndex(name), 0, name));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::UnreadableFile) << error.what();
    }
  }

  bool summed = false;
  const ScratchFolder folder;
  const std::string name = (folder / "").string();
  std::vector<Chunk> chunks = test::makeDrum();
  ChunkIndex index = test::indexOf(chunks);
};

class ChunkFormats : public ChunkFiles, public ::testing::WithParamInterface<ChunkFormat> {};

TEST_P(ChunkFormats, AreReadBack) {
  index.origin = {1024, -2048, 0.5};
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      chunks[i].levels[k].maxErrorVoxels = index.chunks[i].levels[k].maxErrorVoxels;
      chunks[i].levels[k].transitionErrorVoxels = index.chunks[i].levels[k].transitionErrorVoxels;
    }
  }
  write(GetParam());
  EXPECT_EQ(folder.fileCount(), 7);
  const ChunkIndex read = readChunkIndex(name);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const Chunk chunk = readChunk(read, i, name);
    EXPECT_EQ(chunk.index, chunks[i].index);
    ASSERT_EQ(chunk.levels.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) expectSame(chunk.levels[k], chunks[i].levels[k]);
  }
}

TEST_P(ChunkFormats, HaveNoFileForALevelWithoutTriangles) {
  chunks[0].levels[1] = {};
  index = test::indexOf(test::makeDrum());
  index.chunks[0].levels[1] = {};
  write(GetParam());
  EXPECT_EQ(folder.fileCount(), 6);
  EXPECT_EQ(index.chunks[0].levels[1].file, "");
  const Chunk chunk = readChunk(readChunkIndex(name), 0, name);
  EXPECT_TRUE(chunk.levels[1].positions.empty());
  EXPECT_FALSE(chunk.levels[2].positions.empty());
}

TEST_P(ChunkFormats, AreRefusedWhereTheyEndTooEarly) {
  write(GetParam());
  const auto file = folder / index.chunks[0].levels[0].file;
  const std::string bytes = readBytes(file);
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    writeBytes(file, bytes.substr(0, size));
    expectUnreadable("cannot read");
  }
}

TEST_P(ChunkFormats, SurviveDamage) {
  write(GetParam());
  const auto file = folder / index.chunks[0].levels[0].file;
  const std::string bytes = readBytes(file);
  std::mt19937 random(3);
  for (int round = 0; round < 800; ++round) {
    std::string damaged = bytes;
    for (auto n = 1 + random() % 3; n > 0; --n) {
      damaged[random() % damaged.size()] = static_cast<char>(random() & 255u);
    }
    writeBytes(file, damaged);
    expectReadOrRefused();
  }
}

TEST_P(ChunkFormats, AreRefusedWhereTheyDoNotFitTheIndex) {
  write(GetParam());
  ++index.chunks[0].levels[0].interiorTriangles;
  writeChunkIndex(index, name);
  expectUnreadable("other counts than chunks.json");
  --index.chunks[0].levels[0].interiorTriangles;
  index.chunks[0].levels[0].file = "missing.glb";
  writeChunkIndex(index, name);
  expectUnreadable("missing.glb");
}

INSTANTIATE_TEST_SUITE_P(Chunks, ChunkFormats,
                         ::testing::Values(ChunkFormat::Glb, ChunkFormat::Ply),
                         [](const auto& param) {
                           return param.param == ChunkFormat::Glb ? "Glb" : "Ply";
                         });

class CompressedChunks : public ChunkFiles, public ::testing::WithParamInterface<GlbCompression> {
 protected:
  CompressedChunks() {
    index.compression = GetParam();
    index.step = 0.125;  // half a metre's 32nd
    index.scale = 0.5;
    index.up = UpAxis::Z;
    for (Chunk& chunk : chunks) {
      for (ChunkLevel& level : chunk.levels) {
        for (Position& p : level.positions) p = {p.x + 1000, p.y - 77.625, p.z};
      }
    }
  }

  /// The corners of all triangles of a part, in any order.
  static std::multiset<std::array<double, 9>> cornersOf(const ChunkLevel& level,
                                                        const std::vector<Triangle>& triangles) {
    std::multiset<std::array<double, 9>> corners;
    for (const Triangle& t : triangles) {
      std::array<std::array<double, 3>, 3> own;
      for (std::size_t i = 0; i < 3; ++i) {
        const Position& p = level.positions[t.vertices[i]];
        own[i] = {p.x, p.y, p.z};
      }
      std::rotate(own.begin(), std::min_element(own.begin(), own.end()), own.end());
      std::array<double, 9> flat;
      for (std::size_t i = 0; i < 9; ++i) flat[i] = own[i / 3][i % 3];
      corners.insert(flat);
    }
    return corners;
  }
};

TEST_P(CompressedChunks, AreReadBackToTheBit) {
  write(ChunkFormat::Glb);
  const ChunkIndex read = readChunkIndex(name);
  EXPECT_EQ(read.compression, GetParam());
  EXPECT_EQ(read.step, 0.125);
  EXPECT_EQ(read.scale, 0.5);
  EXPECT_EQ(read.up, UpAxis::Z);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const Chunk chunk = readChunk(read, i, name);
    for (std::size_t k = 0; k < 3; ++k) {
      const ChunkLevel &a = chunk.levels[k], &b = chunks[i].levels[k];
      EXPECT_EQ(cornersOf(a, a.interior), cornersOf(b, b.interior));
      for (std::size_t face = 0; face < kChunkFaces; ++face) {
        EXPECT_EQ(cornersOf(a, a.regular[face]), cornersOf(b, b.regular[face]));
        EXPECT_EQ(cornersOf(a, a.transition[face]), cornersOf(b, b.transition[face]));
      }
      for (const Normal& n : a.normals) EXPECT_EQ(n, Normal(0, 0, 1));
    }
  }
}

// What a program that computes in floats makes of a vertex is exact: numbers times a power of two,
// from a place that is a multiple of it.
TEST_P(CompressedChunks, AreExactInFloats) {
  write(ChunkFormat::Glb);
  const std::string bytes = readBytes(folder / index.chunks[0].levels[0].file);
  const auto json = test::parseJson(bytes.substr(20, bytes.rfind("BIN") - 4 - 20));
  const nlohmann::json& node = json["nodes"][0];
  EXPECT_EQ(node["scale"], (std::array{0.0625, 0.0625, 0.0625}));
  for (const double x : node["translation"].get<std::array<double, 3>>()) {
    EXPECT_EQ(std::fmod(x, 0.0625), 0);
    EXPECT_EQ(static_cast<double>(static_cast<float>(x)), x);
  }
  const std::size_t positions = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
  EXPECT_EQ(json["accessors"][positions]["componentType"], 5123);
  EXPECT_FALSE(json["accessors"][positions].contains("normalized"));
}

TEST_P(CompressedChunks, SurviveDamage) {
  write(ChunkFormat::Glb);
  const auto file = folder / index.chunks[0].levels[0].file;
  const std::string bytes = readBytes(file);
  std::mt19937 random(6);
  for (int round = 0; round < 300; ++round) {
    std::string damaged = bytes;
    damaged[random() % damaged.size()] = static_cast<char>(random() & 255u);
    writeBytes(file, damaged);
    expectReadOrRefused();
  }
}

TEST_P(CompressedChunks, AreRefusedOffTheLattice) {
  chunks[0].levels[0].positions[2].x += 0.01;
  test::expectError(ErrorCode::InvalidArgument, "not on the lattice",
                    [&] { write(ChunkFormat::Glb); });
  chunks[0].levels[0].positions[2].x += 1e4 - 0.01;
  test::expectError(ErrorCode::InvalidArgument, "16 bits", [&] { write(ChunkFormat::Glb); });
}

INSTANTIATE_TEST_SUITE_P(Kinds, CompressedChunks,
                         ::testing::Values(GlbCompression::Quantized, GlbCompression::Meshopt),
                         [](const auto& param) {
                           return param.param == GlbCompression::Meshopt ? "Meshopt" : "Quantized";
                         });

TEST_F(ChunkFiles, KeepPositionsFarFromTheOriginInPly) {
  for (ChunkLevel& level : chunks[0].levels) {
    for (Position& p : level.positions) p = {p.x + 1e9 + 1.0 / 3, p.y, p.z};
  }
  write(ChunkFormat::Ply);
  EXPECT_EQ(readChunk(readChunkIndex(name), 0, name).levels[0].positions,
            chunks[0].levels[0].positions);
}

TEST_F(ChunkFiles, GlbHasAPrimitiveForEachPartAndOneVertexBuffer) {
  write(ChunkFormat::Glb);
  const std::string bytes = readBytes(folder / index.chunks[0].levels[0].file);
  const std::size_t end = bytes.rfind("BIN");
  const auto json = test::parseJson(bytes.substr(20, end - 4 - 20));
  std::vector<std::string> names;
  for (const auto& primitive : json["meshes"][0]["primitives"]) {
    names.push_back(primitive["extras"]["name"]);
    EXPECT_EQ(primitive["attributes"], json["meshes"][0]["primitives"][0]["attributes"]);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"interior", "face+x.regular", "face+x.transition"}));
}

TEST_F(ChunkFiles, GlbOfAnotherOriginIsRefused) {
  write(ChunkFormat::Glb);
  index.origin.x += 1;
  writeChunkIndex(index, name);
  expectUnreadable("its origin is not that of chunks.json");
}

TEST_F(ChunkFiles, IndexKeepsEveryBit) {
  index.grid = "a \"name\"";
  index.voxelSize = 1.0 / 3;
  index.origin = {0.1, -1e300, 5e-324};
  index.transform[3][1] = std::nextafter(2.0, 3.0);
  index.tolerances = {1.0 / 7, 2.0 / 7, 3.0 / 7};
  index.chunks[1].levels[2].maxErrorVoxels = std::sqrt(2.0);
  index.chunks[1].levels[2].intersectionsLeft = 3;
  index.chunks[0].index = Coord(-7, 3, 2);
  writeChunkIndex(index, name);
  const ChunkIndex read = readChunkIndex(name);
  EXPECT_EQ(read.grid, index.grid);
  EXPECT_EQ(read.chunkSize, index.chunkSize);
  EXPECT_EQ(read.tolerances, index.tolerances);
  EXPECT_EQ(read.voxelSize, index.voxelSize);
  EXPECT_EQ(read.transform, index.transform);
  EXPECT_EQ(read.origin, index.origin);
  ASSERT_EQ(read.chunks.size(), index.chunks.size());
  for (std::size_t i = 0; i < read.chunks.size(); ++i) {
    EXPECT_EQ(read.chunks[i].index, index.chunks[i].index);
    for (std::size_t k = 0; k < 3; ++k) {
      const ChunkLevelEntry& a = read.chunks[i].levels[k];
      const ChunkLevelEntry& b = index.chunks[i].levels[k];
      EXPECT_EQ(a.file, b.file);
      EXPECT_EQ(a.vertices, b.vertices);
      EXPECT_EQ(a.interiorTriangles, b.interiorTriangles);
      EXPECT_EQ(a.regularTriangles, b.regularTriangles);
      EXPECT_EQ(a.transitionTriangles, b.transitionTriangles);
      EXPECT_EQ(a.least, b.least);
      EXPECT_EQ(a.greatest, b.greatest);
      EXPECT_EQ(a.maxErrorVoxels, b.maxErrorVoxels);
      EXPECT_EQ(a.transitionErrorVoxels, b.transitionErrorVoxels);
      EXPECT_EQ(a.intersectionsLeft, b.intersectionsLeft);
    }
  }
}

TEST_F(ChunkFiles, HaveNoChunkBeyondTheLast) {
  test::expectError(ErrorCode::InvalidArgument, "there is no chunk 2 among 2",
                    [&] { (void)readChunk(index, 2, name); });
}

TEST_F(ChunkFiles, IndexThatCannotBeReadIsNotWritten) {
  test::expectError(ErrorCode::InvalidArgument, "has no levels",
                    [&] { writeChunkIndex(ChunkIndex(), name); });
  const auto expectRefused = [&](const char* part, auto&& change) {
    ChunkIndex bad = index;
    change(bad);
    test::expectError(ErrorCode::InvalidArgument, part, [&] { writeChunkIndex(bad, name); });
  };
  expectRefused("a number is missing", [](ChunkIndex& bad) { bad.voxelSize = std::nan(""); });
  expectRefused("a number is missing", [](ChunkIndex& bad) { bad.origin.y = std::nan(""); });
  expectRefused("metres are not above 0", [](ChunkIndex& bad) { bad.scale = 0; });
  expectRefused("not sorted", [](ChunkIndex& bad) { std::swap(bad.chunks[0], bad.chunks[1]); });
  expectRefused("its name alone", [](ChunkIndex& bad) { bad.chunks[0].levels[0].file = "../a"; });
  EXPECT_FALSE(std::filesystem::exists(folder / "chunks.json"));
}

TEST_F(ChunkFiles, IndexTellsTheNeighbours) {
  writeChunkIndex(index, name);
  const auto json = test::parseJson(readBytes(folder / "chunks.json"));
  EXPECT_EQ(json["tufa_chunks"], 1);
  EXPECT_EQ(json["chunks"][0]["neighbours"], nlohmann::json({-1, 1, -1, -1, -1, -1}));
  EXPECT_EQ(json["chunks"][1]["neighbours"], nlohmann::json({0, -1, -1, -1, -1, -1}));
}

TEST_F(ChunkFiles, IndexThatSaysWhatCannotBeIsRefused) {
  write(ChunkFormat::Glb);
  const auto good = test::parseJson(readBytes(folder / "chunks.json"));
  const auto expectRefused = [&](const char* pointer, const nlohmann::json& value,
                                 const std::string& part) {
    nlohmann::json json = good;
    json[nlohmann::json::json_pointer(pointer)] = value;
    writeBytes(folder / "chunks.json", json.dump());
    expectUnreadable(part);
  };
  expectRefused("/tufa_chunks", 2, "version is 2, not 1");
  expectRefused("/chunk_size", 24, "power of two");
  expectRefused("/chunk_size", -8, "where a whole number from 0 up is due");
  expectRefused("/voxel_size", 0, "not above 0");
  expectRefused("/origin", {1, 2}, "three coordinates");
  expectRefused("/transform/2", {1, 2, 3}, "four columns");
  expectRefused("/tolerances_voxels", {0.1}, "one level for each tolerance");
  expectRefused("/chunks/1/index", {0, 0, 0}, "not sorted");
  expectRefused("/chunks/1/index", {4e9, 0, 0}, "no integer of the lattice");
  expectRefused("/chunks/1/index", {1ull << 63, 0, 0}, "no integer of the lattice");
  expectRefused("/chunks/1/index", {0xFFFFFFFFFFFFFFFFull, 0, 0}, "no integer of the lattice");
  expectRefused("/chunks/0/levels/0/vertices", 1e300, "has 1e+300 where a whole number");
  expectRefused("/chunks/0/levels/0/vertices", 2.5, "has 2.5 where a whole number");
  expectRefused("/chunks/0/levels/0/file", "../chunk.glb", "by its name alone");
  expectRefused("/chunks/0/levels/0/file", "", "names no file");
  expectRefused("/chunks/0/levels/0/vertices", -1, "where a whole number from 0 up is due");
  expectRefused("/chunks/0/levels/0/max_error_voxels", nullptr, "a number is missing");
  expectRefused("/chunks/0/levels/0/max_error_voxels", -1, "below 0");
  expectRefused("/chunks/0", nlohmann::json::array(), "damaged");
  writeBytes(folder / "chunks.json", "{}");
  expectUnreadable("no list of chunks");
  writeBytes(folder / "chunks.json", "[");
  expectUnreadable("its JSON is damaged");
}

/// The counts of two runs may be the same.
TEST_F(ChunkFiles, OfAnotherRunAreToldByTheirChecksum) {
  for (const ChunkFormat format : {ChunkFormat::Glb, ChunkFormat::Ply}) {
    summed = true;
    write(format);
    const std::filesystem::path file = folder / index.chunks[0].levels[0].file;
    const std::string bytes = readBytes(file);
    EXPECT_EQ(readChunk(readChunkIndex(name), 0, name).levels[0].positions,
              chunks[0].levels[0].positions);
    std::string other = bytes;
    other[other.size() - 1] ^= 1;
    writeBytes(file, other);
    expectUnreadable("another checksum than chunks.json says");
    writeBytes(file, bytes);
    static_cast<void>(readChunk(readChunkIndex(name), 0, name));
  }
}

TEST_F(ChunkFiles, IndexOfDeepJsonIsRefused) {
  const std::string deep = std::string(131015, '[') + std::string(131015, ']');
  for (const std::string& text :
       {deep, "{\"tufa_chunks\":" + deep + "}", "{\"tufa_chunks\":1,\"grid\":" + deep + "}"}) {
    writeBytes(folder / "chunks.json", text);
    expectUnreadable("deeper than 100 levels");
  }
}

TEST_F(ChunkFiles, IndexSurvivesDamage) {
  write(ChunkFormat::Ply);
  const std::string bytes = readBytes(folder / "chunks.json");
  for (std::size_t size = 0; size + 2 < bytes.size(); size += 5) {
    writeBytes(folder / "chunks.json", bytes.substr(0, size));
    expectUnreadable("cannot read");
  }
  std::mt19937 random(4);
  for (int round = 0; round < 800; ++round) {
    std::string damaged = bytes;
    damaged[random() % damaged.size()] = "0123456789-.,[]{}\"e"[random() % 19];
    writeBytes(folder / "chunks.json", damaged);
    expectReadOrRefused();
  }
}

TEST_F(ChunkFiles, AreNotWrittenToWhereTheyCannotBe) {
  test::expectError(ErrorCode::UnwritableFile, "cannot write",
                    [&] { writeChunk(index, chunks[0], name + "missing", ChunkFormat::Glb); });
  test::expectError(ErrorCode::UnwritableFile, "cannot write",
                    [&] { writeChunkIndex(index, name + "missing"); });
}

// The drum's chunks to a folder that is not there yet.
class ChunkFolders : public ChunkFiles {
 protected:
  void add(ChunkFolder& to, std::size_t chunk) const {
    Chunk copy = chunks[chunk];
    to.add(index, std::move(copy));
  }
  void writeAll(ChunkFormat format = ChunkFormat::Glb) {
    ChunkFolder to(place, format);
    for (std::size_t i = 0; i < chunks.size(); ++i) add(to, i);
    to.commit(index);
  }
  /// An index of one of the chunks.
  [[nodiscard]] ChunkIndex indexOfOne(std::size_t chunk) const {
    ChunkIndex one = index;
    one.chunks = {index.chunks[chunk]};
    return one;
  }
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(place)) {
      found.insert(entry.path().filename().string());
    }
    return found;
  }

  const std::string place = (folder / "drum").string();
};

TEST_F(ChunkFolders, HoldChunksOnceTheyAreCommitted) {
  {
    ChunkFolder left(place);
    add(left, 0);
  }
  EXPECT_FALSE(std::filesystem::exists(place));
  ChunkFolder to(place);
  for (std::size_t i = 0; i < chunks.size(); ++i) add(to, i);
  to.commit(index);
  EXPECT_EQ(names().size(), 7U);
  const ChunkIndex read = readChunkIndex(place);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    EXPECT_EQ(read.chunks[i].levels[0].checksum, index.chunks[i].levels[0].checksum);
    expectSame(readChunk(read, i, place).levels[0], [&] {
      ChunkLevel level = chunks[i].levels[0];
      level.maxErrorVoxels = index.chunks[i].levels[0].maxErrorVoxels;
      level.transitionErrorVoxels = index.chunks[i].levels[0].transitionErrorVoxels;
      return level;
    }());
  }
}

TEST_F(ChunkFolders, AreReplacedWholeOrNotAtAll) {
  writeAll();
  const std::set<std::string> before = names();
  const std::string first = readBytes(place + "/chunks.json");
  {
    ChunkFolder left(place, ChunkFormat::Ply);
    add(left, 0);
    ChunkIndex whole = index;  // the second chunk has not been added
    test::expectError(ErrorCode::InvalidArgument, "not added", [&] { left.commit(whole); });
  }
  EXPECT_EQ(names(), before);
  EXPECT_EQ(readBytes(place + "/chunks.json"), first);
  writeBytes(place + "/notes.txt", "mine");
  writeAll(ChunkFormat::Ply);
  EXPECT_EQ(names().size(), 8U);
  for (const std::string& file : names()) EXPECT_FALSE(file.ends_with(".glb")) << file;
  EXPECT_TRUE(names().contains("notes.txt"));
}

TEST_F(ChunkFolders, HoldNoFilesOfChunksThatTheIndexLeavesOut) {
  ChunkFolder to(place);
  add(to, 0), add(to, 1);
  ChunkIndex one = indexOfOne(1);
  to.commit(one);
  EXPECT_EQ(names().size(), 1 + one.chunks[0].levels.size());
}

// Whatever an index says that comes from elsewhere.
TEST_F(ChunkFolders, RemoveFilesOfChunksOnly) {
  writeAll();
  writeBytes(place + "/notes.txt", "mine");
  ChunkIndex other = readChunkIndex(place);
  other.chunks[0].levels[0].file = "notes.txt";
  other.chunks[1].levels[0].file = "chunks.json";
  writeChunkIndex(other, place);
  writeAll();
  EXPECT_TRUE(names().contains("notes.txt"));
  EXPECT_EQ(readChunkIndex(place).chunks.size(), 2U);
}

TEST_F(ChunkFolders, KeepTheOtherChunksWhereThatIsAskedFor) {
  writeAll();
  {
    ChunkFolder some(place);
    add(some, 1);
    ChunkIndex one = indexOfOne(1);
    some.commit(one, true);
    EXPECT_EQ(one.chunks.size(), 1U);
  }
  EXPECT_EQ(readChunkIndex(place).chunks.size(), 2U);
  EXPECT_EQ(names().size(), 7U);
  ChunkFolder others(place);
  add(others, 1);
  ChunkIndex one = indexOfOne(1);
  one.tolerances[0] *= 2;
  one.creaseAngle = 20;
  test::expectError(ErrorCode::InvalidArgument, "differ in the tolerances, the crease angle",
                    [&] { others.commit(one, true); });
}

TEST_F(ChunkFolders, KeepNoChunksOfAnotherSurfaceOrFormat) {
  index.surface = "93c1d0a6e5f27b48";
  writeAll();
  EXPECT_EQ(readChunkIndex(place).surface, index.surface);
  ChunkFolder other(place);
  add(other, 1);
  ChunkIndex one = indexOfOne(1);
  one.surface.back() = one.surface.back() == '0' ? '1' : '0';
  test::expectError(ErrorCode::InvalidArgument, "differ in the surface",
                    [&] { other.commit(one, true); });
  ChunkFolder ply(place, ChunkFormat::Ply);
  add(ply, 1);
  one = indexOfOne(1);
  test::expectError(ErrorCode::InvalidArgument, "differ in the format",
                    [&] { ply.commit(one, true); });
}

TEST_F(ChunkFolders, TellWhereTheyCannotBe) {
  ChunkFolder to((folder / "missing" / "drum").string());
  for (std::size_t i = 0; i < chunks.size(); ++i) add(to, i);
  test::expectError(ErrorCode::UnwritableFile, "cannot make the folder", [&] { to.commit(index); });
}

}  // namespace
}  // namespace tufa
