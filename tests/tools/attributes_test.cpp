// `--attribute`: values of other grids of the file in meshes and LODs.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/io.h>
#include <tufa/shapes.h>
#include <nlohmann/json.hpp>

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
    const auto text = openvdb::MaskGrid::create();
    text->setName("mask");
    writeGrids({sphere, heat, velocity, text}, folder / "a.vdb");
  }
};

TEST_F(AttributeOptions, ArePropertiesOfPly) {
  const Outcome outcome = run("mesh a.vdb -o m.ply --attribute heat --attribute vel=color --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["attributes"], Json::parse(R"([{"name": "heat", "width": 1},
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

TEST_F(AttributeOptions, SayWhatIsWrong) {
  expectFailure("mesh a.vdb -o m.stl --attribute heat", 2, ".ply, .glb and .usda");
  expectFailure("lod a.vdb -o 'm{}.obj' --attribute heat", 2, ".ply, .glb and .usda");
  expectFailure("mesh a.vdb -o m.ply --attribute heat=hot", 2, "colour");
  expectFailure("mesh a.vdb -o m.ply --attribute heat --attribute heat=value", 2, "twice");
  expectFailure("mesh a.vdb -o m.ply --attribute heat=colour", 2, "vectors");
  expectFailure("mesh a.vdb -o m.ply --attribute none", 3, "no grid \"none\"");
  expectFailure("mesh a.vdb -o m.ply --attribute mask", 3, "\"mask\"");
}

}  // namespace
}  // namespace tufa
