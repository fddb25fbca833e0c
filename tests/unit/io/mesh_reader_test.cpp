// What the readers make of files of other programs.

#include <gtest/gtest.h>

#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cstring>

#include "support/expect_error.h"
#include "support/scratch_folder.h"
#include "unit/io/text_mesh.h"

namespace tufa {
namespace {

using test::expectUnreadable;
using test::readText;

template <class Number>
void append(std::string& bytes, Number value, bool bigEndian = false) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), &value, sizeof value);
  if (bigEndian) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

const std::string kObjCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 1.5 0\n";

TEST(ObjReader, TakesEveryFormOfCorner) {
  const Mesh mesh = readText("m.obj", "# comment\nmtllib x.mtl\r\no name\n" + kObjCorners +
                                          "vt 0 0\nvn 0 0 1\ng a\nusemtl b\ns off\n"
                                          "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\n"
                                          "f 1/1/1 2/1/1 3/1/1 # tail\nf -5 -4 \\\n -3\n"
                                          "f 1 2 3 4\nf 1 2 3 5 4\nl 1 2\n");
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.quads.size(), 1u);
  ASSERT_EQ(mesh.triangles.size(), 5u + 3u);
  for (std::size_t n = 0; n < 5; ++n) EXPECT_EQ(mesh.triangles[n], Triangle(0, 1, 2));
}

TEST(ObjReader, TakesColorsAndWeights) {
  const Mesh mesh = readText("m.obj", "v +1 2e0 3 0.5 0.5 0.5\nv 0 0 0 1\nv 1e-400 0 1\nf 1 2 3");
  EXPECT_EQ(mesh.positions[0], Position(1, 2, 3));
  EXPECT_EQ(mesh.positions[2], Position(0, 0, 1));
}

TEST(ObjReader, NamesTheLineOfAnError) {
  expectUnreadable("m.obj", "v 0 0 0\nv 1 x 0\n", "line 2: \"x\" is not a number");
  expectUnreadable("m.obj", "v 0 0\n", "line 1: a number is missing");
  expectUnreadable("m.obj", "v 0 0 nan\n", "line 1: \"nan\" is not finite");
  expectUnreadable("m.obj", "v 0 0 1e999\n", "not finite");
  expectUnreadable("m.obj", kObjCorners + "f 1 2 9\nf 1 2 3\n",
                   "line 6: a face names vertex 9 of 5");
  expectUnreadable("m.obj", kObjCorners + "f 1 2 -6\n", "line 6: a face names vertex -6 of 5");
  expectUnreadable("m.obj", kObjCorners + "f 0 1 2\n", "vertex 0");
  expectUnreadable("m.obj", "solid of something else\n", "no vertices");
}

// Each of these lost the first vertex, the face behind the comment, or all.
TEST(ObjReader, TakesMarksAndLineEndsOfOtherSystems) {
  EXPECT_EQ(readText("m.obj", "\xEF\xBB\xBF" + kObjCorners + "f 1 2 3\n").positions.size(), 5U);
  EXPECT_EQ(readText("m.obj", kObjCorners + "# in C:\\dir\\\nf 1 2 3\n").triangles.size(), 1U);
  std::string text = kObjCorners + "f 1 2 3\n";
  std::replace(text.begin(), text.end(), '\n', '\r');
  EXPECT_EQ(readText("m.obj", text).triangles.size(), 1U);
  EXPECT_EQ(readText("m.stl",
                     "\xEF\xBB\xBFsolid s\nfacet normal 0 0 1\nouter loop\n"
                     "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                     "endsolid s\n")
                .triangles.size(),
            1U);
}

TEST(OffReader, TakesColorsAndComments) {
  const Mesh mesh = readText("m.off",
                             "# c\nCOFF 4 2 0 # counts\n\n0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n"
                             "1 1 0 0 0 0 0\n0 1 0 0 0 0 0\n3 0 1 2 255 0 0\n4 0 1 2 3\n");
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.quads.size(), 1u);
}

TEST(OffReader, RefusesWhatItCannotBe) {
  expectUnreadable("m.off", "hello\n", "line 1");
  expectUnreadable("m.off", "4OFF\n", "three dimensions");
  expectUnreadable("m.off", "OFF BINARY\n", "binary");
  expectUnreadable("m.off", "OFF\n900000000 1 0\n0 0 0\n", "more than the file can hold");
  expectUnreadable("m.off", "OFF\n2 1 0\n0 0 0\n", "ends after 1 vertices");
  expectUnreadable("m.off", "OFF\n1 1 0\n0 0 0\n3 0 0 7\n", "line 4: a face names vertex 7 of 1");
  expectUnreadable("m.off", "OFF\n-1 1 0\n", "-1");
  expectUnreadable("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "has -3 vertices");
}

std::string plyHeader(const std::string& format) {
  return "ply\r\nformat " + format +
         " 1.0\r\ncomment c\r\nobj_info o\r\nelement material 1\r\nproperty list uchar float k\r\n"
         "element vertex 3\r\nproperty uchar red\r\nproperty double x\r\nproperty float y\r\n"
         "property short z\r\nelement face 1\r\nproperty uchar flag\r\n"
         "property list ushort uint vertex_index\r\nend_header\n";
}

TEST(PlyReader, TakesAnyLayoutInEveryEncoding) {
  const Mesh text = readText("m.ply", plyHeader("ascii") +
                                          "2 0.5 1\n7 0.25 0 0\n7 1 0 -3\n7 0 1 0\n"
                                          "9 3 0 1 2\n");
  EXPECT_EQ(text.positions[0], Position(0.25, 0, 0));
  EXPECT_EQ(text.positions[1], Position(1, 0, -3));
  ASSERT_EQ(text.triangles.size(), 1u);
  for (const bool big : {false, true}) {
    std::string bytes = plyHeader(big ? "binary_big_endian" : "binary_little_endian");
    append(bytes, std::uint8_t{2});
    append(bytes, 0.5f, big);
    append(bytes, 1.0f, big);
    for (const Position& p : text.positions) {
      append(bytes, std::uint8_t{7});
      append(bytes, p.x, big);
      append(bytes, static_cast<float>(p.y), big);
      append(bytes, static_cast<std::int16_t>(p.z), big);
    }
    append(bytes, std::uint8_t{9});
    append(bytes, std::uint16_t{3}, big);
    for (const std::uint32_t v : {0u, 1u, 2u}) append(bytes, v, big);
    const Mesh binary = readText("m.ply", bytes);
    EXPECT_EQ(binary.positions, text.positions);
    EXPECT_EQ(binary.triangles, text.triangles);
    expectUnreadable("m.ply", bytes.substr(0, bytes.size() - 1), "truncated");
  }
}

TEST(PlyReader, BoundsCountsByTheFile) {
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  expectUnreadable("m.ply",
                   head +
                       "element vertex 4000000000000\nproperty float x\nproperty float y\n"
                       "property float z\nend_header\n",
                   "need more than");
  std::string bytes = head +
                      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 1\nproperty list uint uint vertex_indices\nend_header\n";
  bytes.append(12, '\0');
  append(bytes, std::uint32_t{0xFFFFFFFF});
  expectUnreadable("m.ply", bytes, "longer than the file");
  expectUnreadable(
      "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1", "no y");
  const std::string ascii = "ply\nformat ascii 1.0\n";
  const std::string faces = "element face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  expectUnreadable("m.ply",
                   ascii + "element vertex 9000000\n" + faces + "3 7000000 8000000 8999999\n",
                   "the vertices have no x");
  const std::string one =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  expectUnreadable("m.ply", ascii + one + one + faces + "0 0 0\n0 0 0\n3 0 0 0\n",
                   "two elements \"vertex\"");
  expectUnreadable("m.ply", "ply\nelement vertex 0\nend_header\n", "no format");
  expectUnreadable("m.ply", "ply\nformat ascii 1.0\n", "does not end");
  expectUnreadable("m.ply", "plywood\n", "not a .ply");
}

std::string binaryStl(const std::string& header, std::uint32_t claimed, std::uint32_t triangles) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  append(bytes, claimed);
  for (std::uint32_t n = 0; n < triangles; ++n) {
    for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, -0.f, 1.f, 0.f}) {
      append(bytes, x);
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST(StlReader, TakesBinaryFilesThatBeginWithSolid) {
  const Mesh mesh = readText("m.STL", binaryStl("solid of a program that knows no better", 2, 2));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions.size(), 3u);
}

TEST(PlyReader, RefusesFacesWithoutCorners) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n";
  const std::string body = "end_header\n0 0 0\n1 0 0\n0 1 0\n";
  expectUnreadable("m.ply", head + "property list uchar int indices\n" + body + "3 0 1 2\n",
                   "no list vertex_indices");
  expectUnreadable("m.ply",
                   head + "property list uchar float vertex_indices\n" + body + "3 0 1 1.5\n",
                   "no whole number");
}

// As of a program that was stopped before it knew the count.
TEST(StlReader, RefusesMoreTrianglesThanItClaims) {
  std::string bytes(80, ' ');
  append(bytes, std::uint32_t{0});
  bytes.append(100, '\0');
  expectUnreadable("m.stl", bytes, "claims 0 triangles and has bytes for 2");
  bytes.resize(84 + 49);
  EXPECT_TRUE(readText("m.stl", bytes).triangles.empty());
  bytes.replace(0, 5, "solid");
  EXPECT_TRUE(readText("m.stl", bytes).triangles.empty());
}

TEST(StlReader, TakesTextInEitherCase) {
  const Mesh mesh = readText("m.stl",
                             "SOLID facet vertex name\n FACET NORMAL 0 0 1\n OUTER LOOP\n"
                             "  VERTEX 0 0 0\n  VERTEX 1 0 0\n  vertex -0 1e0 0\n ENDLOOP\n"
                             " ENDFACET\nENDSOLID facet vertex name\n");
  EXPECT_EQ(mesh.triangles.size(), 1u);
}

TEST(StlReader, RefusesTruncatedFiles) {
  expectUnreadable("m.stl", binaryStl("x", 3, 2), "3 triangles need 234 bytes");
  expectUnreadable("m.stl", binaryStl("x", 0xFFFFFFFF, 1), "truncated");
  expectUnreadable("m.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "truncated");
  expectUnreadable("m.stl", "solid x\nhello\nendsolid\n", "line 2");
  expectUnreadable("m.stl", "short", "too short");
}

TEST(MeshReader, ReadsTheSampleMeshes) {
  const std::filesystem::path folder = TUFA_TEST_DATA;
  if (!std::filesystem::exists(folder / "ode_spot.obj")) GTEST_SKIP() << "no samples in " << folder;
  const auto triangles = [&](const char* name) { return readMesh(folder / name).triangleCount(); };
  EXPECT_EQ(triangles("ode_spot.obj"), 23062u);
  EXPECT_EQ(triangles("cgal_knot1.off"), 6400u);
  EXPECT_EQ(triangles("tri_plate_holes.STL"), 1252u);
  EXPECT_EQ(triangles("occ_propeller.stl"), 7375u);
  EXPECT_EQ(triangles("mani_mengerSponge3.glb"), 21598u);
}

}  // namespace
}  // namespace tufa
