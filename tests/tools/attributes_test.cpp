// `--attribute`: values of other grids of the file in meshes and LODs.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <tufa/chunk_files.h>
#include <tufa/io.h>
#include <tufa/shapes.h>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::readBytes;
using Json = nlohmann::json;

class AttributeOptions : public CommandTest {
 protected:
  void SetUp() override {
    ShapeOptions options;
    options.voxelSize = 0.1;
    const auto sphere = makeShape(Shape::Sphere, options);
    const auto heat = openvdb::FloatGrid::create(300);
    heat->setName("heat");
    const auto velocity = openvdb::Vec3SGrid::create({1, 2, 3});
    velocity->setName("vel");
    const auto points = openvdb::points::PointDataGrid::create();
    points->setName("points");
    writeGrids({sphere, heat, velocity, points}, folder / "a.vdb");
  }
};

TEST_F(AttributeOptions, ArePropertiesOfPly) {
  const Outcome outcome = run("mesh a.vdb -o m.ply --attribute heat --attribute vel=color --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const Json json = test::parseJson(outcome.out);
  EXPECT_EQ(json["attributes"], test::parseJson(R"([{"name": "heat", "width": 1},
                                                {"name": "vel", "width": 3}])"));
  const std::string bytes = readBytes(folder / "m.ply");
  EXPECT_NE(bytes.find("property float heat\nproperty uchar red\n"), std::string::npos);
  EXPECT_EQ(readMesh(folder / "m.ply").triangleCount(), json["triangles"]);
  const Outcome summary = run("mesh a.vdb -o m.ply --attribute heat --attribute vel");
  EXPECT_NE(summary.out.find("attributes: heat, vel (3), sampled in "), std::string::npos)
      << summary.out;
}

TEST_F(AttributeOptions, AreInEveryLod) {
  const Outcome outcome = run("lod a.vdb -o l.glb --levels 2 --attribute vel --compress");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find(", attributes vel (3) "), std::string::npos) << outcome.out;
  const std::string bytes = readBytes(folder / "l.glb");
  const std::string::size_type first = bytes.find("\"_VEL\"");
  EXPECT_NE(first, std::string::npos);
  EXPECT_NE(bytes.find("\"_VEL\"", first + 1), std::string::npos);
  EXPECT_EQ(run("lod a.vdb -o 'l{}.ply' --levels 2 --attribute vel --quiet").exitCode, 0);
  EXPECT_NE(readBytes(folder / "l1.ply").find("property float vel_z\n"), std::string::npos);
}

TEST_F(AttributeOptions, AreInChunks) {
  const Outcome outcome = run("chunks a.vdb -o c --chunk 16 --levels 2 --attribute vel --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(test::parseJson(outcome.out)["attributes"],
            test::parseJson(R"([{"name": "vel", "width": 3}])"));
  const ChunkIndex index = readChunkIndex((folder / "c").string());
  ASSERT_EQ(index.attributes.size(), 1u);
  EXPECT_EQ(index.attributes[0].width, 3);
  for (const ChunkLevelEntry& level : index.chunks.at(0).levels) {
    EXPECT_NE(readBytes(folder / "c" / level.file).find("\"_VEL\""), std::string::npos);
  }
  EXPECT_FALSE(readChunk(index, 0, (folder / "c").string()).levels.empty());
  const Outcome ply =
      run("chunks a.vdb -o p --chunk 16 --levels 2 --format ply --attribute heat --attribute vel");
  ASSERT_EQ(ply.exitCode, 0) << ply.err;
  EXPECT_NE(ply.out.find(", attributes heat, vel (3) "), std::string::npos) << ply.out;
  const std::string folderOfPly = (folder / "p").string();
  const ChunkIndex plyIndex = readChunkIndex(folderOfPly);
  const std::string bytes = readBytes(folder / "p" / plyIndex.chunks.at(0).levels[1].file);
  EXPECT_NE(bytes.find("property float heat\nproperty float vel_x\n"), std::string::npos);
  EXPECT_EQ(readChunk(plyIndex, 0, folderOfPly).levels[1].positions.size(),
            plyIndex.chunks[0].levels[1].vertices);
  // Chunks of other attributes do not go into one folder.
  const Outcome other = run("chunks a.vdb -o c --chunk 16 --levels 2 --only 0,0,0");
  EXPECT_EQ(other.exitCode, 2);
  EXPECT_NE(other.err.find("other options"), std::string::npos) << other.err;
}

TEST_F(AttributeOptions, OfVelocitiesAreMorphTargets) {
  for (const char* command :
       {"mesh a.vdb -o m.glb", "lod a.vdb -o m.glb --levels 2",
        "mesh a.vdb -o m.glb --compress --up z", "chunks a.vdb -o m --chunk 16 --levels 2"}) {
    const Outcome outcome = run(std::string(command) + " --velocity vel --shutter 1/4");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("motion by vel"), std::string::npos) << outcome.out;
  }
  EXPECT_NE(readBytes(folder / "m.glb").find("\"targetNames\":[\"vel\"]"), std::string::npos);
  const Outcome outcome = run("mesh a.vdb -o m.glb --velocity vel --shutter 0.25 --json");
  EXPECT_EQ(test::parseJson(outcome.out)["attributes"][0]["shutter"], 0.25);
  expectFailure("mesh a.vdb -o m.ply --velocity vel --shutter 1", 2, "for .glb only");
  expectFailure("chunks a.vdb -o c --format ply --velocity vel --shutter 1", 2, "for .glb only");
  expectFailure("mesh a.vdb -o n.glb --velocity vel", 2, "--velocity needs --shutter");
  expectFailure("mesh a.vdb -o n.glb --shutter 1", 2, "--shutter needs --velocity");
  for (const char* shutter : {"0", "1/0", "1/", "fast", "nan", "1/2/3"}) {
    expectFailure(std::string("mesh a.vdb -o n.glb --velocity vel --shutter ") + shutter, 2,
                  "--shutter takes seconds");
  }
  expectFailure("mesh a.vdb -o n.glb --velocity heat --shutter 1", 2, "a motion needs vectors");
  // Before there is a mesh: the grid would have none.
  for (const char* command : {"mesh a.vdb -o n.glb", "lod a.vdb -o n.glb"}) {
    expectFailure(std::string(command) + " --iso 1e9 --attribute nope", 3, "no grid \"nope\"");
  }
}

TEST_F(AttributeOptions, SayWhatIsWrong) {
  expectFailure("mesh a.vdb -o m.stl --attribute heat", 2, ".ply, .glb and .usda");
  expectFailure("lod a.vdb -o 'm{}.obj' --attribute heat", 2, ".ply, .glb and .usda");
  expectFailure("mesh a.vdb -o m.ply --attribute heat=hot", 2, "colour");
  expectFailure("mesh a.vdb -o m.ply --attribute heat --attribute heat=value", 2, "twice");
  expectFailure("mesh a.vdb -o m.ply --attribute heat=colour", 2, "vectors");
  expectFailure("mesh a.vdb -o m.ply --attribute none", 3, "no grid \"none\"");
  expectFailure("mesh a.vdb -o m.ply --attribute points", 3, "\"points\"");
}

}  // namespace
}  // namespace tufa
