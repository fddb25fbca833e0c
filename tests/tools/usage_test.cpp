// The tufa command as people and pipelines use it: what it refuses, and what it says.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/extract.h>
#include <tufa/io.h>
#include <tufa/shapes.h>
#include <string>
#include <utility>
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

class Usage : public CommandTest {
 protected:
  /// Shapes of one file, coarse.
  void writeShapes(const std::string& file, const std::vector<Shape>& shapes) {
    ShapeOptions options;
    options.voxelSize = 0.1;
    std::vector<openvdb::GridBase::ConstPtr> grids;
    for (const Shape shape : shapes) grids.push_back(makeShape(shape, options));
    writeGrids(grids, folder / file);
  }

  [[nodiscard]] Json documentOf(const std::string& glb) const {
    const std::string bytes = readBytes(folder / glb);
    return test::parseJson(bytes.substr(20, static_cast<unsigned char>(bytes.at(12)) +
                                                256u * static_cast<unsigned char>(bytes.at(13))));
  }
};

std::string lastLineOf(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  const std::size_t begin = text.rfind('\n', end);
  return text.substr(begin + 1, end - begin);
}

TEST_F(Usage, MeshSplitsNormalsAtCreases) {
  writeShapes("box.vdb", {Shape::Box});
  writeShapes("fog.vdb", {Shape::Fog});
  // More vertices in the file than the mesh has, or as many.
  const auto added = [&](const std::string& arguments) {
    const Outcome outcome = run("mesh " + arguments + " -o m.glb --json");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return documentOf("m.glb")["accessors"][0]["count"].get<int>() -
           test::parseJson(outcome.out).at("vertices").get<int>();
  };
  EXPECT_GT(added("box.vdb"), 0);
  EXPECT_EQ(added("box.vdb --crease 180"), 0);
  EXPECT_EQ(added("fog.vdb --iso 0.3 --crease 180"), 0);
  EXPECT_GT(added("fog.vdb --iso 0.3 --crease 20"), 0);
  expectFailure("mesh box.vdb -o n.glb --crease 181", 2, "--crease");
}

TEST_F(Usage, RefusesWordsThatExcludeEachOther) {
  makeSphere();
  for (const auto& [words, part] : std::vector<std::pair<std::string, std::string>>{
           {"--uniform --fast", "--uniform"},
           {"--uniform --tolerance 1", "--tolerance means nothing to --uniform"},
           {"--uniform --min-angle 10", "--min-angle means nothing to --uniform"},
           {"--simplify --fast", "--simplify excludes --fast"},
           {"--max-angle 20 --simplify", "--max-angle bounds cells"},
           {"--crease 30", ".glb, .obj and .usda"},
           {"--method mc --fast", "--fast"},
           {"--tile-faces -1", "--tile-faces"},
           {"--tolerance -1", "0 or more"}}) {
    expectFailure("mesh s.vdb -o m.ply " + words, 2, part);
  }
  expectFailure("mesh s.vdb -o m_####.ply", 2, "place for a frame's number");
  expectFailure("mesh s.vdb -o ''", 2, "output is empty");
  expectFailure("mesh '' -o m.ply", 2, "input is empty");
  expectFailure("chunks s.vdb -o -", 2, "a folder");
  expectFailure("chunks s.vdb -o d --fast", 2, "--fast");
  expectFailure("lod s.vdb -o m.glb --tolerance 0", 2, "tolerance 0");
  expectFailure("compare s.vdb -o a.md -o a.md", 2, "two outputs");
  expectFailure("--verbose", 2, "no option --verbose");
}

TEST_F(Usage, TellsOfOpenMeshes) {
  writeBytes(folder / "open.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  writeBytes(folder / "soup.obj",  // closed, with corners of its own for each face
             "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 0 0\nv 0 0 1\nv 0 1 0\n"
             "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n");
  const Outcome open = run("voxelize open.obj -o v.vdb --voxel 0.1");
  EXPECT_EQ(open.exitCode, 0);
  EXPECT_NE(open.err.find("the mesh is open: 3 edges belong to one face only"), std::string::npos);
  EXPECT_EQ(run("voxelize soup.obj -o v.vdb --voxel 0.1").err, "");
}

TEST_F(Usage, RefusesAnOutputThatIsAnInput) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb --quiet -o in.ply").exitCode, 0);
  ASSERT_EQ(run("chunks s.vdb --quiet --levels 1 -o d").exitCode, 0);
  std::filesystem::create_symlink("in.ply", folder / "link.vdb");
  std::filesystem::create_symlink("s.vdb", folder / "link_LOD1.ply");
  std::filesystem::create_hard_link(folder / "s.vdb", folder / "hard.stl");
  std::string chunk;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "d")) {
    if (entry.path().extension() == ".glb") chunk = "d/" + entry.path().filename().string();
  }
  const std::string volume = readBytes(folder / "s.vdb");
  const std::string mesh = readBytes(folder / "in.ply");
  expectFailure("voxelize in.ply -o in.ply --voxel 0.1", 2, ".vdb");
  expectFailure("voxelize in.ply -o link.vdb --voxel 0.1", 2, "overwritten");
  expectFailure("voxelize ./in.ply -o d/../link.vdb --voxel 0.1", 2, "overwritten");
  expectFailure("mesh s.vdb -o hard.stl", 2, "overwritten");
  expectFailure("lod s.vdb --separate -o link.ply", 2, "overwritten");
  expectFailure("chunks --assemble d --lods all:0 -o " + chunk, 2, "overwritten");
  EXPECT_EQ(readBytes(folder / "s.vdb"), volume);
  EXPECT_EQ(readBytes(folder / "in.ply"), mesh);
}

TEST_F(Usage, ChecksTheEndingOfEveryOutput) {
  makeSphere();
  expectFailure("make sphere -o s.stl", 2, ".vdb");
  expectFailure("make sphere -o s", 2, ".vdb");
  expectFailure("voxelize none.ply --voxel 1 -o v.ply", 2, ".vdb");
  expectFailure("mesh s.vdb -o m.vdb", 2, "ending");
  expectFailure("lod s.vdb -o m.vdb", 2, "ending");
  expectFailure("lod s.vdb -o m.glb --report page.glb", 2, ".html");
  expectFailure("chunks s.vdb -o x.glb", 2, "--assemble");
}

TEST_F(Usage, FogNeedsAnIsovalue) {
  writeShapes("fog.vdb", {Shape::Fog});
  for (const char* command :
       {"mesh fog.vdb -o m.ply", "lod fog.vdb -o m.glb", "chunks fog.vdb -o d"}) {
    expectFailure(command, 2, "values from");
    expectFailure(command, 2, "--iso auto");
    expectFailure(std::string(command) + " --iso some", 2, "--iso is a number or auto");
  }
  const Outcome automatic = run("mesh fog.vdb -o m.ply --iso auto");
  EXPECT_EQ(automatic.exitCode, 0) << automatic.err;
  EXPECT_NE(automatic.err.find("note: isovalue 0."), std::string::npos) << automatic.err;
  expectFailure("check m.ply --against fog.vdb", 2, "--iso");
  const Outcome given = run("mesh fog.vdb -o m.ply --iso 0.3 --json");
  EXPECT_EQ(given.exitCode, 0);
  EXPECT_EQ(given.err, "");
  EXPECT_EQ(test::parseJson(given.out).at("isovalue"), 0.3);
}

TEST_F(Usage, NamesTheGridThatItTook) {
  writeShapes("all.vdb", {Shape::Sphere, Shape::Box, Shape::Torus});
  const Outcome outcome = run("mesh all.vdb -o m.ply");
  EXPECT_EQ(outcome.exitCode, 0);
  EXPECT_NE(outcome.err.find("\"sphere\" was taken, one of 3"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out.rfind("grid \"sphere\": ", 0), 0u) << outcome.out;
  EXPECT_EQ(run("mesh all.vdb -o m.ply --grid box").err, "");
  EXPECT_EQ(run("mesh all.vdb -o m.ply --quiet").err, "");
}

TEST_F(Usage, MeshesSeveralGrids) {
  writeShapes("all.vdb", {Shape::Sphere, Shape::Box, Shape::Torus});
  const Outcome outcome = run("mesh all.vdb -o m.glb --grid '*o*' --check --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const Json grids = test::parseJson(outcome.out).at("grids");
  ASSERT_EQ(grids.size(), 2u);
  EXPECT_EQ(grids[0]["grid"], "box");
  EXPECT_EQ(grids[1]["grid"], "torus");
  EXPECT_EQ(grids[1]["check"]["euler_characteristic"], 0);
  const Json document = documentOf("m.glb");
  ASSERT_EQ(document["nodes"].size(), 2u);
  EXPECT_EQ(document["nodes"][1]["name"], "torus");
  EXPECT_EQ(document["scenes"][0]["nodes"], Json({0, 1}));
  const std::size_t triangles =
      grids[0]["triangles"].get<std::size_t>() + grids[1]["triangles"].get<std::size_t>();
  EXPECT_EQ(readMesh(folder / "m.glb").triangleCount(), triangles);

  EXPECT_EQ(run("mesh all.vdb -o m.obj --grid torus --grid box --quiet").exitCode, 0);
  EXPECT_EQ(readMesh(folder / "m.obj").triangleCount(), triangles);
  EXPECT_EQ(run("mesh all.vdb -o 'm_{}.ply' --grid '*' --quiet").exitCode, 0);
  EXPECT_EQ(run("mesh all.vdb -o '{}_{}.ply' --grid sphere --quiet").exitCode, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "sphere_sphere.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder / "m_sphere.ply"));
  EXPECT_EQ(readMesh(folder / "m_box.ply").triangleCount(), grids[0]["triangles"]);
  expectFailure("mesh all.vdb -o n.ply --grid '*'", 2, "{}");
  expectFailure("mesh all.vdb -o n.glb --grid 'x*'", 3, "\"sphere\", \"box\", \"torus\"");
}

TEST_F(Usage, SuggestsASubcommand) {
  expectFailure("mehs s.vdb -o m.ply", 2, "did you mean mesh?");
  expectFailure("vox", 2, "did you mean voxelize?");
  expectFailure("help chnks", 2, "did you mean chunks?");
  const Outcome help = run("help mesh");
  EXPECT_EQ(help.exitCode, 0);
  EXPECT_EQ(help.out, run("mesh --help").out);
  EXPECT_NE(run("help").out.find("voxelize"), std::string::npos);
}

TEST_F(Usage, SuggestsAnOption) {
  makeSphere();
  expectFailure("mesh s.vdb -o m.ply --tolerence 0.2", 2,
                "there is no option --tolerence; did you mean --tolerance? (see tufa mesh");
  expectFailure("lod s.vdb -o m.glb --triangle=30", 2, "did you mean --triangles?");
  expectFailure("mesh s.vdb --outputt m.ply", 2, "did you mean --output?");
  expectFailure("mesh s.vdb -o m.ply --wavelength 3", 2, "there is no option --wavelength (see");
  expectFailure("mesh s.1.vdb s.2.vdb -o m.ply", 2, "by one name in quotes, 'smoke.####.vdb'");
}

TEST_F(Usage, NamesFlagsAsTheyAreTyped) {
  const std::string help = run("help mesh").out;
  EXPECT_NE(help.find("--simplify,--no-simplify,--fast\n"), std::string::npos) << help;
  EXPECT_EQ(help.find("{false}"), std::string::npos) << help;
}

TEST_F(Usage, RefusesCountsBelowWhatTheyMayBe) {
  makeSphere();
  expectFailure("lod s.vdb -o m.glb --triangles -5", 2,
                "--triangles: -5 is not a whole number, 4 or more");
  expectFailure("lod s.vdb -o m.glb --triangles 100,3", 2, "3 is not a whole number, 4 or more");
  expectFailure("lod s.vdb -o m.glb --triangles 100,200", 2, "200 follows 100");
  expectFailure("lod s.vdb -o m.glb --tolerances 0.5,0.1", 2, "0.1 follows 0.5");
  expectFailure("import s.vdb -o o.vdb --size 1,1,1 --header -3", 2,
                "--header: -3 is not a whole number, 0 or more");
  expectFailure("mesh s.vdb -o m.ply --threads 1.5", 2,
                "--threads: 1.5 is not a whole number from 0 to 4096");
  expectFailure("lod s.vdb -o m.glb --levels 101", 2, "101 is not a whole number from 1 to 100");
  expectFailure("lod s.vdb -o m.glb --scale inf", 2, "inf is not a number above 0");
  expectFailure("chunks s.vdb -o d --tolerance 0", 2, "no level can follow one of tolerance 0");
}

TEST_F(Usage, TellsOfTheWrongSide) {
  makeSphere();
  const Outcome outcome = run("mesh s.vdb -o m.ply --inside above --check");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.err.find("not outward; --inside says which side of the isovalue is solid"),
            std::string::npos)
      << outcome.err;
}

TEST_F(Usage, TellsOfOneChunkThatItIsNoMesh) {
  makeSphere();
  ASSERT_EQ(run("chunks s.vdb -o d --chunk 8 --quiet").exitCode, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "d")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with("_LOD0.glb")) continue;
    expectFailure("check d/" + name, 1, "is one chunk, both strips at each face in it");
    break;
  }
}

TEST_F(Usage, SaysWhatIsWrongInFewWords) {
  makeSphere();
  expectFailure("mesh s.vdb a b c -o m.ply", 2,
                "unexpected arguments a b c (see tufa mesh --help)");
  expectFailure("mesh", 2, "(see tufa mesh --help)");
  expectFailure("info -x.vdb", 2,
                "there is no option -x.vdb; a file of that name is written ./-x.vdb");
  expectFailure("lod s.vdb -o m.glb --scale -1", 2, "--scale: -1 is not a number above 0 (see");
  expectFailure("make sphere --voxel 1e-6 -o v.vdb", 2, "--voxel: OpenVDB takes no voxels");
  for (const char* command : {"mesh none.vdb -o m.ply", "check none.ply", "info none.vdb",
                              "chunks --assemble none --lods all:0 -o m.ply"}) {
    expectFailure(command, 3, ": No such file or directory\n");
  }
  EXPECT_EQ(run("mesh s.vdb -o m.ply --quiet --tolerance 0.005W").exitCode, 0);
  const Outcome chunks = run("chunks s.vdb -o d --levels 1 --only 9,0,0 --only 0,0,0");
  EXPECT_EQ(chunks.exitCode, 0);
  EXPECT_NE(chunks.err.find("no surface in chunk 9,0,0"), std::string::npos) << chunks.err;
}

TEST_F(Usage, TellsOfFailuresInJson) {
  makeSphere();
  const auto errorOf = [&](const std::string& arguments, int exitCode) {
    const Outcome outcome = run(arguments + " --json");
    EXPECT_EQ(outcome.exitCode, exitCode);
    const Json error = test::parseJson(outcome.out).at("error");
    EXPECT_EQ("tufa: " + error.at("message").get<std::string>() + "\n", outcome.err);
    return error.at("code").get<std::string>();
  };
  EXPECT_EQ(errorOf("mesh none.vdb -o m.ply", 3), "unreadable_file");
  EXPECT_EQ(errorOf("mesh s.vdb -o none/m.ply", 3), "unwritable_file");
  EXPECT_EQ(errorOf("mesh s.vdb -o m.ply --grid x", 3), "unknown_grid");
  EXPECT_EQ(errorOf("mesh s.vdb -o m.ply --iso 9", 3), "unsupported_grid");
  EXPECT_EQ(errorOf("mesh s.vdb", 2), "invalid_argument");
}

TEST_F(Usage, WritesEmptyFramesIfAllowed) {
  makeSphere();
  writeGrids({openvdb::FloatGrid::create(1.0f)}, folder / "empty.vdb");
  for (const char* volume : {"empty.vdb", "s.vdb --iso 9"}) {
    for (const char* output : {"m.ply", "m.obj", "m.stl", "m.off", "m.glb"}) {
      const Outcome outcome =
          run(std::string("mesh ") + volume + " --allow-empty --check --json -o " + output);
      EXPECT_EQ(outcome.exitCode, 0) << volume << " " << output << outcome.err;
      EXPECT_EQ(test::parseJson(outcome.out).at("triangles"), 0);
      EXPECT_TRUE(std::filesystem::exists(folder / output));
      std::filesystem::remove(folder / output);
    }
  }
  EXPECT_EQ(run("lod s.vdb --iso 9 --allow-empty -o m.glb").exitCode, 0);
}

TEST_F(Usage, SaysInItsLastLineWhatItWrote) {
  const auto lastLine = [&](const std::string& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0) << arguments << outcome.err;
    return lastLineOf(outcome.out);
  };
  EXPECT_EQ(lastLine("make sphere --voxel 0.1 -o s.vdb").rfind("wrote s.vdb, ", 0), 0u);
  EXPECT_EQ(lastLine("mesh s.vdb --check -o m.ply").rfind("wrote m.ply, ", 0), 0u);
  EXPECT_EQ(lastLine("voxelize m.ply --voxel 0.1 -o v.vdb").rfind("wrote v.vdb, ", 0), 0u);
  EXPECT_EQ(lastLine("lod s.vdb --levels 2 -o l.glb").rfind("wrote l.glb, ", 0), 0u);
  EXPECT_EQ(lastLine("lod s.vdb --levels 2 --separate -o l.ply")
                .rfind("wrote l_LOD0.ply and l_LOD1.ply, ", 0),
            0u);
  EXPECT_EQ(lastLine("chunks s.vdb --levels 1 -o d").rfind("wrote 9 files to d, ", 0), 0u);
  EXPECT_EQ(lastLine("chunks --assemble d --lods all:0 -o a.ply").rfind("wrote a.ply, ", 0), 0u);
}

TEST_F(Usage, MakeAndVoxelizeAreQuietOrSpeakJson) {
  const Outcome made = run("make sphere --voxel 0.1 -o s.vdb --json");
  EXPECT_EQ(test::parseJson(made.out).at("output"), "s.vdb");
  ASSERT_EQ(run("mesh s.vdb --quiet -o m.ply").exitCode, 0);
  const Outcome voxelized = run("voxelize m.ply --voxel 0.1 -o v.vdb --json");
  const Json json = test::parseJson(voxelized.out);
  EXPECT_EQ(json.at("file"), "m.ply");
  EXPECT_GT(json.at("active_voxels"), 0);
  for (const char* arguments : {"make sphere --voxel 0.1 -o s.vdb --quiet",
                                "voxelize m.ply --voxel 0.1 -o v.vdb --quiet"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out + outcome.err, "") << arguments;
  }
}

TEST_F(Usage, MeshTakesEveryMethodAndRefusesWhatMeansNothingToIt) {
  makeSphere();
  for (const std::string_view method : methodNames()) {
    const Outcome outcome =
        run("mesh s.vdb -o m.ply --check --json --method " + std::string(method));
    EXPECT_EQ(outcome.exitCode, 0) << method << outcome.err;
    EXPECT_EQ(test::parseJson(outcome.out)["method"], method);
    std::filesystem::remove(folder / "m.ply");
  }
  expectFailure("mesh s.vdb -o m.ply --method cubes", 2, "cubes");
  expectFailure("mesh s.vdb -o m.ply --method mc --tolerance 1", 2, "--tolerance");
  const auto trianglesOf = [&](const std::string& method) {
    const Outcome outcome = run("mesh s.vdb -o m.ply --check --json --method " + method);
    EXPECT_EQ(outcome.exitCode, 0) << method << outcome.err;
    std::filesystem::remove(folder / "m.ply");
    return test::parseJson(outcome.out)["triangles"].get<int>();
  };
  EXPECT_LT(2 * trianglesOf("cms --tolerance 0.5"), trianglesOf("cms"));
  expectFailure("mesh s.vdb -o m.ply --method mc --sharp-angle 20", 2, "--sharp-angle");
  expectFailure("mesh s.vdb -o m.ply --method mc --refine -1", 2, "refine");
  expectFailure("mesh s.vdb -o m.ply --method mc --refine x", 2, "--refine");
  EXPECT_EQ(run("mesh s.vdb -o m.ply --method mc --refine 0.01 --check --quiet").exitCode, 0);
  std::filesystem::remove(folder / "m.ply");
  expectFailure("mesh s.vdb -o m.ply --method emc --sharp-angle 200", 2, "sharp angle");
  expectFailure("mesh s.vdb -o m.ply --ambiguity original", 2, "original");
  EXPECT_EQ(run("mesh s.vdb -o m.ply --method mc --ambiguity original --quiet").exitCode, 0);
  for (const std::string method : {"mc33", "cms", "mt5", "mt6", "mt24", "bcc"}) {
    expectFailure("mesh s.vdb -o m.ply --ambiguity join --method " + method, 2,
                  "--ambiguity is for");
  }
}

TEST_F(Usage, RepairMakesASoupWatertightOrSaysWhatIsLeft) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o m.stl --quiet").exitCode, 0);  // a format without shared vertices
  const Outcome whole = run("repair m.stl -o r.ply --json");
  EXPECT_EQ(whole.exitCode, 0) << whole.err;
  const Json json = test::parseJson(whole.out);
  EXPECT_EQ(json["after"]["watertight"], true);
  EXPECT_EQ(json["kept_input"], false);
  writeBytes(folder / "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome open = run("repair t.obj -o r.ply");
  EXPECT_EQ(open.exitCode, 1);
  EXPECT_NE(open.out.find("3 boundary edges"), std::string::npos) << open.out;
  expectFailure("repair m.stl -o m.stl", 2, "m.stl");
}

// Two tetrahedra with an edge in common: repair splits it, and readers of .stl join it again.
TEST_F(Usage, RepairJudgesAnStlAsItIsRead) {
  writeBytes(folder / "two.off",
             "OFF\n6 8 0\n0 0 0\n0 0 1\n1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n"
             "3 0 2 1\n3 0 3 2\n3 0 1 3\n3 1 2 3\n3 0 4 1\n3 0 5 4\n3 0 1 5\n3 1 4 5\n");
  EXPECT_EQ(run("repair two.off -o r.off --quiet").exitCode, 0);
  const Outcome outcome = run("repair two.off -o r.stl --json");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.err.find("touching vertices are one in .stl; write .ply"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(test::parseJson(outcome.out)["after"]["watertight"], false);
  EXPECT_EQ(run("check r.stl --quiet").exitCode, 1);
}

TEST_F(Usage, RepairRefusesWhatIsNoHole) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o m.stl --quiet").exitCode, 0);
  expectFailure("repair m.stl -o n.ply --fill -1", 2, "holes");
}

}  // namespace
}  // namespace tufa
