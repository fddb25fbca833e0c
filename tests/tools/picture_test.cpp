// tufa picture: volumes and scenes to .png, and comparisons with meshes.

#include <gtest/gtest.h>

#include <string>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::readBytes;
using test::writeBytes;
using Json = nlohmann::json;

class PictureCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    writeBytes(folder / "s.json", R"({"tufa_scene": 1, "voxel": 0.05, "objects": [)"
                                  R"({"type": "difference", "objects": [)"
                                  R"({"type": "box", "size": [2, 2, 1]},)"
                                  R"({"type": "sphere", "radius": 0.8}]}]})");
  }
};

/// The width and height that a .png says.
Json sizeOf(const std::string& png) {
  EXPECT_EQ(png.substr(1, 3), "PNG");
  const auto number = [&](std::size_t at) {
    int all = 0;
    for (std::size_t n = 0; n < 4; ++n)
      all = 256 * all + static_cast<unsigned char>(png.at(at + n));
    return all;
  };
  return {number(16), number(20)};
}

TEST_F(PictureCommand, ShowsScenesAndVolumesAndComparesMeshes) {
  const std::string small = " --size 64x48 --samples 2 ";
  const Outcome scene = run("picture s.json -o s.png --json" + small);
  ASSERT_EQ(scene.exitCode, 0) << scene.err;
  EXPECT_EQ(sizeOf(readBytes(folder / "s.png")), Json({64, 48}));
  const Json told = test::parseJson(scene.out);
  EXPECT_EQ(told.at("size"), Json({64, 48}));
  EXPECT_GT(told.at("covered"), 0.3);

  ASSERT_EQ(run("model s.json -o s.vdb").exitCode, 0);
  ASSERT_EQ(run("mesh s.vdb -o s.ply").exitCode, 0);
  for (const std::string input : {"s.json", "s.vdb"}) {
    const Outcome same = run("picture " + input + " --compare s.ply --json --size 160x120");
    ASSERT_EQ(same.exitCode, 0) << same.err;
    const Json compared = test::parseJson(same.out).at("compare");
    EXPECT_GT(compared.at("pixels"), 8000);
    EXPECT_LT(compared.at("share"), 0.004) << input;
    EXPECT_EQ(compared.at("tolerance"), 0.025);
  }
  // The box without its hollow.
  writeBytes(folder / "b.json",
             R"({"tufa_scene": 1, "objects": [{"type": "box", "size": [2, 2, 1]}]})");
  const Outcome other = run("picture b.json --voxel 0.05 --compare s.ply --json --size 160x120");
  EXPECT_GT(test::parseJson(other.out).at("compare").at("share"), 0.05) << other.err;
  const Outcome text =
      run("picture s.vdb -o - --compare s.ply --camera "
          "azimuth=10,elevation=80,fov=40,up=y" +
          small);
  EXPECT_EQ(sizeOf(text.out), Json({64, 48}));
  EXPECT_NE(text.err.find("pixels differ by more than"), std::string::npos) << text.err;
}

// A scene there was taken for a damaged volume, and a mesh had no way to tell its format.
TEST_F(PictureCommand, TakesScenesAndMeshesFromStandardInput) {
  const std::string small = " --size 64x48 --samples 2 --quiet ";
  ASSERT_EQ(run("picture s.json -o named.png" + small).exitCode, 0);
  const Outcome scene = run("picture - -o piped.png" + small, "", "cat s.json | ");
  ASSERT_EQ(scene.exitCode, 0) << scene.err;
  EXPECT_EQ(readBytes(folder / "piped.png"), readBytes(folder / "named.png"));

  ASSERT_EQ(run("model s.json -o s.vdb").exitCode, 0);
  EXPECT_EQ(run("picture - -o volume.png" + small, "", "cat s.vdb | ").exitCode, 0);
  ASSERT_EQ(run("mesh s.vdb -o s.ply").exitCode, 0);
  const std::string compare = "picture s.json --compare - --json --size 160x120 --format ply";
  const Outcome mesh = run(compare, "", "cat s.ply | ");
  ASSERT_EQ(mesh.exitCode, 0) << mesh.err;
  EXPECT_LT(test::parseJson(mesh.out).at("compare").at("share"), 0.004);
  expectFailure("picture - --compare - --format ply", 2, "holds one file");
  expectFailure("picture s.json -o s.png --format ply", 2, "--format is for --compare");
}

TEST_F(PictureCommand, RefusesWhatIsWrong) {
  ASSERT_EQ(run("make fog -o f.vdb --voxel 0.1").exitCode, 0);
  const auto refused = [&](const std::string& options, int code, const std::string& part) {
    expectFailure("picture " + options, code, part);
  };
  refused("s.json", 2, "--output is required");
  refused("s.json -o s.jpg", 2, "written as .png");
  refused("s.json -o s.png --size 10", 2, "--size takes WIDTHxHEIGHT");
  refused("s.json -o s.png --size 0x10", 2, "1 to 65535 pixels");
  refused("s.json -o s.png --samples 0", 2, "samples must be from 1");
  refused("s.json -o s.png --camera azimuth", 2, "--camera takes");
  refused("s.json -o s.png --camera x=1,y=2", 2, "x, y and z together");
  refused("s.json -o s.png --camera x=1,y=2,z=3,x=2", 2, "--camera takes x= once");
  refused("f.vdb -o s.png --iso 100", 3, "no surface at isovalue 100");
  refused("s.json -o s.png --camera fov=180", 2, "field of view");
  refused("s.json -o s.png --iso 0.1", 2, "--iso is for a volume");
  refused("f.vdb -o s.png --iso 0.1 --bounds 0,0,0,1,1,1", 2, "--bounds is for a scene");
  refused("f.vdb -o s.png", 2, "--iso");
  refused("none.vdb -o s.png", 3, "none.vdb");
  refused("s.json --compare none.ply", 3, "none.ply");
  writeBytes(folder / "p.json", R"({"tufa_scene": 1, "objects": [{"type": "plane"}]})");
  refused("p.json -o s.png", 2, "go on for ever");
}

}  // namespace
}  // namespace tufa
