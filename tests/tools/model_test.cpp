// tufa model: the sample scenes of the documentation, and what it refuses.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::readBytes;
using test::writeBytes;
using Json = nlohmann::json;

class Model : public CommandTest {
 protected:
  void writeScene(const std::string& file, const std::string& object) {
    writeBytes(folder / file, R"({"tufa_scene": 1, "objects": [)" + object + "]}");
  }
};

/// Twice as coarse as they say, which takes a tenth of the time.
TEST_F(Model, SampleScenesBecomeClosedMeshes) {
  int scenes = 0;
  std::string all;
  for (const auto& entry : std::filesystem::directory_iterator(TUFA_SCENES)) {
    if (entry.path().extension() != ".json") continue;
    ++scenes;
    const std::string scene = entry.path().string();
    all += readBytes(scene);
    const double voxel = test::parseJson(readBytes(scene)).at("voxel").get<double>();
    const Outcome made =
        run("model " + scene + " -o s.vdb --json --voxel " + std::to_string(3 * voxel));
    ASSERT_EQ(made.exitCode, 0) << scene << made.err;
    const Json json = test::parseJson(made.out);
    EXPECT_EQ(json.at("grid"), entry.path().stem().string());
    EXPECT_GE(json.at("samples"), json.at("active_voxels"));
    const Outcome meshed = run("mesh s.vdb -o s.ply --check --json");
    ASSERT_EQ(meshed.exitCode, 0) << scene << meshed.err << meshed.out;
    EXPECT_GT(test::parseJson(meshed.out).at("triangles"), 100) << scene;
    // Rays to the formulas see what was meshed.
    const Outcome seen =
        run("picture " + scene + " -o s.png --size 48x36 --samples 1 --json --compare s.ply " +
            "--voxel " + std::to_string(3 * voxel));
    ASSERT_EQ(seen.exitCode, 0) << scene << seen.err;
    const Json picture = test::parseJson(seen.out);
    EXPECT_GT(picture.at("covered"), 0.1) << scene;
    EXPECT_LT(picture.at("compare").at("share"), 0.05) << scene;
  }
  EXPECT_GE(scenes, 12);
  for (const char* const type :
       {"sphere",    "box",         "cylinder", "segment",      "polyline",   "circle",
        "plane",     "quadric",     "gyroid",   "schwarz_p",    "schwarz_d",  "expression",
        "metaballs", "convolution", "union",    "intersection", "difference", "complement",
        "offset",    "repeat",      "shell",    "use",          "mesh"}) {
    EXPECT_NE(all.find(std::string("\"type\": \"") + type + '"'), std::string::npos) << type;
  }
}

TEST_F(Model, LooksAtAPoint) {
  writeScene("s.json", R"({"type": "sphere", "radius": 2})");
  const Outcome text = run("model s.json --at 0,0,3");
  EXPECT_EQ(text.exitCode, 0) << text.err;
  EXPECT_EQ(text.out, "outside, value 1\ngradient (0, 0, 1)\nnormal (0, 0, 1)\n");
  const Outcome json = run("model s.json --at 1,0,0 --json");
  const Json point = test::parseJson(json.out);
  EXPECT_EQ(point.at("inside"), true);
  EXPECT_EQ(point.at("value"), -1.0);
  EXPECT_EQ(point.at("normal"), Json({1.0, 0.0, 0.0}));
  expectFailure("model s.json --at 1,0", 2, "--at takes 3 numbers");
  expectFailure("model s.json --at 1,0,0 -o s.vdb", 2, "--at only prints");
  expectFailure("model s.json", 2, "--output is required");
}

TEST_F(Model, TakesOptionsBeforeTheScene) {
  writeBytes(folder / "s.json", R"({"tufa_scene": 1, "voxel": 0.2, "half_width": 2, "name": "n",)"
                                R"( "objects": [{"type": "plane"}], "bounds": [-1,-1,-1,1,1,1]})");
  const auto voxels = [&](const std::string& options) {
    const Outcome made = run("model s.json -o s.vdb --json " + options);
    EXPECT_EQ(made.exitCode, 0) << made.err;
    return test::parseJson(made.out).at("active_voxels").get<int>();
  };
  const int own = voxels("");
  EXPECT_GT(voxels("--voxel 0.1"), 3 * own);
  EXPECT_GT(voxels("--half-width 3"), own);
  EXPECT_GT(voxels("--bounds=-2,-2,-1,2,2,1"), 2 * own);
  EXPECT_EQ(run("model s.json -o fog.vdb --fog").exitCode, 0);
  EXPECT_NE(run("info fog.vdb").out.find("fog volume"), std::string::npos);
  EXPECT_EQ(run("mesh fog.vdb -o fog.ply --iso 0.1 --check").exitCode, 0);
  const Outcome told = run("model s.json -o s.vdb");
  EXPECT_EQ(told.out.rfind("grid \"n\": ", 0), 0u) << told.out;
  EXPECT_NE(told.out.find(" samples in "), std::string::npos) << told.out;
}

TEST_F(Model, NamesWhatNoSampleShows) {
  writeScene("s.json", R"({"type": "sphere", "radius": 1},
                          {"type": "sphere", "center": [2.05, 0.05, 0.05], "radius": 0.02})");
  const Outcome made = run("model s.json -o s.vdb --voxel 0.1 --json");
  EXPECT_EQ(made.exitCode, 0);
  EXPECT_NE(made.err.find(" parts of the surface that no sample shows, near (2"), std::string::npos)
      << made.err;
  EXPECT_GT(test::parseJson(made.out).at("hidden_voxels"), 0);
}

TEST_F(Model, ReadsMeshesFromFiles) {
  std::filesystem::create_directory(folder / "sub");
  const std::string tetrahedron = "OFF\n4 4 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n";
  writeBytes(folder / "sub/t.off", tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  writeScene("sub/s.json", R"({"type": "mesh", "file": "t.off"})");
  const Outcome inside = run("model sub/s.json --at 0.5,0.4,0.3 --json");
  EXPECT_NEAR(test::parseJson(inside.out).at("value").get<double>(), -0.3, 1e-12) << inside.err;
  ASSERT_EQ(run("model sub/s.json -o s.vdb --voxel 0.05").exitCode, 0);
  EXPECT_EQ(run("mesh s.vdb -o s.ply --check").exitCode, 0);
  const Outcome picture =
      run("picture sub/s.json -o s.png --size 160x120 --samples 2 --compare s.ply --json");
  ASSERT_EQ(picture.exitCode, 0) << picture.err;
  EXPECT_LT(test::parseJson(picture.out).at("compare").at("share"), 0.02);
  const auto refused = [&](const std::string& bytes, const std::string& part) {
    writeBytes(folder / "sub/m.off", bytes);
    writeScene("sub/s.json", R"({"type": "mesh", "file": "m.off"})");
    expectFailure("model sub/s.json -o o.vdb", 3, "/objects/0/file: " + part);
  };
  refused(tetrahedron + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 1 3\n", "the mesh has 3 edges of one face");
  const auto two = [](const std::string& corners, const char* faces) {
    return "OFF\n8 8 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n" + corners +
           "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n" + faces;
  };
  const char* const outward = "3 4 6 5\n3 4 5 7\n3 4 7 6\n3 5 6 7\n";
  const char* const inward = "3 4 5 6\n3 4 7 5\n3 4 6 7\n3 5 7 6\n";
  const std::string meeting = "0.2 0.2 0.2\n3 0 0\n0 3 0\n0 0 3\n";
  const std::string beside = "4 0 0\n5 0 0\n4 1 0\n4 0 1\n";
  const std::string within = "0.1 0.1 0.1\n0.3 0.1 0.1\n0.1 0.3 0.1\n0.1 0.1 0.3\n";
  refused(two(meeting, outward), "the mesh has faces that intersect or touch");
  refused(two(beside, inward), "a part of the mesh faces inward");
  refused(two(within, outward),
          "a part of the mesh faces inward without another one around it, or");
  refused(tetrahedron, "cannot read sub/m.off");
  refused("", "cannot read sub/m.off");
  for (const std::string& bytes : {two(beside, outward), two(within, inward)}) {
    writeBytes(folder / "sub/m.off", bytes);
    writeScene("sub/s.json", R"({"type": "mesh", "file": "m.off"})");
    EXPECT_EQ(run("model sub/s.json -o o.vdb").exitCode, 0);
  }
  writeScene("sub/s.json", R"({"type": "mesh", "file": "none.off"})");
  expectFailure("model sub/s.json -o o.vdb", 3, "/objects/0/file: cannot read sub/none.off");
  writeScene("sub/s.json", R"({"type": "mesh", "file": "t.off", "thickness": 0})");
  expectFailure("model sub/s.json -o o.vdb", 3, "/objects/0/thickness: must be a number above 0");
  writeScene("sub/s.json", R"({"type": "mesh", "file": "t.txt"})");
  expectFailure("model sub/s.json -o o.vdb", 3, "/objects/0/file: ");
}

/// Blinn's balls in a table, and the same in a point cloud.
TEST_F(Model, ReadsBallsFromFiles) {
  std::filesystem::create_directory(folder / "sub");
  writeBytes(folder / "sub/b.csv", "x,y,z\n0,0,0\n# two\n1.5; 0; 0\r\n3 0 0\n");
  writeBytes(folder / "sub/b.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nend_header\n0 0 0\n1.5 0 0\n3 0 0\n");
  for (const std::string file : {"b.csv", "b.ply"}) {
    writeScene("sub/s.json", R"({"type": "metaballs", "radius": 0.5, "file": ")" + file + "\"}");
    const Outcome inside = run("model sub/s.json --at 3,0.1,0 --json");
    EXPECT_EQ(inside.exitCode, 0) << inside.err;
    EXPECT_EQ(test::parseJson(inside.out).at("inside"), true) << file;
    EXPECT_EQ(run("model sub/s.json --at 0.7,0,0").out.rfind("outside", 0), 0u) << file;
  }
  const auto refused = [&](const std::string& file, const std::string& bytes,
                           const std::string& part) {
    writeBytes(folder / "sub" / file, bytes);
    writeScene("sub/s.json", R"({"type": "metaballs", "file": ")" + file + "\"}");
    expectFailure("model sub/s.json -o o.vdb", 3, "/objects/0/file: " + part);
  };
  refused("a.csv", "1,2\n", "cannot read sub/a.csv: line 1");
  refused("a.csv", "1,2,3\n4,5,nan\n", "cannot read sub/a.csv: line 2");
  refused("a.csv", "1,2,3,4,5,6\n", "cannot read sub/a.csv: line 1: has more than");
  refused("a.csv", "1,2,3,0\n", "ball 1 needs a radius above 0");
  refused("a.csv", "1,2,1e300\n", "ball 1 needs");
  refused("a.csv", "x,y,z\n", "must name one ball");
  refused("a.csv", "", "cannot read sub/a.csv: the file is empty");
  refused("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\n"
          "property float z\nend_header\n0 0 0\n",
          "cannot read sub/a.ply");
}

TEST_F(Model, RefusesHostileScenes) {
  const auto refused = [&](const std::string& object, const std::string& part) {
    writeScene("bad.json", object);
    expectFailure("model bad.json -o o.vdb", 3, part);
  };
  refused(R"({"type": "sphere", "radius": 0})", "bad.json: /objects/0/radius: must be a number");
  refused(R"({"type": "sphere", "radius": NaN})", "bad.json");
  refused(R"({"type": "sphere", "radius": 1e999})", "bad.json");
  refused(R"({"type": "use", "name": "x\u001b[2J"})", "/objects/0/name");
  refused(std::string(200000, '['), "nested deeper than 100");
  refused(std::string(200000, '{'), "nested deeper than 100");
  refused("", "/objects: must have one object");
  expectFailure("model none.json -o o.vdb", 3, "none.json");
  writeBytes(folder / "empty.json", "");
  expectFailure("model empty.json -o o.vdb", 3, "empty");
  writeScene("plane.json", R"({"type": "plane"})");
  expectFailure("model plane.json -o o.vdb", 2, "--bounds");
  expectFailure("model plane.json -o o.vdb --bounds 0,0,0,1,1,0", 2, "bounds");
  expectFailure("model plane.json -o o.vdb --bounds 0,0,0,1,1,nan", 2, "--bounds takes 6");
  expectFailure("model plane.json -o o.vdb --bounds 5,5,5,6,6,6", 3, "no surface");
  expectFailure("model plane.json -o o.ply --bounds=-1,-1,-1,1,1,1", 2, ".vdb");
  expectFailure("model plane.json -o o.vdb --voxel 0", 2, "--voxel");
  writeScene("none.json", R"({"type": "expression", "text": "1/0"})");
  expectFailure("model none.json -o o.vdb --bounds=-1,-1,-1,1,1,1 --voxel 0.2", 3, "no surface");
  writeScene("ball.json", R"({"type": "sphere", "radius": 1e6})");
  expectFailure("model ball.json -o o.vdb --voxel 0.01", 3, "--band-voxels");
  expectFailure("model ball.json -o o.vdb --voxel 1", 3, "--band-voxels");
  expectFailure("model ball.json -o o.vdb --bounds 2e6,0,0,3e6,1,1 --voxel 0.1", 3,
                "lies from (-1e+06, -1e+06, -1e+06) to (1e+06, 1e+06, 1e+06)");
  writeScene("row.json", R"({"type": "repeat", "object": {"type": "sphere", "radius": 1},
                             "step": [3, 3, 3], "count": [1000000000, 1000000000, 1000000000]})");
  expectFailure("model row.json -o o.vdb --voxel 0.1", 2, "too small");
}

}  // namespace
}  // namespace tufa
