// The tufa command from outside: exit codes, messages, and what it leaves behind.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>
#include <unistd.h>

#include <tufa/io.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Mount;
using test::Outcome;
using test::readBytes;
using test::writeBytes;

using Command = CommandTest;

TEST_F(Command, SaysItsVersionAndHelp) {
  EXPECT_EQ(run("--version").exitCode, 0);
  EXPECT_EQ(run("--help").exitCode, 0);
  EXPECT_EQ(run("mesh --help").exitCode, 0);
}

TEST_F(Command, MeshesWhatItMakes) {
  for (const char* shape :
       {"sphere", "torus", "box", "bracket", "gyroid", "terrain", "noise", "fog"}) {
    ASSERT_EQ(run(std::string("make ") + shape + " --voxel 0.08 -o v.vdb").exitCode, 0) << shape;
    const std::string isovalue = shape == std::string("fog") ? " --iso 0.5" : "";
    const Outcome outcome = run("mesh v.vdb -o m.ply --check" + isovalue);
    EXPECT_EQ(outcome.exitCode, 0) << shape << "\n" << outcome.err;
  }
}

TEST_F(Command, MeshGivesTheKeysOfItsReport) {
  makeSphere();
  const Outcome outcome = run("mesh s.vdb -o m.obj --check --json --threads 2");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = test::parseJson(outcome.out);
  for (const char* key : {"active_voxels", "surface_cells", "vertices", "triangles", "quads",
                          "seconds", "peak_memory_bytes", "threads", "check", "isovalue", "inside",
                          "crease_cells", "open_edges", "face_flips"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* key : {"read", "contour", "check", "write", "stages"}) {
    EXPECT_TRUE(json["seconds"].contains(key)) << key;
  }
  for (const char* key :
       {"closed", "manifold", "oriented", "bounds_volume", "self_intersecting_pairs",
        "boundary_edges", "components", "euler_characteristic"}) {
    EXPECT_TRUE(json["check"].contains(key)) << key;
  }
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["check"]["euler_characteristic"], 2);
  EXPECT_EQ(json["triangles"], readMesh(folder / "m.obj").triangleCount());
}

TEST_F(Command, LodGivesTheKeysOfItsReport) {
  makeSphere();
  const Outcome outcome = run("lod s.vdb -o s.glb --levels 3 --check --json --threads 2");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto json = test::parseJson(outcome.out);
  ASSERT_EQ(json["levels"].size(), 3u);
  EXPECT_EQ(json["outputs"], nlohmann::json({"s.glb"}));
  EXPECT_EQ(json["levels"][2]["tolerance_voxels"], 0.1 * 4 * 4);
  EXPECT_EQ(json["levels"][0]["triangles"], readMesh(folder / "s.glb").triangleCount());
  for (const auto& level : json["levels"]) {
    EXPECT_EQ(level["check"]["watertight"], true);
    EXPECT_EQ(level["check"]["self_intersecting_pairs"], 0);
    EXPECT_LE(level["max_error_voxels"], level["tolerance_voxels"]);
    EXPECT_NEAR(level["smallest_angle_degrees"].get<double>(),
                level["check"]["smallest_angle_degrees"].get<double>(), 1e-9);
  }
}

/// The triangles are the same, two for each quad.
TEST_F(Command, JoinsTrianglesToQuads) {
  ASSERT_EQ(run("make bracket --voxel 0.04 -o b.vdb").exitCode, 0);
  const auto meshed = [&](const std::string& options) {
    const Outcome outcome = run("mesh b.vdb -o b.obj --check --json" + options);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return test::parseJson(outcome.out);
  };
  const auto any = meshed(" --target any"), quads = meshed(" --target quads");
  EXPECT_EQ(any["quads"], 0);
  EXPECT_GT(quads["quads"], 50);
  EXPECT_EQ(quads["triangles"], any["triangles"]);
  EXPECT_EQ(quads["certificate"], any["certificate"]);
  EXPECT_EQ(quads["check"]["watertight"], true);
  EXPECT_NEAR(quads["check"]["area"].get<double>(), any["check"]["area"].get<double>(), 1e-9);
  const Outcome refused = run("mesh b.vdb -o b.obj --method mc --target quads");
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_NE(refused.err.find("--target is for --method dual alone"), std::string::npos);
}

TEST_F(Command, CutsWithoutCollapseIfItIsToBeFast) {
  ASSERT_EQ(run("make torus --voxel 0.04 -o t.vdb").exitCode, 0);
  const Outcome fast = run("mesh t.vdb -o fast.ply --fast --json");
  ASSERT_EQ(fast.exitCode, 0) << fast.err;
  ASSERT_EQ(run("mesh t.vdb -o cut.ply --no-simplify").exitCode, 0);
  EXPECT_EQ(test::readBytes(folder / "fast.ply"), test::readBytes(folder / "cut.ply"));
  EXPECT_LE(test::parseJson(fast.out)["certificate"]["max_error_voxels"], 0.1);
}

/// The figures are those of the checker, and of the text.
TEST_F(Command, TellsWhatCameOfAnAngle) {
  ASSERT_EQ(run("make bracket --voxel 0.04 -o b.vdb").exitCode, 0);
  const auto meshed = [&](const std::string& options) {
    const Outcome outcome = run("mesh b.vdb -o b.ply --check --json" + options);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return test::parseJson(outcome.out);
  };
  const auto any = meshed(""), kept = meshed(" --min-angle 10");
  EXPECT_EQ(any["certificate"]["triangles_under_min_angle"], 0);
  EXPECT_GT(any["check"]["share_under_10_degrees"], 0.02);
  const double triangles = kept["triangles"],
               under = kept["certificate"]["triangles_under_min_angle"];
  EXPECT_NEAR(kept["check"]["share_under_10_degrees"].get<double>(), under / triangles, 1e-12);
  EXPECT_LT(under / triangles, any["check"]["share_under_10_degrees"].get<double>() / 2);
  EXPECT_EQ(kept["check"]["watertight"], true);
  for (const auto& json : {any, kept}) {
    EXPECT_NEAR(json["certificate"]["smallest_angle_degrees"].get<double>(),
                json["check"]["smallest_angle_degrees"].get<double>(), 1e-9);
    EXPECT_LE(json["certificate"]["max_error_voxels"], 0.1);
  }
  const Outcome told = run("mesh b.vdb -o b.ply --min-angle 20");
  EXPECT_NE(told.out.find("of the triangles are under 20\n"), std::string::npos) << told.out;
  const Outcome table = run("lod b.vdb -o b.glb --levels 2 --min-angle 20");
  EXPECT_NE(table.out.find("under 20 degrees"), std::string::npos) << table.out;
  const Outcome chunks = run("chunks b.vdb -o c --min-angle 20 --levels 2 --json");
  ASSERT_EQ(chunks.exitCode, 0) << chunks.err;
  for (const auto& level : test::parseJson(chunks.out)["levels"]) {
    EXPECT_GT(level["triangles_under_min_angle"], 0);
    EXPECT_GT(level["smallest_angle_degrees"], 0);
  }
  expectFailure("mesh b.vdb -o b.ply --min-angle 31", 2, "--min-angle");
  expectFailure("mesh b.vdb -o b.ply --min-angle 20 --uniform", 2, "--uniform");
  expectFailure("mesh b.vdb -o b.ply --min-angle 20 --max-cell 8", 2, "collapsing edges");
  expectFailure("mesh b.vdb -o b.ply --min-angle 20 --method mc", 2, "--method dual alone");
}

TEST_F(Command, LodWritesOneFileOrMany) {
  makeSphere();
  const Outcome outcome = run("lod s.vdb -o s.glb --tolerances 0.1,0.05w --up z --scale 2");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 6) << outcome.out;
  EXPECT_EQ(run("lod s.vdb --levels 2 --quiet -o p.glb --separate --compress").exitCode, 0);
  EXPECT_EQ(run("lod s.vdb --levels 2 --quiet -o p.ply --separate").exitCode, 0);
  EXPECT_EQ(run("lod s.vdb --levels 2 --quiet -o 'level{}.stl'").exitCode, 0);
  EXPECT_EQ(folder.fileCount(), 1 + 1 + 3 * 2);
  for (const char* file : {"p_LOD0.glb", "p_LOD1.glb", "p_LOD0.ply", "level1.stl"}) {
    EXPECT_EQ(run(std::string("check --quiet ") + file).exitCode, 0) << file;
  }
}

TEST_F(Command, LodDrawsAPageThatNeedsNoOther) {
  makeSphere();
  ASSERT_EQ(run("lod s.vdb -o s.glb --levels 2 --quiet --report page.html").exitCode, 0);
  EXPECT_EQ(folder.fileCount(), 3);
  const std::string page = readBytes(folder / "page.html");
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("src=", at)) != std::string::npos; ++at) {
    EXPECT_TRUE(page.substr(at).starts_with("src=\"data:image/png;base64,iVBORw0"));
    ++pictures;
  }
  EXPECT_EQ(pictures, 6u);
  // Encoded pictures hold any letters, but no colon.
  EXPECT_EQ(page.find("://"), std::string::npos);
  const Outcome told = run("lod s.vdb -o s.glb --levels 2 --json --report page.html");
  EXPECT_GT(test::parseJson(told.out)["seconds"]["report"], 0);
}

/// What stands beside the report, under whatever name, is none of its business.
TEST_F(Command, LodReportTouchesNoOtherFile) {
  makeSphere();
  writeBytes(folder / "page.html.tmp", "a user's");
  writeBytes(folder / "victim", "as it was");
  std::filesystem::create_symlink("victim", folder / "linked.html.tmp");
  std::filesystem::create_directory(folder / "empty.html.tmp");
  for (const char* page : {"page.html", "linked.html", "empty.html"}) {
    const std::string report = std::string(" --report ") + page;
    EXPECT_EQ(run("lod s.vdb -o s.glb --levels 1 --quiet" + report).exitCode, 0) << page;
  }
  EXPECT_EQ(readBytes(folder / "page.html.tmp"), "a user's");
  EXPECT_EQ(readBytes(folder / "victim"), "as it was");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "empty.html.tmp"));
  // A device stays one, and gets the page.
  const Outcome outcome = run("lod s.vdb -o s.glb --levels 1 --quiet --report /dev/stdout | cat");
  EXPECT_NE(outcome.out.find("</html>"), std::string::npos) << outcome.err;
}

TEST_F(Command, LodReportIsNoOtherFileOfTheRun) {
  makeSphere();
  std::filesystem::create_symlink("s.vdb", folder / "link.html");
  expectFailure("lod s.vdb -o s.glb --report s.vdb", 2, "overwrite s.vdb");
  expectFailure("lod s.vdb -o s.glb --report link.html", 2, "overwrite s.vdb");
  expectFailure("lod s.vdb -o s.glb --report ./s.glb", 2, "overwrite s.glb");
  expectFailure("lod s.vdb -o 's{}.glb' --report s3.glb", 2, "overwrite s3.glb");
}

TEST_F(Command, LodRefusesWhatItCannotDo) {
  makeSphere();
  expectFailure("lod s.vdb -o s.ply", 2, "--separate");
  expectFailure("lod s.vdb -o s.xyz", 2, "ending");
  expectFailure("lod s.vdb -o 's{}.ply' --compress", 2, "--compress is for .glb only");
  expectFailure("lod s.vdb -o s.glb --levels 0", 2, "--levels");
  expectFailure("lod s.vdb -o s.glb --factor 1", 2, "factor");
  expectFailure("lod s.vdb -o s.glb --scale 0", 2, "--scale");
  expectFailure("lod s.vdb -o s.glb --up x", 2, "--up");
  expectFailure("mesh s.vdb -o s.ply --compress", 2, "--compress are for .glb only");
  expectFailure("chunks s.vdb -o d --format ply --quantize", 2, "--quantize is for --format glb");
  expectFailure("chunks --assemble d --lods all:0 -o s.ply --crease 30", 2, "--crease is not for");
  expectFailure("lod s.vdb -o s.glb --tolerances 0.2,0.1", 2, "rise");
  expectFailure("lod s.vdb -o s.glb --tolerances 0.2,b", 2, "--tolerances");
  expectFailure("lod s.vdb -o s.glb --tolerances 0.2 --levels 2", 2, "--levels");
  expectFailure("lod s.vdb -o none/s.glb", 3, "folder");
  expectFailure("lod s.vdb -o s.glb --report none/page.html", 3, "folder");
  expectFailure("lod none.vdb -o s.glb", 3, "none.vdb");
  expectFailure("lod s.vdb -o s.glb --iso 100", 3, "no surface");
}

TEST_F(Command, CheckAndVoxelizeTakeEveryFormat) {
  makeSphere();
  for (const char* ending : {"ply", "obj", "stl", "off", "glb"}) {
    const std::string name = std::string("m.") + ending;
    ASSERT_EQ(run("mesh s.vdb --quiet -o " + name).exitCode, 0);
    EXPECT_EQ(run("check --quiet " + name).exitCode, 0) << name;
    EXPECT_EQ(run("voxelize --voxel 0.1 -o v.vdb " + name).exitCode, 0) << name;
  }
}

TEST_F(Command, TellsWhetherDistancesAreExact) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb --quiet -o m.ply").exitCode, 0);
  for (const auto& [options, distances] : {std::pair("", "exact"), {" --fast", "openvdb"}}) {
    const Outcome outcome =
        run(std::string("voxelize m.ply --voxel 0.1 -o v.vdb --json") + options);
    EXPECT_EQ(test::parseJson(outcome.out).at("distances"), distances);
  }
}

TEST_F(Command, RefusesWrongUsage) {
  makeSphere();
  expectFailure("", 2, "subcommand");
  expectFailure("fly", 2, "");
  expectFailure("make cube -o c.vdb", 2, "cube");
  expectFailure("make sphere", 2, "output");
  expectFailure("make sphere --voxel 0 -o c.vdb", 2, "voxel size");
  expectFailure("make sphere --voxel nan -o c.vdb", 2, "voxel size");
  expectFailure("mesh s.vdb -o m.txt", 2, ".ply");
  expectFailure("mesh s.vdb -o m.ply --iso nan", 2, "isovalue");
  expectFailure("mesh s.vdb -o m.ply --inside out", 2, "out");
  expectFailure("mesh s.vdb -o m.ply --threads -1", 2, "threads");
  expectFailure("mesh s.vdb -o m.ply --threads many", 2, "threads");
}

TEST_F(Command, RefusesUnusableInput) {
  makeSphere();
  const std::string whole = readBytes(folder / "s.vdb");
  writeBytes(folder / "cut.vdb", whole.substr(0, whole.size() / 2));
  writeBytes(folder / "foreign.vdb", "PK\3\4 something else altogether");
  writeBytes(folder / "empty.vdb", "");
  writeBytes(folder / "broken.ply", "ply\n");
  writeBytes(folder / "bare.obj", "v 0 0 0\n");
  for (const char* command : {"info", "mesh -o m.ply"}) {
    expectFailure(std::string(command) + " none.vdb", 3, "none.vdb");
    expectFailure(std::string(command) + " cut.vdb", 3, "truncated");
    expectFailure(std::string(command) + " foreign.vdb", 3, "not an OpenVDB file");
    expectFailure(std::string(command) + " empty.vdb", 3, "empty");
    expectFailure(std::string(command) + " .", 3, "folder");
  }
  expectFailure("mesh s.vdb -o m.ply --grid density", 3, "\"sphere\"");
  expectFailure("mesh s.vdb -o m.ply --iso 7", 3, "values from");
  expectFailure("check broken.ply", 3, "broken.ply");
  expectFailure("voxelize broken.ply --voxel 1 -o v.vdb", 3, "broken.ply");
  expectFailure("voxelize bare.obj --voxel 1 -o v.vdb", 3, "no faces");
}

TEST_F(Command, RefusesGridsThatCannotBeMeshed) {
  openvdb::initialize();
  auto vectors = openvdb::Vec3SGrid::create();
  vectors->tree().setValueOn(openvdb::Coord(0), openvdb::Vec3f(1));
  writeGrids({vectors}, folder / "vectors.vdb");
  expectFailure("mesh vectors.vdb -o m.ply", 3, "vec3s");
  auto mask = openvdb::BoolGrid::create();
  mask->tree().setValueOn(openvdb::Coord(0), true);
  writeGrids({mask}, folder / "mask.vdb");
  expectFailure("mesh mask.vdb -o m.ply", 3, "bool");
  auto points = openvdb::points::PointDataGrid::create();
  points->tree().touchLeaf(openvdb::Coord(0));
  writeGrids({points}, folder / "points.vdb");
  expectFailure("mesh points.vdb -o m.ply", 3, "ptdataidx32");
  auto indices = openvdb::Int32Grid::create();
  indices->tree().setValueOn(openvdb::Coord(0), 1);
  writeGrids({indices}, folder / "indices.vdb");
  expectFailure("mesh indices.vdb -o m.ply", 3, "int32");
  auto frustum = openvdb::FloatGrid::create(1.0f);
  frustum->tree().setValueOn(openvdb::Coord(0), -1.0f);
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 10, 1));
  writeGrids({frustum}, folder / "frustum.vdb");
  expectFailure("mesh frustum.vdb -o m.ply", 3, "frustum");

  writeGrids({openvdb::FloatGrid::create(1.0f)}, folder / "empty.vdb");
  expectFailure("mesh empty.vdb -o m.ply", 3, "no active voxels");

  makeSphere();
  auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(readGrid(folder / "s.vdb"));
  grid->tree().setValueOn(openvdb::Coord(10, 0, 0), std::nanf(""));
  writeGrids({grid}, folder / "nan.vdb");
  expectFailure("mesh nan.vdb -o m.ply", 3, "10, 0, 0");
  expectFailure("mesh nan.vdb -o m.ply", 3, "1 ");
  EXPECT_EQ(run("mesh nan.vdb -o m.ply --nan outside").exitCode, 0);
}

TEST_F(Command, RefusesUnusableOutput) {
  makeSphere();
  expectFailure("mesh s.vdb -o no/m.ply", 3, "no folder");
  expectFailure("make sphere -o no/m.vdb", 3, "no folder");
  expectFailure("mesh s.vdb -o .", 2, "ending");
  if (std::filesystem::exists("/dev/full")) {
    expectFailure("mesh s.vdb --quiet -o /dev/full", 3, "space");
    expectFailure("make sphere -o /dev/full", 3, "space");
  }
}

TEST_F(Command, RefusesFoldersWithoutPermission) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  makeSphere();
  std::filesystem::create_directory(folder / "locked");
  std::filesystem::permissions(folder / "locked", std::filesystem::perms::owner_read);
  expectFailure("mesh s.vdb -o locked/m.ply", 3, "ermission");
  std::filesystem::permissions(folder / "locked", std::filesystem::perms::owner_all);
}

TEST_F(Command, ExitsWithOneForBrokenPromises) {
  writeBytes(folder / "open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(run("check open.obj").exitCode, 1);
}

TEST_F(Command, TellsOfAFullDisk) {
  makeSphere();
  const Mount disk(folder / "disk", 0, "size=16k");
  if (!disk.mounted()) GTEST_SKIP() << "no file system may be mounted here";
  for (const char* arguments :
       {"mesh s.vdb --uniform -o disk/m.ply", "mesh s.vdb --uniform -o disk/m.obj",
        "make sphere -o disk/s.vdb", "mesh s.vdb --uniform -o disk/m.glb"}) {
    expectFailure(arguments, 3, "No space left");
    EXPECT_TRUE(std::filesystem::is_empty(folder / "disk")) << arguments;
  }
}

TEST_F(Command, TellsOfAReadOnlyDisk) {
  makeSphere();
  const Mount disk(folder / "disk", MS_RDONLY, "");
  if (!disk.mounted()) GTEST_SKIP() << "no file system may be mounted here";
  expectFailure("mesh s.vdb --uniform -o disk/m.ply", 3, "Read-only");
  expectFailure("make sphere -o disk/s.vdb", 3, "Read-only");
}

TEST_F(Command, ChoosesAmongSeveralGrids) {
  ShapeOptions options;
  options.voxelSize = 0.1;
  auto fog = makeShape(Shape::Fog, options);
  auto sphere = makeShape(Shape::Sphere, options);
  auto box = makeShape(Shape::Box, options);
  writeGrids({fog, sphere, box}, folder / "all.vdb");
  const auto gridOf = [&](const std::string& arguments) {
    const Outcome outcome = run("mesh all.vdb -o m.ply --json " + arguments);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return test::parseJson(outcome.out).at("grid").get<std::string>();
  };
  EXPECT_EQ(gridOf(""), "sphere");
  EXPECT_EQ(gridOf("--grid fog --iso 0.5"), "fog");
  EXPECT_EQ(gridOf("--grid box"), "box");
  expectFailure("mesh all.vdb -o n.ply --grid bow", 3, "\"fog\", \"sphere\", \"box\"");
  const Outcome info = run("info all.vdb --json");
  const auto grids = test::parseJson(info.out).at("grids");
  ASSERT_EQ(grids.size(), 3U);
  for (const char* key : {"name", "class", "value_type", "transform", "voxel_size", "active_voxels",
                          "tiles", "non_finite_values", "meshable"}) {
    EXPECT_TRUE(grids[0].contains(key)) << key;
  }
}

TEST_F(Command, SaysNothingWhenQuiet) {
  makeSphere();
  for (const char* arguments : {"mesh s.vdb -o m.ply --check --quiet", "check m.ply --quiet"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out + outcome.err, "") << arguments;
  }
}

TEST_F(Command, CheckComparesWithTheVolume) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb --uniform -o m.ply --quiet").exitCode, 0);
  const Outcome outcome = run("check m.ply --against s.vdb --json");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto distance = test::parseJson(outcome.out).at("distance");
  for (const char* side : {"mesh_to_surface", "surface_to_mesh"}) {
    EXPECT_LT(distance.at(side).at("largest").get<double>(), 0.1) << side;
    EXPECT_GT(distance.at(side).at("samples").get<int>(), 1000) << side;
  }
  expectFailure("check m.ply --against none.vdb", 3, "none.vdb");
}

TEST_F(Command, NamesTheEdgeOfTheDataAndCapsIt) {
  ShapeOptions options;
  options.voxelSize = 0.1;
  const auto grid = makeShape(Shape::Sphere, options);
  grid->clip(openvdb::CoordBBox(openvdb::Coord(-20), openvdb::Coord(20, 20, 3)));
  writeGrids({grid}, folder / "cut.vdb");
  const Outcome open = run("mesh cut.vdb -o m.ply --check --json");
  EXPECT_EQ(open.exitCode, 1);
  EXPECT_NE(open.err.find("runs out of the data"), std::string::npos) << open.err;
  EXPECT_NE(open.err.find("boundary edges"), std::string::npos) << open.err;
  const auto json = test::parseJson(open.out);
  EXPECT_GT(json.at("open_edges"), 0);
  EXPECT_GT(json.at("check").at("boundary_edges"), 0);
  EXPECT_EQ(run("mesh cut.vdb -o m.ply --check --cap").exitCode, 0);
}

/// Waits until the command hears signals, not for a time: a signal before that would be lost.
TEST_F(Command, StopsWhenAsked) {
  if (!std::filesystem::exists("/proc/self/status")) GTEST_SKIP() << "no /proc to look into";
  ASSERT_EQ(run("make sphere --voxel 0.004 -o s.vdb").exitCode, 0);
  // Once it is no longer the shell, whose handlers go, and has its own.
  const std::string interrupt =
      "& until [ \"$(grep -c -e '^Name:.tufa$' -e '^SigCgt:.*[2367abef]$' /proc/$!/status)\" = 2 "
      "]; "
      "do :; done; kill -INT $!; wait $!";
  for (const char* arguments : {"make gyroid --voxel 0.0015 -o g.vdb",
                                "mesh s.vdb -o m.ply --check", "mesh s.vdb -o m.stl --json"}) {
    const Outcome outcome = run(arguments, interrupt);
    EXPECT_EQ(outcome.exitCode, 130) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << arguments << "\n"
                                                                  << outcome.err;
    const bool json = std::string(arguments).ends_with("--json");
    EXPECT_EQ(outcome.out.find("\"interrupted\"") != std::string::npos, json) << outcome.out;
    EXPECT_EQ(folder.fileCount(), 1) << arguments;
  }
}

TEST_F(Command, SurvivesAReaderThatWentAway) {
  makeSphere();
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  constexpr int kFree = 9;  // the shell takes numbers of one digit
  ASSERT_EQ(::dup2(ends[1], kFree), kFree);
  ::close(ends[1]);
  for (const char* arguments : {"mesh s.vdb -o m.ply --json", "info s.vdb"}) {
    const Outcome outcome = run(arguments, ">&9");
    EXPECT_EQ(outcome.exitCode, 3) << arguments;
    EXPECT_NE(outcome.err.find("standard output: Broken pipe"), std::string::npos) << outcome.err;
  }
  ::close(kFree);
}

}  // namespace
}  // namespace tufa
