// .3mf, as lib3mf's own reader sees it in its strict mode.

#include <gtest/gtest.h>

#include <tufa/io.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <array>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

#ifdef TUFA_HAS_LIB3MF
#include <Model/COM/NMR_DLLInterfaces.h>

// lib3mf's reader leaves what libzip gave it. Asked by LeakSanitizer.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libzip"; }
#endif

namespace tufa {
namespace {

using test::expectError;

Mesh makeTetrahedron() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0.25, 0, 0}, {0, 0.5, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

std::string bytesOf(const std::vector<NamedMesh>& meshes, const WriteOptions& options = {}) {
  std::ostringstream stream;
  writeMeshes(meshes, stream, MeshFormat::ThreeMf, options);
  return stream.str();
}

#ifdef TUFA_HAS_LIB3MF

struct Release {
  void operator()(NMR::PLib3MFBase* object) const { NMR::lib3mf_release(object); }
};

/// What lib3mf's strict reader finds in a file.
struct Strict {
  DWORD warnings = 0;
  DWORD unit = 0;
  std::vector<NMR::PLib3MFModelMeshObject*> objects;
  std::size_t items = 0;
  std::vector<std::unique_ptr<NMR::PLib3MFBase, Release>> owned;

  explicit Strict(std::string bytes) {
    NMR::PLib3MFModel* model = nullptr;
    NMR::PLib3MFModelReader* reader = nullptr;
    EXPECT_EQ(NMR::lib3mf_createmodel(&model), 0);
    owned.emplace_back(model);
    EXPECT_EQ(NMR::lib3mf_model_queryreader(model, MODELREADERCLASS_3MF, &reader), 0);
    owned.emplace_back(reader);
    EXPECT_EQ(NMR::lib3mf_reader_setstrictmodeactive(reader, true), 0);
    EXPECT_EQ(NMR::lib3mf_reader_readfrombuffer(reader, reinterpret_cast<BYTE*>(bytes.data()),
                                                bytes.size()),
              0);
    NMR::lib3mf_reader_getwarningcount(reader, &warnings);
    NMR::lib3mf_model_getunit(model, &unit);
    NMR::PLib3MFModelResourceIterator* meshes = nullptr;
    NMR::lib3mf_model_getmeshobjects(model, &meshes);
    owned.emplace_back(meshes);
    BOOL more = false;
    while (NMR::lib3mf_resourceiterator_movenext(meshes, &more) == 0 && more) {
      NMR::PLib3MFModelResource* object = nullptr;
      NMR::lib3mf_resourceiterator_getcurrent(meshes, &object);
      owned.emplace_back(object);
      objects.push_back(static_cast<NMR::PLib3MFModelMeshObject*>(object));
    }
    NMR::PLib3MFModelBuildItemIterator* build = nullptr;
    NMR::lib3mf_model_getbuilditems(model, &build);
    owned.emplace_back(build);
    while (NMR::lib3mf_builditemiterator_movenext(build, &more) == 0 && more) ++items;
  }

  [[nodiscard]] std::vector<std::array<float, 3>> positions(std::size_t object) const {
    DWORD count = 0;
    NMR::lib3mf_meshobject_getvertexcount(objects[object], &count);
    std::vector<std::array<float, 3>> positions;
    for (DWORD v = 0; v < count; ++v) {
      NMR::MODELMESHVERTEX vertex;
      NMR::lib3mf_meshobject_getvertex(objects[object], v, &vertex);
      positions.push_back({vertex.m_fPosition[0], vertex.m_fPosition[1], vertex.m_fPosition[2]});
    }
    return positions;
  }

  [[nodiscard]] bool isManifoldAndOriented(std::size_t object) const {
    BOOL is = false;
    NMR::lib3mf_meshobject_ismanifoldandoriented(objects[object], &is);
    return is;
  }
};

TEST(ThreeMf, IsReadStrictlyWithItsUnit) {
  WriteOptions options;
  options.up = UpAxis::Z;
  options.scale = 0.001;
  options.name = "part <1> & \"two\"\n";
  const Strict read(bytesOf({{options.name, makeTetrahedron()}}, options));
  EXPECT_EQ(read.warnings, 0u);
  EXPECT_EQ(read.unit, static_cast<DWORD>(NMR::MODELUNIT_MILLIMETER));
  ASSERT_EQ(read.objects.size(), 1u);
  EXPECT_EQ(read.items, 1u);
  EXPECT_TRUE(read.isManifoldAndOriented(0));
  const auto positions = read.positions(0);
  ASSERT_EQ(positions.size(), 4u);
  EXPECT_NEAR(positions[1][0], 0.25, 2e-6);
  EXPECT_NEAR(positions[3][2], 1, 2e-6);
}

TEST(ThreeMf, TurnsYUpAndScales) {
  const auto positions = Strict(bytesOf({{"a", makeTetrahedron()}})).positions(0);
  EXPECT_NEAR(positions[1][0], 250, 1e-3);  // a metre a unit, in millimetres
  EXPECT_NEAR(positions[2][2], 500, 1e-3);
  EXPECT_NEAR(positions[3][1], -1000, 1e-3);
  WriteOptions small;
  small.scale = 1e-6;
  const Strict read(bytesOf({{"a", makeTetrahedron()}}, small));
  EXPECT_EQ(read.unit, static_cast<DWORD>(NMR::MODELUNIT_MICROMETER));
  EXPECT_NEAR(read.positions(0)[1][0], 0.25, 2e-6);
}

TEST(ThreeMf, HoldsSeveralMeshesOfQuadsToo) {
  ShapeOptions shape;
  shape.voxelSize = 0.1;
  ContourOptions uniform;
  uniform.uniform = true;
  const Mesh sphere = contour(*makeShape(Shape::Sphere, shape), uniform);
  const Mesh bracket = contour(*makeShape(Shape::Bracket, shape));
  ASSERT_GT(sphere.quads.size(), 0u);
  const std::string bytes = bytesOf({{"sphere", sphere}, {"none", Mesh()}, {"bracket", bracket}});
  const Strict read(bytes);
  EXPECT_EQ(read.warnings, 0u);
  ASSERT_EQ(read.objects.size(), 2u);
  EXPECT_EQ(read.items, 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    DWORD triangles = 0;
    NMR::lib3mf_meshobject_gettrianglecount(read.objects[i], &triangles);
    EXPECT_EQ(triangles, (i == 0 ? sphere : bracket).triangleCount());
    EXPECT_TRUE(read.isManifoldAndOriented(i));
  }
  // The same bytes every time, in a file too.
  EXPECT_EQ(bytesOf({{"sphere", sphere}, {"none", Mesh()}, {"bracket", bracket}}), bytes);
  const test::ScratchFolder folder;
  writeMeshes({{"sphere", sphere}, {"none", Mesh()}, {"bracket", bracket}}, folder / "b.3mf");
  EXPECT_EQ(test::readBytes(folder / "b.3mf"), bytes);
}

TEST(ThreeMf, OfAnEmptyMeshIsRead) {
  const Strict read(bytesOf({{"none", Mesh()}}));
  EXPECT_EQ(read.objects.size(), 0u);
}

TEST(ThreeMf, RefusesWhatItWouldBlur) {
  Mesh mesh = makeTetrahedron();
  mesh.positions[1].x = 1e-10;
  expectError(ErrorCode::LimitExceeded, "nearer to each other", [&] { bytesOf({{"a", mesh}}); });
  mesh.positions[1].x = 1e9;
  expectError(ErrorCode::LimitExceeded, "too far away", [&] { bytesOf({{"a", mesh}}); });
}

#else

TEST(ThreeMf, IsRefusedWithoutItsLibrary) {
  EXPECT_FALSE(hasFormat(MeshFormat::ThreeMf));
  expectError(ErrorCode::InvalidArgument, "lib3mf", [] { bytesOf({{"a", makeTetrahedron()}}); });
}

#endif

TEST(ThreeMf, IsNotRead) {
  expectError(ErrorCode::UnreadableFile, "not read",
              [] { static_cast<void>(readMesh({"PK"}, MeshFormat::ThreeMf)); });
}

}  // namespace
}  // namespace tufa
