// Meshes, LODs and grids through memory and streams in place of files.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/memory.h>
#include <tufa/shapes.h>
#include <sstream>

#include "support/expect_error.h"
#include "support/scratch_folder.h"
#include "support/shape.h"

namespace tufa {
namespace {

using test::expectError;
using test::readBytes;
using test::ScratchFolder;

TEST(Memory, MeshesHaveTheBytesOfFiles) {
  const ScratchFolder folder;
  const Mesh mesh = contour(*test::shapeOf(Shape::Box, 0.1));
  for (const std::string_view name : meshFormatNames()) {
    const auto path = folder / ("box." + std::string(name));
    if (!hasFormat(meshFormatOf(path))) continue;
    write(mesh, path);
    std::ostringstream stream;
    write(mesh, stream, meshFormatOf(path));
    EXPECT_EQ(stream.str(), readBytes(path)) << name;
    if (name == "usda" || name == "3mf") continue;  // which are not read
    const std::string bytes = stream.str();
    EXPECT_EQ(readMesh({bytes}, meshFormatOf(path)).positions, readMesh(path).positions) << name;
  }
}

TEST(Memory, SeveralMeshesAndLodsHaveTheBytesOfFiles) {
  const ScratchFolder folder;
  const auto grid = test::shapeOf(Shape::Torus, 0.1);
  const Mesh mesh = contour(*grid);
  std::ostringstream meshes, lods;
  writeMeshes({{"a", mesh}, {"b", mesh}}, folder / "m.obj");
  writeMeshes({{"a", mesh}, {"b", mesh}}, meshes, MeshFormat::Obj);
  EXPECT_EQ(meshes.str(), readBytes(folder / "m.obj"));
  expectError(ErrorCode::InvalidArgument, "several meshes", [&] {
    writeMeshes({{"a", mesh}}, meshes, MeshFormat::Ply);
  });

  LodOptions options;
  options.levels = 2;
  const LodChain chain = buildLods(*grid, options);
  LodWriteReport report;
  writeLods(chain, folder / "l.glb");
  writeLods(chain, lods, MeshFormat::Glb, {}, &report);
  EXPECT_EQ(lods.str(), readBytes(folder / "l.glb"));
  EXPECT_TRUE(report.files.empty());
  EXPECT_EQ(report.vertices.size(), 2u);
}

TEST(Memory, GridsComeBackFromStreamsAndFiles) {
  const ScratchFolder folder;
  const auto sphere = test::shapeOf(Shape::Sphere, 0.1), box = test::shapeOf(Shape::Box, 0.1);
  writeGrids({sphere, box}, folder / "two.vdb");
  std::ostringstream stream;
  writeGrids({sphere, box}, stream);
  for (const std::string& bytes : {readBytes(folder / "two.vdb"), stream.str()}) {
    ASSERT_EQ(listGrids(FileBytes{bytes}).size(), 2u);
    EXPECT_EQ(describeGrids(FileBytes{bytes})[1].activeVoxels, box->activeVoxelCount());
    const auto grid = readGrid(FileBytes{bytes}, "box");
    EXPECT_EQ(contour(*grid).positions, contour(*box).positions);
    EXPECT_EQ(readGrid(FileBytes{bytes})->getName(), "sphere");
  }
}

TEST(Memory, DamageIsAnErrorWithTheGivenName) {
  std::ostringstream stream;
  writeGrids({test::shapeOf(Shape::Sphere, 0.1)}, stream);
  const std::string bytes = stream.str();
  for (const std::size_t size : {std::size_t{0}, std::size_t{4}, bytes.size() / 2}) {
    expectError(ErrorCode::UnreadableFile, "cannot read the pipe: ", [&] {
      static_cast<void>(readGrid(FileBytes{std::string_view(bytes).substr(0, size), "the pipe"}));
    });
  }
  expectError(ErrorCode::UnreadableFile, "cannot read memory: ", [] {
    static_cast<void>(readMesh(FileBytes{"solid nothing"}, MeshFormat::Ply));
  });
}

TEST(Memory, AStreamThatFailsIsAnError) {
  const Mesh mesh = contour(*test::shapeOf(Shape::Sphere, 0.1));
  std::ostringstream stream;
  stream.setstate(std::ios_base::badbit);
  expectError(ErrorCode::UnwritableFile, "stream", [&] { write(mesh, stream, MeshFormat::Ply); });
  expectError(ErrorCode::UnwritableFile, "stream",
              [&] { writeGrids({test::shapeOf(Shape::Sphere, 0.1)}, stream); });
}

}  // namespace
}  // namespace tufa
