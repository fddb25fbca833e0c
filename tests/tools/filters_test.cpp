// Filters on the command line: their order, their report, and what is wrong with them.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
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

class FilterOptions : public CommandTest {
 protected:
  static FloatGrid::Ptr makeBall(float radius, float x) {
    return openvdb::tools::createLevelSetSphere<FloatGrid>(radius, {x, 0, 0}, 0.1F);
  }

  void SetUp() override {
    auto dust = makeBall(1, 0);
    openvdb::tools::csgUnion(*dust, *makeBall(0.3F, 2));
    dust->setName("dust");
    auto half = makeBall(1, 1);
    half->setName("half");
    writeGrids({dust, half}, folder / "d.vdb");
  }

  Json report(const std::string& arguments) {
    const Outcome outcome = run(arguments + " --json");
    EXPECT_EQ(outcome.exitCode, 0) << arguments << "\n" << outcome.err;
    return test::parseJson(outcome.out);
  }
};

TEST_F(FilterOptions, WorkInTheOrderGiven) {
  const Json json =
      report("mesh d.vdb -o m.ply --offset -0.5 --keep-largest 1 --offset 0.05w --smooth mean:2");
  const Json& filters = json.at("filters");
  ASSERT_EQ(filters.size(), 4u);
  EXPECT_EQ(filters[0]["filter"], "offset");
  EXPECT_EQ(filters[0]["value"], "-0.5");
  EXPECT_EQ(filters[1]["filter"], "keep-largest");
  EXPECT_EQ(filters[1]["components"], 2);
  EXPECT_EQ(filters[1]["components_kept"], 1);
  EXPECT_EQ(filters[2]["value"], "0.05w");
  EXPECT_EQ(filters[3]["value"], "mean:2");
  EXPECT_GT(json.at("seconds").at("filter"), 0);
  // Half a voxel inward and 0.05 outward again: the large ball alone, where it was.
  for (const Position& p : readMesh(folder / "m.ply").positions) {
    ASSERT_NEAR(std::hypot(p.x, p.y, p.z), 1, 0.03);
  }
}

TEST_F(FilterOptions, LengthsInVoxelsFollowResampling) {
  for (const char* words : {"--offset 2 --resample 0.05", "--resample 0.05 --offset 4",
                            "--resample 0.05 --offset 0.2w"}) {
    report(std::string("mesh d.vdb -o m.ply --keep-largest 1 ") + words);
    for (const Position& p : readMesh(folder / "m.ply").positions) {
      ASSERT_NEAR(std::hypot(p.x, p.y, p.z), 1.2, 0.02) << words;
    }
  }
}

TEST_F(FilterOptions, AreToldInTheSummaryOfMeshAndLod) {
  for (const char* command : {"mesh d.vdb -o m.glb", "lod d.vdb -o l.glb --levels 2"}) {
    const Outcome outcome = run(std::string(command) + " --min-component 500 --open 1");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("min-component 500: 1 of 2 components kept, "), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("open 1: "), std::string::npos) << outcome.out;
  }
  EXPECT_EQ(report("lod d.vdb -o l.glb --levels 2 --resample 0.05")["filters"].size(), 1u);
  EXPECT_FALSE(report("mesh d.vdb -o m.ply").contains("filters"));
}

TEST_F(FilterOptions, BoxesAndGridsOfTheFileClip) {
  report("mesh d.vdb -o m.ply --clip -2,-2,-2,0,2,2 --cap");
  double greatest = -2;
  for (const Position& p : readMesh(folder / "m.ply").positions) {
    greatest = std::max(greatest, p.x);
  }
  EXPECT_NEAR(greatest, 0, 0.11);
  report("mesh d.vdb -o m.ply --mask half");
  for (const Position& p : readMesh(folder / "m.ply").positions) {
    ASSERT_LT(std::hypot(p.x - 1, p.y, p.z), 1.2);
  }
  // Clipped to its own voxels the surface is whole, whatever ends beside them.
  EXPECT_EQ(run("mesh d.vdb -o m.ply --clip dust --quiet").err, "");
  EXPECT_NE(run("mesh d.vdb -o m.ply --clip half --quiet").err.find("open there"),
            std::string::npos);
  expectFailure("mesh d.vdb -o n.ply --mask none", 3, "no grid \"none\"");
  expectFailure("mesh d.vdb -o n.ply --clip none", 3, "no grid \"none\"");
}

TEST_F(FilterOptions, SayWhatIsWrongBeforeAnythingIsRead) {
  for (const auto& [words, part] : std::vector<std::pair<std::string, std::string>>{
           {"--smooth gauss", "gaussian, mean, median or curvature"},
           {"--smooth mean:0", "1 to 1000"},
           {"--smooth mean:x", "1 to 1000"},
           {"--offset 1v", "--offset"},
           {"--open 0", "above 0"},
           {"--close -1", "above 0"},
           {"--resample 0", "--resample"},
           {"--resample 1w", "--resample"},
           {"--clip 1,2,3", "six numbers"},
           {"--clip 1,0,0,0,1,1", "not below"},
           {"--keep-largest 0", "above 0"},
           {"--min-component x", "above 0"}}) {
    expectFailure("mesh none.vdb -o n.ply " + words, 2, part);
    expectFailure("lod none.vdb -o n.glb " + words, 2, part);
    expectFailure("chunks none.vdb -o n " + words, 2, part);
    expectFailure("filter none.vdb -o n.vdb " + words, 2, part);
  }
}

TEST_F(FilterOptions, ChunksAreOfTheFilteredVolume) {
  const Json json = report("chunks d.vdb -o d --chunk 16 --levels 2 --keep-largest 1 --offset 1");
  ASSERT_EQ(json.at("filters").size(), 2u);
  EXPECT_EQ(json.at("filters")[0]["components_kept"], 1);
  EXPECT_EQ(run("chunks --assemble d --lods all:0 -o m.ply --check").exitCode, 0);
  for (const Position& p : readMesh(folder / "m.ply").positions) {
    ASSERT_NEAR(std::hypot(p.x, p.y, p.z), 1.1, 0.03);
  }
  expectFailure("chunks --assemble d --lods all:0 -o n.ply --smooth mean", 2, "--smooth is not");
  expectFailure("chunks d.vdb -o e --min-component 1000000", 3, "leaves nothing");
}

TEST_F(FilterOptions, FilterWritesWhatOtherCommandsMesh) {
  const std::string words = " --offset -0.5 --keep-largest 1 --offset 0.05w";
  const Json json = report("filter d.vdb -o f.vdb" + words);
  EXPECT_EQ(json.at("filters").size(), 3u);
  EXPECT_EQ(json.at("grid"), "dust");
  EXPECT_GT(json.at("seconds").at("filter"), 0);
  ASSERT_EQ(describeGrids(folder / "f.vdb").size(), 1u);
  EXPECT_EQ(describeGrids(folder / "f.vdb").front().name, "dust");
  EXPECT_EQ(json.at("active_voxels"), describeGrids(folder / "f.vdb").front().activeVoxels);
  report("mesh f.vdb -o a.ply");
  report("mesh d.vdb -o b.ply" + words);
  EXPECT_EQ(test::readBytes(folder / "a.ply"), test::readBytes(folder / "b.ply"));
  const Outcome outcome = run("filter d.vdb -o - --grid half --smooth mean");
  EXPECT_EQ(outcome.exitCode, 0);
  EXPECT_NE(outcome.err.find("smooth mean: "), std::string::npos) << outcome.err;
}

TEST_F(FilterOptions, FilterSaysWhatIsWrong) {
  ASSERT_EQ(run("make fog --voxel 0.05 -o fog.vdb").exitCode, 0);
  EXPECT_EQ(run("filter fog.vdb -o g.vdb --smooth mean").exitCode, 0);
  expectFailure("filter fog.vdb -o n.vdb --keep-largest 1", 2, "needs --iso");
  EXPECT_EQ(run("filter fog.vdb -o g.vdb --keep-largest 1 --iso 0.5").exitCode, 0);
  EXPECT_EQ(run("filter fog.vdb -o g.vdb --smooth mean --nan outside --iso 0.5").exitCode, 0);
  auto other = FloatGrid::create(0);
  other->fill(openvdb::CoordBBox(0, 0, 0, 7, 7, 7), 100);
  other->setName("other");
  writeGrids({other}, folder / "o.vdb");
  expectFailure("filter o.vdb -o n.vdb --keep-largest 1", 2, "is no level set");
  EXPECT_EQ(run("filter o.vdb -o g.vdb --keep-largest 1 --iso 50").exitCode, 0);
  EXPECT_EQ(run("filter o.vdb -o g.vdb --keep-largest 1 --iso auto").exitCode, 0);
  expectFailure("filter d.vdb -o n.vdb", 2, "a filter is needed");
  expectFailure("filter d.vdb -o n.vdb --smooth mean --iso 0", 2, "--iso is for");
  expectFailure("filter d.vdb -o n.vdb --smooth mean --inside above", 2, "--inside is for");
  expectFailure("filter d.vdb -o n.ply --smooth mean", 2, "n.ply");
  expectFailure("filter d.vdb -o d.vdb --smooth mean", 2, "d.vdb");
  expectFailure("filter d.vdb -o n.vdb --min-component 1000000", 3, "leaves nothing");
}

TEST_F(FilterOptions, AFilterThatLeavesNothingIsTold) {
  expectFailure("mesh d.vdb -o n.ply --min-component 1000000", 3,
                "--min-component 1000000 leaves nothing of grid \"dust\"");
  expectFailure("lod d.vdb -o n.glb --smooth mean --clip 10,10,10,11,11,11", 3, "--clip 10,");
  EXPECT_EQ(run("mesh d.vdb -o e.ply --quiet --allow-empty --min-component 1000000").exitCode, 0);
  EXPECT_EQ(readMesh(folder / "e.ply").triangleCount(), 0u);
}

}  // namespace
}  // namespace tufa
