// Chains of levels through files and back.

#include <gtest/gtest.h>

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/expect_error.h"
#include "support/json.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using Json = nlohmann::json;
using test::expectError;
using test::readBytes;
using test::ScratchFolder;
using test::writeBytes;

LodChain chainOf(Shape kind, double voxelSize, int levels = 3, int threads = 0) {
  ShapeOptions shape;
  shape.voxelSize = voxelSize;
  LodOptions options;
  options.levels = levels;
  options.contour.threads = threads;
  return buildLods(*makeShape(kind, shape), options);
}

std::uint32_t wordAt(const std::string& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

Json documentOf(const std::string& bytes) {
  return test::parseJson(bytes.substr(20, wordAt(bytes, 12)));
}

/// The file with another document, which must not be longer.
std::string withDocument(std::string bytes, const Json& document) {
  std::string text = document.dump();
  text.resize(wordAt(bytes, 12), ' ');
  return bytes.replace(20, text.size(), text);
}

/// Reads one level of a .glb: in the file, only the finest stands in the scene.
Mesh readLevel(const std::filesystem::path& path, std::size_t level) {
  const std::string bytes = readBytes(path);
  Json document = documentOf(bytes);
  document.erase("scenes");
  document["scene"] = 0;
  document["scenes"].push_back({{"nodes", {level}}});
  const std::filesystem::path copy = path.string() + ".level.glb";
  writeBytes(copy, withDocument(bytes, document));
  const Mesh mesh = readMesh(copy);
  std::filesystem::remove(copy);
  return mesh;
}

std::vector<std::array<double, 3>> sortedPositions(const Mesh& mesh) {
  std::vector<std::array<double, 3>> all;
  for (const Position& p : mesh.positions) all.push_back({p.x, p.y, p.z});
  std::sort(all.begin(), all.end());
  return all;
}

TEST(LodFiles, NamesLinksAndDescribesTheLevels) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Bracket, 0.03);
  LodWriteOptions options;
  options.name = "part";
  options.scale = 0.5;
  LodWriteReport report;
  writeLods(chain, folder / "part.glb", options, &report);
  EXPECT_EQ(report.files, std::vector{folder / "part.glb"});
  EXPECT_EQ(folder.fileCount(), 1);
  const Json json = documentOf(readBytes(folder / "part.glb"));
  ASSERT_EQ(chain.levels.size(), 3u);
  ASSERT_EQ(json["nodes"].size(), 3u);
  EXPECT_EQ(json["extensionsUsed"], Json({"MSFT_lod"}));
  EXPECT_FALSE(json.contains("extensionsRequired"));
  EXPECT_EQ(json["scenes"][0]["nodes"], Json({0}));
  EXPECT_EQ(json["scenes"].size(), 1u);
  EXPECT_EQ(json["nodes"][0]["extensions"]["MSFT_lod"]["ids"], Json({1, 2}));
  for (std::size_t i = 0; i < 3; ++i) {
    const Lod& lod = chain.levels[i];
    const std::string name = "part_LOD" + std::to_string(i);
    const Json& node = json["nodes"][i];
    const Json& mesh = json["meshes"].at(node["mesh"].get<std::size_t>());
    EXPECT_EQ(node["name"], name);
    EXPECT_EQ(mesh["name"], name);
    const Json& extras = node["extras"];
    EXPECT_EQ(extras["level"], i);
    EXPECT_EQ(extras["triangles"], lod.mesh.triangleCount());
    EXPECT_EQ(extras["vertices"], report.vertices.at(i));
    EXPECT_EQ(extras["max_error_voxels"], lod.certificate.maxErrorVoxels);
    EXPECT_DOUBLE_EQ(extras["max_error_metres"].get<double>(), 0.5 * lod.certificate.maxErrorWorld);
    EXPECT_EQ(json["nodes"][0]["extras"]["MSFT_screencoverage"][i], lod.screenCoverage);
    const Json& primitive = mesh["primitives"][0];
    EXPECT_EQ(json["accessors"].at(primitive["indices"].get<std::size_t>())["count"],
              3 * lod.mesh.triangleCount());
    EXPECT_EQ(mesh["extras"]["level"], i);
  }
}

TEST(LodFiles, HoldASecondSceneOnlyIfAskedTo) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Torus, 0.1, 2);
  LodWriteOptions options;
  writeLods(chain, folder / "t.glb", options);
  EXPECT_EQ(documentOf(readBytes(folder / "t.glb"))["scenes"].size(), 1u);
  options.allLevelsScene = true;
  writeLods(chain, folder / "t.glb", options);
  const Json json = documentOf(readBytes(folder / "t.glb"));
  ASSERT_EQ(json["scenes"].size(), 2u);
  EXPECT_EQ(json["scene"], 0);
  EXPECT_EQ(json["scenes"][0]["nodes"], Json({0}));
  EXPECT_EQ(json["scenes"][1]["nodes"], Json({0, 1}));
  EXPECT_EQ(json["scenes"][1]["name"], "mesh_all_levels");
}

TEST(LodFiles, OneLevelNeedsNoLinks) {
  const ScratchFolder folder;
  writeLods(chainOf(Shape::Sphere, 0.1, 1), folder / "one.glb");
  const Json json = documentOf(readBytes(folder / "one.glb"));
  EXPECT_FALSE(json.contains("extensionsUsed"));
  EXPECT_EQ(json["scenes"].size(), 1u);
}

TEST(LodFiles, AnEmptyChainIsAnEmptyScene) {
  const ScratchFolder folder;
  writeLods({}, folder / "empty.glb");
  EXPECT_EQ(readMesh(folder / "empty.glb").triangleCount(), 0u);
}

TEST(LodFiles, CountsVerticesOfEmptyLevelsToo) {
  const ScratchFolder folder;
  LodChain chain = chainOf(Shape::Sphere, 0.1, 2);
  chain.levels[0].mesh = {};
  for (const char* name : {"one.glb", "one.usda", "many{}.glb", "many{}.ply"}) {
    LodWriteReport report;
    writeLods(chain, folder / name, {}, &report);
    ASSERT_EQ(report.vertices.size(), 2u) << name;
    EXPECT_EQ(report.vertices[0], 0u) << name;
    EXPECT_GT(report.vertices[1], 0u) << name;
  }
}

// Each call of the progress may be the last.
TEST(LodFiles, CanBeCancelledWhileTheyAreWritten) {
  const LodChain chain = chainOf(Shape::Sphere, 0.1, 2);
  for (const char* name : {"one.usda", "many{}.obj"}) {
    std::size_t calls = 0;
    LodWriteOptions options;
    double last = 0;
    options.progress = [&](std::string_view, double fraction) {
      last = fraction;
      return ++calls > 0;
    };
    const ScratchFolder whole;
    writeLods(chain, whole / name, options);
    EXPECT_EQ(last, 1) << name;
    ASSERT_GT(calls, 4u) << name;
    for (std::size_t allowed = 0; allowed < calls; ++allowed) {
      const ScratchFolder folder;
      std::size_t left = allowed;
      options.progress = [&](std::string_view, double) { return left-- > 0; };
      test::expectError(ErrorCode::Cancelled, "cancelled",
                        [&] { writeLods(chain, folder / name, options); });
      for (const auto& file : std::filesystem::directory_iterator(folder / "")) {
        const std::string finished = file.path().filename().string();
        EXPECT_EQ(readBytes(file.path()), readBytes(whole / finished)) << finished;
      }
    }
  }
}

// The arrays of a mesh were packed in one go, for half a second.
TEST(LodFiles, CanBeCancelledBetweenArraysThatArePacked) {
  const LodChain chain = chainOf(Shape::Sphere, 0.1, 1);
  const ScratchFolder folder;
  const auto callsOf = [&](GlbCompression compression, auto write, auto options) {
    int calls = 0;
    options.compression = compression;
    options.progress = [&](std::string_view, double) { return ++calls > 0; };
    write(options);
    return calls;
  };
  const auto writeChain = [&](const LodWriteOptions& options) {
    writeLods(chain, folder / "s.glb", options);
  };
  const auto writeOne = [&](const WriteOptions& options) {
    write(chain.levels[0].mesh, folder / "s.glb", options);
  };
  const auto more = [&](auto write, auto options) {
    return callsOf(GlbCompression::Meshopt, write, options) -
           callsOf(GlbCompression::Quantized, write, options);
  };
  EXPECT_EQ(more(writeChain, LodWriteOptions()), 3) << "positions, normals, triangles";
  EXPECT_EQ(more(writeOne, WriteOptions()), 3);
}

TEST(LodFiles, FloatsKeepEveryLevelAsItIs) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Bracket, 0.04);
  writeLods(chain, folder / "part.glb");
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const Mesh& mesh = chain.levels[i].mesh;
    const Mesh back = readLevel(folder / "part.glb", i);
    EXPECT_EQ(back.triangleCount(), mesh.triangleCount());
    EXPECT_EQ(sortedPositions(back), sortedPositions(mesh));
    const CheckReport report = check(back);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.selfIntersectingPairs, 0u);
    EXPECT_EQ(report.eulerCharacteristic, chain.levels[i].certificate.eulerCharacteristic);
  }
  EXPECT_EQ(sortedPositions(readMesh(folder / "part.glb")), sortedPositions(chain.levels[0].mesh));
}

class Compressed : public ::testing::TestWithParam<GlbCompression> {};
INSTANTIATE_TEST_SUITE_P(Kinds, Compressed,
                         ::testing::Values(GlbCompression::Quantized, GlbCompression::Meshopt),
                         [](const auto& test) {
                           return test.param == GlbCompression::Meshopt ? "Meshopt" : "Quantized";
                         });

TEST_P(Compressed, KeepsTheTopologyOfEveryLevel) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Gyroid, 0.08);
  LodWriteOptions options;
  options.compression = GetParam();
  LodWriteReport report;
  writeLods(chain, folder / "g.glb", options, &report);
  EXPECT_TRUE(report.floatLevels.empty());
  const Json json = documentOf(readBytes(folder / "g.glb"));
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const Mesh& mesh = chain.levels[i].mesh;
    const Mesh back = readLevel(folder / "g.glb", i);
    const CheckReport found = check(back), wanted = check(mesh);
    EXPECT_TRUE(found.closed && found.manifold && found.oriented);
    EXPECT_EQ(found.degenerateFaces, 0u);
    EXPECT_EQ(found.vertices, wanted.vertices);
    EXPECT_EQ(found.triangles, wanted.triangles);
    EXPECT_EQ(found.eulerCharacteristic, wanted.eulerCharacteristic);
    EXPECT_NEAR(found.volume, wanted.volume, 1e-3 * wanted.volume);
    const double most = json["nodes"][i]["extras"]["quantization_error_metres"];
    EXPECT_LT(most, 0.01 * chain.voxelSize);
    const std::vector<double> moved = distancesTo(mesh, back.positions);
    EXPECT_LE(*std::max_element(moved.begin(), moved.end()), 1.0001 * most);
  }
}

TEST_P(Compressed, IsSmaller) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Torus, 0.04);
  LodWriteOptions options;
  writeLods(chain, folder / "plain.glb", options);
  options.compression = GetParam();
  writeLods(chain, folder / "small.glb", options);
  const double most = GetParam() == GlbCompression::Meshopt ? 0.5 : 0.75;
  EXPECT_LT(static_cast<double>(std::filesystem::file_size(folder / "small.glb")),
            most * static_cast<double>(std::filesystem::file_size(folder / "plain.glb")));
}

/// A tetrahedron whose first corner is split in two by a distance.
LodChain tetrahedron(double distance) {
  LodChain chain;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {distance, 0, 0}};
  mesh.triangles = {{0, 2, 4}, {4, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  chain.levels.emplace_back();
  chain.levels[0].mesh = std::move(mesh);
  return chain;
}

TEST_P(Compressed, FallsBackToFloatsWhereVerticesWouldFallTogether) {
  const ScratchFolder folder;
  LodWriteOptions options;
  options.compression = GetParam();
  LodWriteReport report;
  writeLods(tetrahedron(1e-6), folder / "t.glb", options, &report);
  EXPECT_EQ(report.floatLevels, std::vector<std::size_t>{0});
  EXPECT_EQ(readMesh(folder / "t.glb").positions.size(), 5u);
  writeLods(tetrahedron(0.1), folder / "t.glb", options, &report);
  EXPECT_TRUE(report.floatLevels.empty());
  EXPECT_EQ(readMesh(folder / "t.glb").positions.size(), 5u);
}

TEST_P(Compressed, HoldsMeshesOfWriteMeshes) {
  const ScratchFolder folder;
  const Mesh torus = chainOf(Shape::Torus, 0.1, 1).levels[0].mesh;
  WriteOptions options;
  options.compression = GetParam();
  options.up = UpAxis::Z;
  options.scale = 0.5;
  WriteReport report;
  writeMeshes({{"fine", tetrahedron(1e-6).levels[0].mesh}, {"torus", torus}}, folder / "m.glb",
              options, &report);
  EXPECT_EQ(report.floatMeshes, std::vector<std::string>{"fine"});
  write(torus, folder / "t.glb", options, &report);
  EXPECT_TRUE(report.floatMeshes.empty());
  const CheckReport found = check(readMesh(folder / "t.glb")), wanted = check(torus);
  EXPECT_TRUE(found.watertight());
  EXPECT_EQ(found.vertices, wanted.vertices);
  EXPECT_NEAR(found.volume, wanted.volume / 8, 1e-3 * wanted.volume);
  EXPECT_EQ(check(readMesh(folder / "m.glb")).triangles, wanted.triangles + 6);
}

TEST_P(Compressed, RefusesDamage) {
  const ScratchFolder folder;
  LodWriteOptions options;
  options.compression = GetParam();
  writeLods(chainOf(Shape::Sphere, 0.2, 2), folder / "s.glb", options);
  const std::string bytes = readBytes(folder / "s.glb");
  for (std::size_t at = 20; at < bytes.size(); at += 37) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x15);
    writeBytes(folder / "d.glb", damaged);
    try {
      const Mesh mesh = readMesh(folder / "d.glb");
      for (const Triangle& t : mesh.triangles) {
        for (const VertexIndex v : t.vertices) ASSERT_LT(v, mesh.positions.size());
      }
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::UnreadableFile);
    }
  }
}

TEST(LodFiles, ScaleDoesNotBringVerticesTogether) {
  const ScratchFolder folder;
  // Neighbours in single precision, which a factor of 1/3 would round to one.
  LodChain chain = tetrahedron(0.1);
  std::vector<Position>& positions = chain.levels[0].mesh.positions;
  const float low = 1.0F, high = std::nextafter(low, 2.0F);
  positions[0].x = low;
  positions[4].x = high;
  positions[1].x = 2;
  for (const double scale : {1.0, 1 / 3.0, 0.7, 1e-30, 1e6}) {
    LodWriteOptions options;
    options.scale = scale;
    writeLods(chain, folder / "t.glb", options);
    EXPECT_EQ(readMesh(folder / "t.glb").positions.size(), 5u) << scale;
  }
  positions[4].x = std::nextafter(1.0, 2.0);
  positions[1].x = 1e9;  // so far that even relative to the middle they are the same
  expectError(ErrorCode::LimitExceeded, "single precision",
              [&] { writeLods(chain, folder / "t.glb"); });
}

TEST(LodFiles, TurnsAndScalesTheVolume) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Terrain, 0.08, 2);
  LodWriteOptions options;
  options.up = UpAxis::Z;
  options.scale = 10;
  for (const GlbCompression compression :
       {GlbCompression::None, GlbCompression::Quantized, GlbCompression::Meshopt}) {
    options.compression = compression;
    writeLods(chain, folder / "t.glb", options);
    const Mesh back = readMesh(folder / "t.glb");
    const Mesh& mesh = chain.levels[0].mesh;
    const CheckReport found = check(back), wanted = check(mesh);
    EXPECT_NEAR(found.volume, 1000 * wanted.volume, wanted.volume);
    double top = -1e9, backTop = -1e9;
    for (const Position& p : mesh.positions) top = std::max(top, p.z);
    for (const Position& p : back.positions) backTop = std::max(backTop, p.y);
    EXPECT_NEAR(backTop, 10 * top, 1e-3);
  }
}

TEST(LodFiles, SplitsNormalsAtCreases) {
  const ScratchFolder folder;
  LodChain chain;
  chain.levels.emplace_back();
  Mesh& cube = chain.levels[0].mesh;
  for (const double z : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      for (const double x : {0.0, 1.0}) cube.positions.emplace_back(x, y, z);
    }
  }
  cube.quads = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  const auto verticesAt = [&](double angle) {
    LodWriteOptions options;
    options.creaseAngle = angle;
    LodWriteReport report;
    writeLods(chain, folder / "c.glb", options, &report);
    return report.vertices.at(0);
  };
  EXPECT_EQ(verticesAt(180), 8u);
  EXPECT_EQ(verticesAt(91), 8u);
  EXPECT_EQ(verticesAt(89), 24u);
  EXPECT_EQ(verticesAt(0), 24u);
  EXPECT_TRUE(check(readMesh(folder / "c.glb")).watertight());
}

TEST(LodFiles, NormalsOfFlatSidesAreTheirs) {
  const ScratchFolder folder;
  LodChain chain = tetrahedron(0.5);
  writeLods(chain, folder / "t.glb");
  const std::string bytes = readBytes(folder / "t.glb");
  const Json json = documentOf(bytes);
  const std::size_t start = 28 + wordAt(bytes, 12);
  const Json& attributes = json["meshes"][0]["primitives"][0]["attributes"];
  const Json& accessor = json["accessors"][attributes["NORMAL"].get<std::size_t>()];
  const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  std::size_t axes = 0, diagonals = 0;
  for (std::size_t n = 0; n < accessor["count"]; ++n) {
    std::array<float, 3> normal;
    std::memcpy(normal.data(),
                bytes.data() + start + view["byteOffset"].get<std::size_t>() + 12 * n,
                sizeof normal);
    const float sum = normal[0] + normal[1] + normal[2];
    if (std::abs(sum + 1) < 1e-6F) ++axes;
    if (std::abs(sum - std::sqrt(3.0F)) < 1e-6F) ++diagonals;
  }
  EXPECT_EQ(diagonals, 3u);
  EXPECT_EQ(axes, 4u + 4u + 3u);  // two sides hold the vertex in the middle of their edge, too
}

TEST(LodFiles, IndicesAreAsShortAsTheyCanBe) {
  const ScratchFolder folder;
  ShapeOptions shape;
  shape.voxelSize = 0.015;
  LodOptions options;
  options.tolerances = {0, 1};
  const LodChain chain = buildLods(*makeShape(Shape::Sphere, shape), options);
  LodWriteReport report;
  writeLods(chain, folder / "g.glb", {}, &report);
  const Json json = documentOf(readBytes(folder / "g.glb"));
  ASSERT_GT(report.vertices.front(), 65535u);
  ASSERT_LT(report.vertices.back(), 65535u);
  for (std::size_t i = 0; i < chain.levels.size(); ++i) {
    const std::size_t indices = json["meshes"][i]["primitives"][0]["indices"];
    EXPECT_EQ(json["accessors"][indices]["componentType"],
              report.vertices[i] > 65535 ? 5125 : 5123);
  }
}

TEST(LodFiles, VerticesStandInTheOrderOfTheirFirstUse) {
  const ScratchFolder folder;
  writeLods(chainOf(Shape::Torus, 0.08, 1), folder / "t.glb");
  const Mesh mesh = readMesh(folder / "t.glb");
  VertexIndex next = 0;
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t.vertices) {
      ASSERT_LE(v, next);
      next = std::max(next, v + 1);
    }
  }
}

TEST(LodFiles, AreTheSameForAnyNumberOfThreads) {
  const ScratchFolder folder;
  for (const GlbCompression compression : {GlbCompression::None, GlbCompression::Meshopt}) {
    for (const int threads : {1, 2}) {
      LodWriteOptions options;
      options.compression = compression;
      options.threads = threads;
      writeLods(chainOf(Shape::Bracket, 0.04, 3, threads),
                folder / (std::to_string(threads) + ".glb"), options);
    }
    EXPECT_TRUE(readBytes(folder / "1.glb") == readBytes(folder / "2.glb"));
  }
}

TEST(LodFiles, BracesMakeOneFileForEachLevel) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Sphere, 0.1, 2);
  for (const char* ending : {".ply", ".obj", ".stl", ".off", ".glb"}) {
    LodWriteReport report;
    writeLods(chain, folder / (std::string("s_LOD{}") + ending), {}, &report);
    ASSERT_EQ(report.files.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(report.files[i], folder / ("s_LOD" + std::to_string(i) + ending));
      EXPECT_EQ(readMesh(report.files[i]).triangleCount(), chain.levels[i].mesh.triangleCount());
    }
  }
  EXPECT_EQ(folder.fileCount(), 10);
  const Json json = documentOf(readBytes(folder / "s_LOD1.glb"));
  EXPECT_EQ(json["nodes"][0]["name"], "mesh_LOD1");
  EXPECT_EQ(lodFile("a{}/b.glb", 3), "a{}/b.glb");
  EXPECT_EQ(lodFile("a{}/b{}_{}.glb", 12), "a{}/b12_12.glb");
}

TEST(LodFiles, RefusesWrongUseAndLeavesNothing) {
  const ScratchFolder folder;
  const LodChain chain = chainOf(Shape::Sphere, 0.2, 2);
  const auto refuses = [&](ErrorCode code, const char* part, const char* name, auto change) {
    LodWriteOptions options;
    change(options);
    expectError(code, part, [&] { writeLods(chain, folder / name, options); });
  };
  const auto same = [](LodWriteOptions&) {};
  refuses(ErrorCode::InvalidArgument, "only .glb", "s.ply", same);
  refuses(ErrorCode::InvalidArgument, "ending", "s.xyz", same);
  refuses(ErrorCode::InvalidArgument, "scale", "s.glb", [](auto& o) { o.scale = 0; });
  refuses(ErrorCode::InvalidArgument, "crease", "s.glb", [](auto& o) { o.creaseAngle = -1; });
  refuses(ErrorCode::UnwritableFile, "no folder", "none/s.glb", same);
  refuses(ErrorCode::Cancelled, "cancelled", "s.glb",
          [](auto& o) { o.progress = [](std::string_view, double) { return false; }; });
  EXPECT_EQ(folder.fileCount(), 0);
}

}  // namespace
}  // namespace tufa
