// What the reader of .glb makes of files of other programs, and of hostile ones.

#include <gtest/gtest.h>

#include <tufa/io.h>

#include "support/expect_error.h"
#include "support/glb_bytes.h"
#include "support/scratch_folder.h"
#include "unit/io/text_mesh.h"

namespace tufa {
namespace {

using test::expectUnreadable;
using test::glbOf;
using test::glbTriangle;
using test::readText;

TEST(GlbReader, GoesThroughNodeTransforms) {
  // A quarter turn about z and a scale of 2, below a translation.
  const Mesh mesh =
      readText("m.glb", glbTriangle({.nodes = R"([{"children":[1],"translation":[10,0,0]},
      {"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,2,2]}])"}));
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_NEAR(mesh.positions[1].x, 10, 1e-12);
  EXPECT_NEAR(mesh.positions[1].y, 2, 1e-12);
  EXPECT_NEAR(mesh.positions[2].x, 8, 1e-12);
  EXPECT_EQ(mesh.triangles[0], Triangle(0, 1, 2));
}

TEST(GlbReader, TurnsMirroredMeshesAround) {
  const Mesh mesh = readText(
      "m.glb",
      glbTriangle({.nodes = R"([{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]}])"}));
  EXPECT_EQ(mesh.positions[1], Position(4, 6, 7));
  EXPECT_EQ(mesh.triangles[0], Triangle(0, 2, 1));
}

TEST(GlbReader, RefusesDamagedFiles) {
  expectUnreadable("m.glb", glbTriangle({.nodes = R"([{"mesh":7}])"}), "damaged");
  expectUnreadable("m.glb", glbTriangle({.indexCount = "4000000000"}), "beyond the binary chunk");
  expectUnreadable("m.glb", glbTriangle({.nodes = R"([{"children":[0]}])"}), "two parents");
  expectUnreadable("m.glb", glbOf("{not json"), "damaged");
  expectUnreadable("m.glb", glbOf(R"({"extensionsRequired":["KHR_draco_mesh_compression"]})"),
                   "draco");
  expectUnreadable("m.glb", glbTriangle({.nodes = "[{}]"}).substr(0, 100), "truncated");
  expectUnreadable("m.glb", "glTF but not really", "glTF version");
}

/// Copying and freeing it took a frame of the stack for each level: 131,015 of them overflowed it.
TEST(GlbReader, RefusesDeepJson) {
  for (const std::size_t depth : {101U, 131015U}) {
    const std::string deep = std::string(depth, '[') + std::string(depth, ']');
    for (const std::string& place : {R"(,"extras":)" + deep, R"(,"extensionsRequired":)" + deep}) {
      expectUnreadable("m.glb", glbTriangle({.more = place}), "deeper than 100 levels");
    }
    expectUnreadable("m.glb", glbOf(deep), "deeper than 100 levels");
    expectUnreadable("m.glb", glbTriangle({.nodes = deep}), "deeper than 100 levels");
  }
  const std::string deep = std::string(90, '[') + std::string(90, ']');
  const std::string quoted = R"(,"name":"\")" + std::string(200, '[') + "\"";
  EXPECT_EQ(
      readText("m.glb", glbTriangle({.more = quoted + R"(,"extras":)" + deep})).triangles.size(),
      1U);
}

// Of two materials, say: the parts came apart.
TEST(GlbReader, JoinsThePrimitivesOfAMesh) {
  const Mesh mesh =
      readText("m.glb", glbTriangle({.nodes = R"([{"children":[1],"mesh":0},{"mesh":0}])",
                                     .primitives = R"([{"attributes":{"POSITION":0},"indices":1},
                                              {"attributes":{"POSITION":0},"indices":1}])"}));
  EXPECT_EQ(mesh.positions.size(), 6U);  // of two nodes
  ASSERT_EQ(mesh.triangles.size(), 4U);
  EXPECT_EQ(mesh.triangles[1], Triangle(0, 1, 2));
  EXPECT_EQ(mesh.triangles[3], Triangle(3, 4, 5));
}

/// A number that is no count was converted all the same, which C++ leaves undefined.
TEST(GlbReader, TakesWholeNumbersOnlyForCounts) {
  EXPECT_EQ(readText("m.glb", glbTriangle({.scene = "0.0", .vertexCount = "3.0"})).triangles.size(),
            1U);
  for (const char* number : {"1e300", "-1", "0.5", "-0.5", "null", "true", "\"0\"", "[0]"}) {
    expectUnreadable("m.glb", glbTriangle({.scene = number}), "where a whole number");
    expectUnreadable("m.glb", glbTriangle({.vertexCount = number}), "where a whole number");
    expectUnreadable("m.glb", glbTriangle({.indexCount = number}), "where a whole number");
    const std::string nodes = std::string(R"([{"mesh":)") + number + "}]";
    expectUnreadable("m.glb", glbTriangle({.nodes = nodes}), "where a whole number");
    const std::string mode =
        std::string(R"([{"attributes":{"POSITION":0},"indices":1,"mode":)") + number + "}]";
    expectUnreadable("m.glb", glbTriangle({.primitives = mode}), "where a whole number");
  }
  expectUnreadable("m.glb", glbTriangle({.scene = "18446744073709551615"}), "damaged");
}

TEST(GlbReader, TakesUnsignedIndicesOnly) {
  for (const char* type : {"5120", "5122", "5126"}) {
    expectUnreadable("m.glb", glbTriangle({.indexCount = "1", .indexType = type}),
                     "must be unsigned integers");
  }
}

/// 20,000 parts of one accessor claimed 48 GB.
TEST(GlbReader, BoundsWhatAFewBytesMayTake) {
  std::string binary;
  constexpr std::size_t kVertices = 10000;
  for (std::size_t n = 0; n < 3 * kVertices; ++n) binary += test::bytesOf(static_cast<float>(n));
  const std::string count = std::to_string(kVertices);
  const auto document = [&](std::size_t parts, std::size_t nodes) {
    std::string json = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0)";
    for (std::size_t n = 1; n < nodes; ++n) json += "," + std::to_string(n);
    json += R"(]}],"nodes":[{"mesh":0})";
    for (std::size_t n = 1; n < nodes; ++n) json += R"(,{"mesh":0})";
    json += R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}})";
    for (std::size_t n = 1; n < parts; ++n) json += R"(,{"attributes":{"POSITION":0}})";
    json += R"(]}],"buffers":[{"byteLength":)" + std::to_string(binary.size()) +
            R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(binary.size()) +
            R"(}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
            count + "}]}";
    return glbOf(json, binary);
  };
  for (const std::string& bytes : {document(20000, 1), document(1, 20000), document(200, 100)}) {
    test::expectError(ErrorCode::LimitExceeded, "100 times as many as the file has",
                      [&] { (void)readText("m.glb", bytes); });
  }
  EXPECT_EQ(readText("m.glb", document(13, 2)).positions.size(), 2 * kVertices);
}

}  // namespace
}  // namespace tufa
