// Several grids of one file: a mesh each, or the mesh of their union.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <tufa/io.h>
#include <cmath>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using openvdb::FloatGrid;
using test::CommandTest;
using test::Outcome;
using Json = nlohmann::json;

class SeveralGrids : public CommandTest {
 protected:
  static FloatGrid::Ptr makeBall(const char* name, float x, float voxel) {
    auto grid = openvdb::tools::createLevelSetSphere<FloatGrid>(1, {x, 0, 0}, voxel);
    grid->setName(name);
    return grid;
  }

  void SetUp() override {
    const auto fog = FloatGrid::create(0);
    fog->setName("smoke");
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    fog->tree().setValueOn({0, 0, 0}, 1);
    writeGrids({makeBall("left", 0, 0.1F), makeBall("right", 1.2F, 0.1F),
                makeBall("beyond", 2.4F, 0.05F), fog},
               folder / "g.vdb");
  }

  Json report(const std::string& arguments) {
    const Outcome outcome = run(arguments + " --json");
    EXPECT_EQ(outcome.exitCode, 0) << arguments << "\n" << outcome.err;
    return test::parseJson(outcome.out);
  }
};

TEST_F(SeveralGrids, BecomeOneSurfaceByUnion) {
  const Json json =
      report("mesh g.vdb -o u.ply --grid left --grid right --grid beyond --join union --check");
  EXPECT_EQ(json["grid"], "union");
  EXPECT_EQ(json["union"], Json({"left", "right", "beyond"}));
  EXPECT_EQ(json["check"]["components"], 1);
  EXPECT_EQ(json["check"]["euler_characteristic"], 2);
  EXPECT_GT(json["seconds"]["unite"], 0);
  for (const Position& p : readMesh(folder / "u.ply").positions) {
    double distance = 10;
    for (const double x : {0.0, 1.2, 2.4}) {
      distance = std::min(distance, std::hypot(p.x - x, p.y, p.z));
    }
    ASSERT_NEAR(distance, 1, 0.02);
  }
  const Outcome outcome = run("mesh g.vdb -o u.ply --grid left --grid right --join union");
  EXPECT_NE(outcome.out.find("the union of grid \"left\", grid \"right\", made in "),
            std::string::npos)
      << outcome.out;
}

TEST_F(SeveralGrids, StaySeparateUnlessUnited) {
  EXPECT_EQ(report("mesh g.vdb -o s.glb --grid left --grid right")["grids"].size(), 2u);
  EXPECT_EQ(report("mesh g.vdb -o s.glb --grid left --grid right --join separate")["grids"].size(),
            2u);
  // Filters work on the union, and the output's braces stand for its name.
  EXPECT_EQ(report("mesh g.vdb -o '{}.ply' --grid left --grid beyond --join union "
                   "--keep-largest 1")["filters"][0]["components"],
            2);
  EXPECT_TRUE(std::filesystem::exists(folder / "union.ply"));
}

TEST_F(SeveralGrids, AreNoUnionUnlessAllAreLevelSets) {
  expectFailure("mesh g.vdb -o u.ply --join union", 3, "grid \"smoke\" is none");
  expectFailure("mesh g.vdb -o u.ply --join union --labels all", 2,
                "--join union is for level sets");
  expectFailure("mesh g.vdb -o u.ply --join both", 2, "--join");
}

}  // namespace
}  // namespace tufa
