// What is not as the command takes it, and whether it says how to go on.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/io.h>
#include <filesystem>
#include <string>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using Json = nlohmann::json;

class Hints : public CommandTest {
 protected:
  /// v.vdb: a sphere, another one, float values of 2 and integers, by their names.
  void makeVolume() {
    makeSphere();
    const auto sphere = readGrid((folder / "s.vdb").string());
    sphere->setName("first");
    const auto other = sphere->deepCopyGrid();
    other->setName("second");
    const auto twice = openvdb::FloatGrid::create(2);
    twice->setName("twice");
    twice->setTransform(sphere->transform().copy());
    twice->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(3)), 2);
    const auto labels = openvdb::Int32Grid::create(0);
    labels->setName("labels");
    labels->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(3)), 5);
    writeGrids({sphere, other, twice, labels}, folder / "v.vdb");
    writeGrids({labels}, folder / "l.vdb");
  }

  bool exists(const char* file) { return std::filesystem::exists(folder / file); }
};

TEST_F(Hints, ForFramesNamedAsElsewhere) {
  expectFailure("mesh 's.%04d.vdb' -o m.ply", 2, "s.####.vdb");
  expectFailure("mesh 's.$F3.vdb' -o m.ply", 2, "s.###.vdb");
  expectFailure("lod 's.$F.vdb' -o m.glb", 2, "s.#.vdb");
  expectFailure("lod 's.####.vdb' -o m.glb", 2, "only tufa mesh takes one");
  expectFailure("mesh 's.100%.vdb' -o m.ply", 3, "No such file");
}

TEST_F(Hints, ForPatternsInThePlaceOfAName) {
  makeVolume();
  expectFailure("lod v.vdb -o m.glb --grid '*'", 2, "holds \"first\", \"second\"");
  EXPECT_EQ(run("mesh v.vdb -o m.glb --grid 'f*' --quiet").exitCode, 0);
}

TEST_F(Hints, ForFilesOfOtherKinds) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o s.STL").exitCode, 0);
  expectFailure("mesh s.STL -o m.ply", 3, "it is not an OpenVDB file; tufa voxelize");
  expectFailure("check s.vdb", 2, "tufa mesh makes meshes of volumes");
  for (const auto& [name, part] : {std::pair("ct.mhd", "tufa import"), {"s.json", "tufa model"}}) {
    test::writeBytes(folder / name, "text of another kind");
    expectFailure(std::string("info ") + name, 3, part);
  }
}

TEST_F(Hints, SayWhatNumbersAnOptionTakes) {
  expectFailure("make noise -o c.vdb --seed -5", 2, "--seed: -5 is not a whole number, 0 or more");
  expectFailure("make noise -o c.vdb --voxel abc", 2, "--voxel: abc is not a number");
  expectFailure("mesh s.vdb -o m.ply --min-cell 1.5", 2, "--min-cell: 1.5 is not a whole number");
}

TEST_F(Hints, ForFramesOfOtherDigits) {
  makeSphere();
  for (const char* frame : {"f.0001.vdb", "f.0002.vdb"}) {
    std::filesystem::copy_file(folder / "s.vdb", folder / frame);
  }
  expectFailure("mesh 'f.##.vdb' -o 'm.##.ply'", 3, "; there are files of f.####.vdb");
  const Outcome none = run("mesh 'g.##.vdb' -o 'm.##.ply'");
  EXPECT_EQ(none.err.find("there are files"), std::string::npos) << none.err;
}

TEST_F(Hints, ForMeshesThinnerThanVoxels) {
  test::writeBytes(
      folder / "t.off",
      "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const Outcome thin = run("voxelize t.off -o t.vdb --voxel 0.3");
  EXPECT_EQ(thin.exitCode, 0);
  EXPECT_NE(thin.err.find("thinner than the voxels of 0.3"), std::string::npos) << thin.err;
  EXPECT_EQ(run("voxelize t.off -o t.vdb --voxel 0.02").err, "");
}

TEST_F(Hints, ForSurfacesAtTheEdgeOfTheBand) {
  makeSphere();
  const auto noteAt = [&](const char* isovalue) {
    return run("mesh s.vdb -o m.ply --iso " + std::string(isovalue)).err;
  };
  EXPECT_NE(noteAt("0.25").find("less than a voxel from the edge"), std::string::npos);
  EXPECT_NE(noteAt("-0.25").find("less than a voxel from the edge"), std::string::npos);
  EXPECT_EQ(noteAt("0.1"), "");
}

TEST_F(Hints, ForFogThatIsCalledALevelSet) {
  openvdb::initialize();
  const auto fog = openvdb::FloatGrid::create(0);
  fog->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(9)), 1);
  fog->setGridClass(openvdb::GRID_LEVEL_SET);
  writeGrids({fog}, folder / "fog.vdb");
  expectFailure("mesh fog.vdb -o m.ply", 3, "a fog volume, which needs --iso");
}

TEST_F(Hints, ForDistancesThatMergeTooMuch) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o whole.stl --quiet").exitCode, 0);
  ASSERT_EQ(run("mesh s.vdb -o m.stl --clip -2,-2,-2,2,2,0 --quiet").exitCode, 0);
  EXPECT_NE(run("repair m.stl -o r.ply --merge 10").out.find("a smaller one may"),
            std::string::npos);
  EXPECT_NE(run("repair whole.stl -o r.ply --merge 10").out.find("nothing to repair"),
            std::string::npos);
}

TEST_F(Hints, ForMeshesOfAFewVoxels) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o m.ply --quiet").exitCode, 0);
  EXPECT_NE(run("voxelize m.ply -o v.vdb --voxel 1").err.find("is in the mesh's units"),
            std::string::npos);
  EXPECT_EQ(run("voxelize m.ply -o v.vdb --voxel 0.1").err, "");
}

TEST_F(Hints, ForIntegersAndFolders) {
  makeVolume();
  expectFailure("mesh l.vdb -o m.ply", 3, "--labels all");
  EXPECT_NE(run("info l.vdb").out.find("tufa mesh --labels"), std::string::npos);
  ASSERT_EQ(run("chunks s.vdb -o d --levels 1 --quiet").exitCode, 0);
  expectFailure("check d", 2, "tufa chunks --assemble d --lods all:0");
  expectFailure("mesh d -o m.ply", 2, "tufa chunks --assemble d --lods all:0");
  expectFailure("mesh v.vdb -o m.ply --labels all --grid first", 3, "does not hold 32- or 64-bit");
  expectFailure("import - -o i.vdb --size 1,1,1", 2, "read from files");
  expectFailure("import none.png -o i.vdb", 3, "there is no such file");
}

TEST_F(Hints, NameTheGridThatADistanceIsTo) {
  makeVolume();
  ASSERT_EQ(run("mesh v.vdb --grid second -o m.ply --quiet").exitCode, 0);
  const Outcome any = run("check m.ply --against v.vdb --json");
  EXPECT_EQ(any.exitCode, 0) << any.err;
  EXPECT_NE(any.err.find("grid \"first\" was taken, one of 3"), std::string::npos) << any.err;
  const Json distance = test::parseJson(any.out).at("distance");
  EXPECT_EQ(distance.at("grid"), "first");
  EXPECT_EQ(distance.at("file"), "v.vdb");
  EXPECT_EQ(run("check m.ply --against v.vdb --grid second").err, "");
}

TEST_F(Hints, FilesMayStandBehindOptionsOfSeveralValues) {
  makeSphere();
  EXPECT_EQ(run("lod --triangles 300,100 s.vdb -o a.glb --quiet").exitCode, 0);
  EXPECT_EQ(run("lod --tolerances 0.1,1 s.vdb -o b.glb --quiet").exitCode, 0);
  EXPECT_EQ(run("compare --methods mc -o c.json -o c.md s.vdb --quiet").exitCode, 0);
  EXPECT_TRUE(exists("c.json") && exists("c.md"));
  expectFailure("chunks --only 0,0,0 s.vdb -o d", 2, "before --only");
}

TEST_F(Hints, OptionsThatMeanNothingAreRefused) {
  expectFailure("make sphere --seed 5 -o x.vdb", 2, "--seed is for terrain, noise and fog");
  expectFailure("make noise --half-width 9 -o x.vdb", 2, "--half-width is for level sets");
  EXPECT_EQ(run("make terrain --seed 5 --voxel 0.2 --half-width 4 -o x.vdb").exitCode, 0);
  expectFailure("repair x.stl -o -", 2, "written to a file");
}

TEST_F(Hints, ChainsMultiplyTheirTolerances) {
  makeVolume();
  const auto trianglesOf = [&](const std::string& options) {
    const Outcome outcome = run("lod v.vdb --grid first -o m.glb --json --levels 1 " + options);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return test::parseJson(outcome.out).at("levels").at(0).at("triangles").get<int>();
  };
  EXPECT_EQ(trianglesOf("--tolerance-grid twice"), trianglesOf("--tolerance 0.2"));
  EXPECT_NE(trianglesOf("--tolerance-grid twice"), trianglesOf(""));
}

TEST_F(Hints, EmptyChainsAreWritten) {
  openvdb::initialize();
  const auto empty = openvdb::createLevelSet<openvdb::FloatGrid>();
  empty->setName("e");
  writeGrids({empty}, folder / "e.vdb");
  const Outcome outcome = run("lod e.vdb -o 'e{}.ply' --allow-empty");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("wrote e0.ply"), std::string::npos) << outcome.out;
  EXPECT_TRUE(readMesh((folder / "e0.ply").string()).triangles.empty());
  const Outcome mesh = run("mesh e.vdb -o m.ply --allow-empty --check");
  EXPECT_EQ(mesh.exitCode, 0);
  EXPECT_NE(mesh.err.find("an empty mesh is not checked"), std::string::npos) << mesh.err;
}

}  // namespace
}  // namespace tufa
