// OpenUSD as text. What an independent reader makes of it: tests/usd.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "support/expect_error.h"
#include "support/shape.h"

namespace tufa {
namespace {

using test::expectError;

std::string usdaOf(const Mesh& mesh, const WriteOptions& options = {}) {
  std::ostringstream stream;
  write(mesh, stream, MeshFormat::Usda, options);
  return stream.str();
}

/// The numbers between the brackets of the first array with that head.
std::vector<double> arrayOf(const std::string& text, const std::string& head) {
  std::vector<double> numbers;
  const std::size_t begin = text.find(head + " = [");
  if (begin == std::string::npos) return numbers;
  const char* at = text.data() + begin + head.size() + 4;
  const char* const end = text.data() + text.find(']', begin + head.size());
  while (at < end) {
    double number = 0;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error == std::errc()) numbers.push_back(number);
    at = error == std::errc() ? next : at + 1;
  }
  return numbers;
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Usda, HasTheFacesAndTheirCornersNormals) {
  const Mesh mesh = contour(*test::shapeOf(Shape::Box, 0.1));
  const std::string text = usdaOf(mesh);
  EXPECT_EQ(text.rfind("#usda 1.0\n(\n    defaultPrim = \"mesh\"\n", 0), 0u);
  const auto points = arrayOf(text, "point3f[] points");
  ASSERT_EQ(points.size(), 3 * mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    ASSERT_EQ(static_cast<float>(points[3 * v]), static_cast<float>(mesh.positions[v].x));
  }
  const auto counts = arrayOf(text, "int[] faceVertexCounts");
  const auto indices = arrayOf(text, "int[] faceVertexIndices");
  const auto normals = arrayOf(text, "normal3f[] normals");
  ASSERT_EQ(counts.size(), mesh.triangleCount());
  ASSERT_EQ(indices.size(), 3 * mesh.triangleCount());
  ASSERT_EQ(normals.size(), 3 * indices.size());
  EXPECT_TRUE(holds(text, "(interpolation = \"faceVarying\")"));
  EXPECT_TRUE(holds(text, "subdivisionScheme = \"none\""));
  const std::vector<Triangle> triangles = triangulate(mesh);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    ASSERT_EQ(static_cast<VertexIndex>(indices[i]), triangles[i / 3].vertices[i % 3]);
  }
}

TEST(Usda, KeepsQuadsWhereNormalsAreNotSplit) {
  ContourOptions uniform;
  uniform.uniform = true;
  const Mesh mesh = contour(*test::shapeOf(Shape::Sphere, 0.1), uniform);
  ASSERT_FALSE(mesh.quads.empty());
  WriteOptions options;
  options.creaseAngle = 180;
  const std::string text = usdaOf(mesh, options);
  const auto counts = arrayOf(text, "int[] faceVertexCounts");
  EXPECT_EQ(counts.size(), mesh.quads.size() + mesh.triangles.size());
  EXPECT_EQ(static_cast<std::size_t>(std::count(counts.begin(), counts.end(), 4)),
            mesh.quads.size());
  EXPECT_EQ(arrayOf(text, "normal3f[] normals").size(), 3 * mesh.positions.size());
  EXPECT_TRUE(holds(text, "(interpolation = \"vertex\")"));
}

TEST(Usda, SaysWhatIsUpAndHowLongAMetreIs) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_TRUE(holds(usdaOf(mesh), "    metersPerUnit = 1\n    upAxis = \"Y\"\n"));
  WriteOptions options;
  options.up = UpAxis::Z;
  options.scale = 0.001;
  options.name = "2 part's";
  const std::string text = usdaOf(mesh, options);
  EXPECT_TRUE(holds(text, "    metersPerUnit = 0.001\n    upAxis = \"Z\"\n"));
  EXPECT_TRUE(holds(text, "def Xform \"_2_part_s\"\n"));
  options.scale = 0;
  expectError(ErrorCode::InvalidArgument, "scale",
              [&] { static_cast<void>(usdaOf(mesh, options)); });
}

TEST(Usda, FarMeshesAreMovedThereInDoublePrecision) {
  Mesh mesh;
  const double far = 1e8 + 0.125;
  mesh.positions = {{far, 0, 0}, {far + 1, 0, 0}, {far, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const std::string text = usdaOf(mesh);
  const std::size_t at = text.find("xformOp:translate = (");
  ASSERT_NE(at, std::string::npos) << text;
  const double moved = std::stod(text.substr(at + 21));
  const auto points = arrayOf(text, "point3f[] points");
  for (std::size_t v = 0; v < 3; ++v) EXPECT_EQ(moved + points[3 * v], mesh.positions[v].x);
}

TEST(Usda, AttributesArePrimvars) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.attributes = {{"heat", 1, AttributeRole::Value, {1, 2, 3}},
                     {"heat", 2, AttributeRole::Value, {1, 2, 3, 4, 5, 6}},
                     {"Cd", 3, AttributeRole::Colour, {0, 0, 0, 1, 1, 1, 0, 1, 0}}};
  const std::string text = usdaOf(mesh);
  const std::string vertex = " (interpolation = \"vertex\")\n";
  EXPECT_TRUE(holds(text, "float[] primvars:heat = [1, 2, 3]" + vertex)) << text;
  EXPECT_TRUE(holds(text, "float2[] primvars:heat_2 = [(1, 2), (3, 4), (5, 6)]" + vertex)) << text;
  EXPECT_TRUE(
      holds(text, "color3f[] primvars:displayColor = [(0, 0, 0), (1, 1, 1), (0, 1, 0)]" + vertex))
      << text;
}

TEST(Usda, LodsAreVariantsAndMeshesArePrims) {
  LodOptions options;
  options.levels = 3;
  const LodChain chain = buildLods(*test::shapeOf(Shape::Torus, 0.1), options);
  std::ostringstream stream;
  LodWriteReport report;
  writeLods(chain, stream, MeshFormat::Usda, {}, &report);
  const std::string text = stream.str();
  EXPECT_TRUE(holds(text, "string LOD = \"LOD0\"\n"));
  EXPECT_TRUE(holds(text, "prepend variantSets = \"LOD\"\n"));
  std::size_t at = text.find("    variantSet \"LOD\" = {\n");
  for (std::size_t level = 0; level < chain.levels.size(); ++level) {
    at = text.find("\"LOD" + std::to_string(level) + "\" {\n", at);
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(arrayOf(text.substr(at), "point3f[] points").size(),
              3 * chain.levels[level].mesh.positions.size());
  }
  EXPECT_EQ(report.vertices.size(), chain.levels.size());
  std::ostringstream several;
  writeMeshes({{"part", chain.levels[1].mesh}, {"part", chain.levels[2].mesh}}, several,
              MeshFormat::Usda);
  EXPECT_TRUE(holds(several.str(), "def Mesh \"part\"\n"));
  EXPECT_TRUE(holds(several.str(), "def Mesh \"part_2\"\n"));
}

TEST(Usda, IsNotRead) {
  expectError(ErrorCode::UnreadableFile, "written, not read",
              [] { static_cast<void>(readMesh(FileBytes{"#usda 1.0"}, MeshFormat::Usda)); });
}

}  // namespace
}  // namespace tufa
