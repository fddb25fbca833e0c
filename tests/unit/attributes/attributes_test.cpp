// Values of other grids at the vertices of a mesh, and in its files.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <tufa/attributes.h>

#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/extract.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "support/expect_error.h"
#include "support/json.h"

namespace tufa {
namespace {

using test::expectError;
using Json = nlohmann::json;

openvdb::FloatGrid::Ptr makeSphere() {
  ShapeOptions options;
  options.voxelSize = 0.1;
  return makeShape(Shape::Sphere, options);
}

/// A grid with another lattice than the sphere's, dense around it, whose values are those of
/// `value(world point)`.
template <class GridT, class Value>
typename GridT::Ptr fill(Value&& value, const openvdb::Vec3d& shift = openvdb::Vec3d(0)) {
  auto grid = GridT::create();
  const auto transform = openvdb::math::Transform::createLinearTransform(0.13);
  transform->postRotate(0.4, openvdb::math::Z_AXIS);
  transform->postTranslate({0.05, -0.02, 0.07});
  grid->setTransform(transform);
  grid->setName("field");
  auto accessor = grid->getAccessor();
  constexpr int kReach = 18;
  for (int x = -kReach; x <= kReach; ++x) {
    for (int y = -kReach; y <= kReach; ++y) {
      for (int z = -kReach; z <= kReach; ++z) {
        const openvdb::Coord at(x, y, z);
        accessor.setValue(at, value(transform->indexToWorld(at.asVec3d() + shift)));
      }
    }
  }
  return grid;
}

double plane(const openvdb::Vec3d& p) { return 1 + p[0] - 2 * p[1] + 0.5 * p[2]; }
double plane(const Position& p) { return plane(openvdb::Vec3d(p.x, p.y, p.z)); }

TEST(Attributes, AreTrilinearInWorldSpace) {
  const Mesh mesh = contour(*makeSphere());
  const auto floats = fill<openvdb::FloatGrid>([](const auto& p) { return float(plane(p)); });
  const auto doubles = fill<openvdb::DoubleGrid>([](const auto& p) { return plane(p); });
  for (const openvdb::GridBase* grid : {static_cast<const openvdb::GridBase*>(floats.get()),
                                        static_cast<const openvdb::GridBase*>(doubles.get())}) {
    const Attribute attribute = sampleAttribute(mesh, *grid);
    EXPECT_EQ(attribute.name, "field");
    EXPECT_EQ(attribute.width, 1);
    ASSERT_EQ(attribute.values.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      ASSERT_NEAR(attribute.values[v], plane(mesh.positions[v]), 1e-5);
    }
  }
}

// Coordinates of voxels are 32-bit integers, those of a mesh are not.
TEST(Attributes, AreTheBackgroundFarAway) {
  Mesh mesh;
  const double nan = std::nan("");
  mesh.positions = {{1e300, 0, 0}, {0, -1e12, 0}, {nan, nan, 1e30}};
  const auto grid = openvdb::FloatGrid::create(7);
  grid->setName("field");
  grid->tree().setValue({0, 0, 0}, 1);
  EXPECT_EQ(sampleAttribute(mesh, *grid).values, (std::vector<float>{7, 7, 7}));
}

TEST(Attributes, AreReadAsFarAsVoxelsLie) {
  Mesh mesh;
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("field");
  for (const int at : {1500000000, 2147480000, -2147480000}) {
    grid->tree().setValue({at, 0, 0}, 7);
    mesh.positions = {{static_cast<double>(at), 0, 0}};
    EXPECT_EQ(sampleAttribute(mesh, *grid).values, std::vector<float>{7}) << at;
  }
}

TEST(Attributes, IntegersAreNotRoundedBetweenVoxels) {
  Mesh mesh;
  mesh.positions = {{0.25, 0, 0}, {1.5, 0, 0}};
  const auto grid = openvdb::Int32Grid::create();
  grid->setName("count");
  grid->getAccessor().setValue({1, 0, 0}, 4);
  EXPECT_EQ(sampleAttribute(mesh, *grid).values, (std::vector<float>{1, 2}));
  const auto flags = openvdb::BoolGrid::create();
  flags->setName("flag");
  flags->getAccessor().setValue({1, 0, 0}, true);
  EXPECT_EQ(sampleAttribute(mesh, *flags).values, (std::vector<float>{0.25, 0.5}));
}

TEST(Attributes, VectorsHaveThreeValues) {
  const Mesh mesh = contour(*makeSphere());
  const auto grid = fill<openvdb::Vec3SGrid>([](const auto& p) { return openvdb::Vec3s(p); });
  const Attribute attribute = sampleAttribute(mesh, *grid);
  EXPECT_EQ(attribute.width, 3);
  ASSERT_EQ(attribute.values.size(), 3 * mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    ASSERT_NEAR(attribute.values[3 * v], mesh.positions[v].x, 1e-5);
    ASSERT_NEAR(attribute.values[3 * v + 2], mesh.positions[v].z, 1e-5);
  }
}

TEST(Attributes, StaggeredGridsHaveTheirValuesAtFaces) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}};
  const auto grid = openvdb::Vec3SGrid::create();
  grid->setName("vel");
  grid->setGridClass(openvdb::GRID_STAGGERED);
  // The x of voxel 0 lies at -0.5, that of voxel 1 at 0.5.
  grid->getAccessor().setValue({0, 0, 0}, {1, 5, 0});
  grid->getAccessor().setValue({1, 0, 0}, {3, 0, 0});
  grid->getAccessor().setValue({0, 1, 0}, {0, 7, 0});
  EXPECT_EQ(sampleAttribute(mesh, *grid).values, (std::vector<float>{2, 6, 0}));
}

TEST(Attributes, ValuesThatAreNotFiniteBecome0) {
  Mesh mesh;
  mesh.positions = {{0.5, 0, 0}, {5, 0, 0}, {6, 0, 0}};
  const auto grid = openvdb::FloatGrid::create(2);
  grid->setName("f");
  grid->getAccessor().setValue({1, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(sampleAttribute(mesh, *grid).values, (std::vector<float>{0, 2, 2}));
}

// They became 0, as what is not finite does.
TEST(Attributes, ValuesBeyondFloatBecomeTheLargest) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const auto grid = openvdb::DoubleGrid::create(2);
  grid->setName("f");
  grid->getAccessor().setValue({1, 0, 0}, 1e300);
  grid->getAccessor().setValue({2, 0, 0}, -1e300);
  grid->getAccessor().setValue({3, 0, 0}, std::numeric_limits<double>::infinity());
  constexpr float kLargest = std::numeric_limits<float>::max();
  EXPECT_EQ(sampleAttribute(mesh, *grid).values, (std::vector<float>{2, kLargest, -kLargest, 0}));
  AttributeOptions options;
  options.factor = -1e300;
  EXPECT_EQ(sampleAttribute(mesh, *grid, options).values,
            (std::vector<float>{-kLargest, -kLargest, kLargest, 0}));
}

TEST(Attributes, MasksAreSampledAsBooleans) {
  Mesh mesh;
  mesh.positions = {{0.25, 0, 0}, {1.5, 0, 0}, {20, 20, 20}};
  const auto mask = openvdb::MaskGrid::create();
  mask->setName("mask");
  mask->getAccessor().setValueOn({1, 0, 0});
  mask->fill(openvdb::CoordBBox({16, 16, 16}, {31, 31, 31}), true);
  EXPECT_EQ(sampleAttribute(mesh, *mask).values, (std::vector<float>{0.25, 0.5, 1}));
}

TEST(Attributes, TheNumberOfThreadsDoesNotMatter) {
  const Mesh mesh = contour(*makeSphere());
  const auto grid =
      fill<openvdb::FloatGrid>([](const auto& p) { return float(std::sin(9 * p[0])); });
  AttributeOptions one;
  one.threads = 1;
  EXPECT_EQ(sampleAttribute(mesh, *grid, one).values, sampleAttribute(mesh, *grid).values);
}

TEST(Attributes, RefuseWhatCannotBeSampled) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}};
  const auto grid = openvdb::FloatGrid::create();
  expectError(ErrorCode::InvalidArgument, "name",
              [&] { static_cast<void>(sampleAttribute(mesh, *grid)); });
  AttributeOptions colour;
  colour.name = "Cd";
  colour.role = AttributeRole::Colour;
  expectError(ErrorCode::InvalidArgument, "colour",
              [&] { static_cast<void>(sampleAttribute(mesh, *grid, colour)); });
  const auto points = openvdb::Grid<openvdb::tree::Tree4<openvdb::PointIndex32>::Type>::create();
  points->setName("points");
  expectError(ErrorCode::UnsupportedGrid, "numbers, booleans or vectors",
              [&] { static_cast<void>(sampleAttribute(mesh, *points)); });
  // It holds floats, said the message, and must hold numbers.
  const auto other = openvdb::Grid<openvdb::tree::Tree4<float, 3, 4, 3>::Type>::create();
  expectError(ErrorCode::UnsupportedGrid, "Tree_float_3_4_3",
              [&] { static_cast<void>(sampleAttribute(mesh, *other)); });
}

/// A sphere with a temperature, a velocity and a colour.
Mesh makeMesh() {
  Mesh mesh = contour(*makeSphere());
  const auto numbers = fill<openvdb::FloatGrid>([](const auto& p) { return float(plane(p)); });
  const auto vectors = fill<openvdb::Vec3SGrid>([](const auto& p) { return openvdb::Vec3s(p); });
  AttributeOptions options;
  options.name = "temperature";
  mesh.attributes.push_back(sampleAttribute(mesh, *numbers, options));
  options.name = "vel (m/s)";
  mesh.attributes.push_back(sampleAttribute(mesh, *vectors, options));
  options.name = "Cd";
  options.role = AttributeRole::Colour;
  mesh.attributes.push_back(sampleAttribute(mesh, *vectors, options));
  return mesh;
}

std::string bytesOf(const Mesh& mesh, MeshFormat format) {
  std::ostringstream stream;
  write(mesh, stream, format);
  return stream.str();
}

TEST(Attributes, ArePropertiesOfPly) {
  const Mesh mesh = makeMesh();
  const std::string bytes = bytesOf(mesh, MeshFormat::Ply);
  const std::string header = bytes.substr(0, bytes.find("end_header\n") + 11);
  EXPECT_NE(header.find("property float nz\n"
                        "property float temperature\n"
                        "property float vel__m_s__x\n"
                        "property float vel__m_s__y\n"
                        "property float vel__m_s__z\n"
                        "property uchar red\nproperty uchar green\nproperty uchar blue\n"),
            std::string::npos)
      << header;
  // Three positions, three normals, four values and three bytes.
  const std::size_t stride = 10 * sizeof(float) + 3;
  for (const std::size_t v : {std::size_t{0}, mesh.positions.size() - 1}) {
    float temperature = 0;
    std::memcpy(&temperature, bytes.data() + header.size() + v * stride + 24, sizeof temperature);
    EXPECT_EQ(temperature, mesh.attributes[0].values[v]);
  }
  EXPECT_EQ(readMesh({bytes}, MeshFormat::Ply).positions, mesh.positions);
}

/// The document of a .glb, and the values of one of its accessors.
struct Glb {
  std::string bytes;
  Json document;

  explicit Glb(std::string file) : bytes(std::move(file)) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, sizeof size);
    document = test::parseJson(bytes.substr(20, size));
    binary_ = 20 + size + 8;
  }
  [[nodiscard]] std::vector<float> floats(std::size_t accessor, std::size_t width) const {
    const Json& element = document["accessors"][accessor];
    const Json& view = document["bufferViews"][element["bufferView"].get<std::size_t>()];
    std::vector<float> values(width * element["count"].get<std::size_t>());
    std::memcpy(values.data(), bytes.data() + binary_ + view.value("byteOffset", std::size_t{0}),
                values.size() * sizeof(float));
    return values;
  }

 private:
  std::size_t binary_ = 0;
};

/// Each vertex of a file has the values of the position that it came from.
void expectValues(const Glb& glb, std::size_t mesh) {
  const Json& names = glb.document["meshes"][mesh]["primitives"][0]["attributes"];
  ASSERT_TRUE(names.contains("_TEMPERATURE")) << names;
  ASSERT_TRUE(names.contains("_VEL__M_S_")) << names;
  ASSERT_TRUE(names.contains("COLOR_0")) << names;
  const auto positions = glb.floats(names["POSITION"], 3);
  const auto temperature = glb.floats(names["_TEMPERATURE"], 1);
  const auto velocity = glb.floats(names["_VEL__M_S_"], 3);
  const auto colour = glb.floats(names["COLOR_0"], 3);
  ASSERT_EQ(3 * temperature.size(), positions.size());
  for (std::size_t v = 0; v < temperature.size(); ++v) {
    const Position p(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    ASSERT_NEAR(temperature[v], plane(p), 1e-4);
    ASSERT_NEAR(velocity[3 * v + 1], p.y, 1e-4);
    ASSERT_NEAR(colour[3 * v + 2], std::clamp(p.z, 0.0, 1.0), 1e-4);
  }
}

TEST(Attributes, AreAttributesOfGlb) {
  const Glb glb(bytesOf(makeMesh(), MeshFormat::Glb));
  expectValues(glb, 0);
  EXPECT_EQ(glb.document["accessors"][2]["type"], "SCALAR");
}

TEST(Attributes, AreInEveryLod) {
  LodOptions options;
  options.levels = 3;
  LodChain chain = buildLods(*makeSphere(), options);
  const auto numbers = fill<openvdb::FloatGrid>([](const auto& p) { return float(plane(p)); });
  const auto vectors = fill<openvdb::Vec3SGrid>([](const auto& p) { return openvdb::Vec3s(p); });
  for (Lod& lod : chain.levels) {
    for (const auto& [name, role] :
         {std::pair{"temperature", AttributeRole::Value},
          std::pair{"vel (m/s)", AttributeRole::Value}, std::pair{"Cd", AttributeRole::Colour}}) {
      AttributeOptions sampling;
      sampling.name = name;
      sampling.role = role;
      const openvdb::GridBase& grid = std::string(name) == "temperature"
                                          ? static_cast<const openvdb::GridBase&>(*numbers)
                                          : *vectors;
      lod.mesh.attributes.push_back(sampleAttribute(lod.mesh, grid, sampling));
    }
  }
  std::ostringstream plain, packed;
  writeLods(chain, plain, MeshFormat::Glb);
  const Glb glb(plain.str());
  for (std::size_t level = 0; level < chain.levels.size(); ++level) expectValues(glb, level);
  LodWriteOptions compress;
  compress.compression = GlbCompression::Meshopt;
  writeLods(chain, packed, MeshFormat::Glb, compress);
  EXPECT_LT(packed.str().size(), plain.str().size());
  const std::string bytes = packed.str();
  EXPECT_EQ(readMesh({bytes}, MeshFormat::Glb).triangleCount(),
            chain.levels[0].mesh.triangleCount());
}

/// The sphere, and how it moves in half a second.
Mesh makeMoving() {
  Mesh mesh = contour(*makeSphere());
  const auto velocity =
      fill<openvdb::Vec3SGrid>([](const auto& p) { return openvdb::Vec3s(2 * p); });
  AttributeOptions options;
  options.name = "vel";
  options.role = AttributeRole::Motion;
  options.factor = 0.5;
  mesh.attributes.push_back(sampleAttribute(mesh, *velocity, options));
  return mesh;
}

/// The sphere is twice as large once its morph target has a weight of 1.
void expectMoved(const Glb& glb, double unit, double radius) {
  const Json& mesh = glb.document["meshes"][0];
  EXPECT_EQ(mesh["weights"], Json::array({0}));
  EXPECT_EQ(mesh["extras"]["targetNames"], Json::array({"vel"}));
  const Json& primitive = mesh["primitives"][0];
  ASSERT_EQ(primitive["targets"].size(), 1u);
  EXPECT_FALSE(primitive["attributes"].contains("_VEL"));
  const std::size_t target = primitive["targets"][0]["POSITION"];
  const auto moves = glb.floats(target, 3);
  const Json& accessor = glb.document["accessors"][target];
  ASSERT_EQ(
      accessor["count"],
      glb.document["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"]);
  for (std::size_t v = 0; v < moves.size(); v += 3) {
    ASSERT_NEAR(unit * std::hypot(moves[v], moves[v + 1], moves[v + 2]), radius, 0.02 * radius);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_GE(moves[v + i], accessor["min"][i].get<float>());
      ASSERT_LE(moves[v + i], accessor["max"][i].get<float>());
    }
  }
}

TEST(Attributes, OfMotionAreMorphTargetsOfGlb) {
  const Mesh mesh = makeMoving();
  const double radius = std::hypot(mesh.positions[0].x, mesh.positions[0].y, mesh.positions[0].z);
  const Glb plain(bytesOf(mesh, MeshFormat::Glb));
  expectMoved(plain, 1, radius);
  const Json& primitive = plain.document["meshes"][0]["primitives"][0];
  const auto places = plain.floats(primitive["attributes"]["POSITION"], 3);
  const auto moves = plain.floats(primitive["targets"][0]["POSITION"], 3);
  for (std::size_t i = 0; i < places.size(); ++i) ASSERT_NEAR(moves[i], places[i], 1e-4);

  // Under a node that scales and turns, in 16 bits and in LODs.
  WriteOptions options;
  options.compression = GlbCompression::Quantized;
  options.up = UpAxis::Z;
  options.scale = 0.01;
  std::ostringstream quantized;
  write(mesh, quantized, MeshFormat::Glb, options);
  const Glb small(quantized.str());
  expectMoved(small, small.document["nodes"][0]["scale"][0], 0.01 * radius);
  LodChain chain;
  chain.levels.emplace_back().mesh = mesh;
  std::ostringstream lods;
  writeLods(chain, lods, MeshFormat::Glb);
  expectMoved(Glb(lods.str()), 1, radius);
}

TEST(Attributes, OfMotionAreRefusedByOtherFormats) {
  const Mesh mesh = makeMoving();
  for (const MeshFormat format : {MeshFormat::Ply, MeshFormat::Usda, MeshFormat::Stl}) {
    std::ostringstream stream;
    expectError(ErrorCode::InvalidArgument, "only .glb", [&] { write(mesh, stream, format); });
  }
  AttributeOptions options;
  options.name = "heat";
  options.role = AttributeRole::Motion;
  const auto heat = openvdb::FloatGrid::create();
  expectError(ErrorCode::InvalidArgument, "motion",
              [&] { static_cast<void>(sampleAttribute(mesh, *heat, options)); });
}

TEST(Attributes, CellsAreThoseThatPositionsLieIn) {
  const auto sphere = makeSphere();
  ContourOptions options;
  options.keepCells = true;
  LodOptions lods;
  lods.contour = options;
  lods.levels = 2;
  std::vector<Mesh> meshes = {contour(*sphere, options),
                              extract(*sphere, Method::MarchingCubes, {options})};
  ExtractOptions refined{options};
  refined.refine = 0.01;
  meshes.push_back(extract(*sphere, Method::Dual, refined));
  for (Lod& lod : buildLods(*sphere, lods).levels) meshes.push_back(std::move(lod.mesh));
  ASSERT_EQ(meshes.size(), 5u);
  for (const Mesh& mesh : meshes) {
    ASSERT_EQ(mesh.cells.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.cells.size(); ++v) {
      const Position& p = mesh.positions[v];
      const openvdb::Vec3d index = sphere->worldToIndex({p.x, p.y, p.z});
      for (int i = 0; i < 3; ++i) {
        const double within = index[i] - mesh.cells[v][static_cast<std::size_t>(i)];
        ASSERT_TRUE(within >= 0 && within < 1) << within;
      }
    }
  }
  EXPECT_TRUE(contour(*sphere).cells.empty());
}

TEST(Attributes, OfAnotherLengthAreRefused) {
  Mesh mesh = makeMesh();
  mesh.attributes[1].values.pop_back();
  std::ostringstream stream;
  expectError(ErrorCode::InvalidArgument, "vel (m/s)",
              [&] { write(mesh, stream, MeshFormat::Ply); });
  EXPECT_TRUE(stream.str().empty());
  mesh.attributes[1].width = 5;
  expectError(ErrorCode::InvalidArgument, "width", [&] { write(mesh, stream, MeshFormat::Glb); });
}

}  // namespace
}  // namespace tufa
