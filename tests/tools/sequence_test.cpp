// Sequences of volumes: `tufa mesh 'smoke.####.vdb'`.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/io.h>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <sstream>
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

class Sequence : public CommandTest {
 protected:
  /// Frames 1 to 4 of a sphere, of which 3 is missing.
  void SetUp() override {
    makeSphere();
    for (const char* frame : {"f.0001.vdb", "f.0002.vdb", "f.0004.vdb"}) {
      std::filesystem::copy_file(folder / "s.vdb", folder / frame);
    }
  }

  /// The frames of a report.
  static std::vector<std::string> statesOf(const Json& json) {
    std::vector<std::string> states;
    for (const Json& frame : json.at("frames")) states.push_back(frame.at("state"));
    return states;
  }

  bool exists(const char* file) { return std::filesystem::exists(folder / file); }
};

using States = std::vector<std::string>;

TEST_F(Sequence, MeshesEveryFrameAndTellsOfEach) {
  ASSERT_EQ(run("mesh s.vdb -o one.ply --quiet").exitCode, 0);
  const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-4 --jobs 2");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  for (const char* mesh : {"m.0001.ply", "m.0002.ply", "m.0004.ply"}) {
    EXPECT_EQ(readBytes(folder / mesh), readBytes(folder / "one.ply"));
  }
  EXPECT_FALSE(exists("m.0003.ply"));
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 5) << outcome.out;
  EXPECT_EQ(outcome.out.rfind("[1/4] f.0001.vdb: 458 triangles, within ", 0), 0u) << outcome.out;
  EXPECT_NE(outcome.out.find("\n[3/4] f.0003.vdb: missing\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\n4 frames: 3 done, 1 missing, in "), std::string::npos)
      << outcome.out;
}

TEST_F(Sequence, FramesAreRangesStepsAndLists) {
  const auto numbers = [&](const std::string& frames) {
    const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --json" +
                                (frames.empty() ? "" : " --frames " + frames));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    std::vector<int> found;
    const Json json = test::parseJson(outcome.out);
    for (const Json& frame : json.at("frames")) found.push_back(frame.at("frame"));
    return found;
  };
  EXPECT_EQ(numbers(""), (std::vector{1, 2, 4}));
  EXPECT_EQ(numbers("1-4x3"), (std::vector{1, 4}));
  EXPECT_EQ(numbers("4,1-2,2"), (std::vector{1, 2, 4}));
  EXPECT_EQ(numbers("0002"), (std::vector{2}));
  // Digits beyond those asked for.
  std::filesystem::rename(folder / "f.0004.vdb", folder / "f.12345.vdb");
  writeBytes(folder / "f.002.vdb", "not a frame");
  EXPECT_EQ(numbers(""), (std::vector{1, 2, 12345}));
}

TEST_F(Sequence, FramesMayBeNegative) {
  std::filesystem::rename(folder / "f.0004.vdb", folder / "f.-002.vdb");
  std::filesystem::copy_file(folder / "f.0001.vdb", folder / "f.-010.vdb");
  writeBytes(folder / "f.-0003.vdb", "of another width");
  const auto numbers = [&](const std::string& frames) {
    const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --json" + frames);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("#####"), std::string::npos) << outcome.err;
    std::vector<int> found;
    const Json json = test::parseJson(outcome.out);
    for (const Json& frame : json.at("frames")) found.push_back(frame.at("frame"));
    return found;
  };
  EXPECT_EQ(numbers(""), (std::vector{-10, -2, 1, 2}));
  EXPECT_TRUE(std::filesystem::exists(folder / "m.-010.ply"));
  EXPECT_EQ(numbers(" --frames -10--2x8"), (std::vector{-10, -2}));
  EXPECT_EQ(numbers(" --frames=-2"), (std::vector{-2}));
  EXPECT_EQ(numbers(" --frames 2,-2"), (std::vector{-2, 2}));
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --frames -1--4", 2, "--frames");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-4x-1", 2, "--frames");
}

TEST_F(Sequence, OneFrameThatFailsDoesNotStopTheOthers) {
  const std::string bytes = readBytes(folder / "s.vdb");
  writeBytes(folder / "f.0002.vdb", bytes.substr(0, bytes.size() / 2));
  const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --jobs 3 --report all.csv --json");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.err.find("f.0002.vdb"), std::string::npos) << outcome.err;
  const Json json = test::parseJson(outcome.out);
  EXPECT_EQ(statesOf(json), (States{"done", "failed", "done"}));
  EXPECT_EQ(json["frames"][1]["error"]["code"], "unreadable_file");
  EXPECT_EQ(json["failed"], 1);
  EXPECT_EQ(json["done"], 2);
  EXPECT_TRUE(exists("m.0004.ply"));
  EXPECT_FALSE(exists("m.0002.ply"));
  const std::string csv = readBytes(folder / "all.csv");
  EXPECT_EQ(csv.rfind("frame,state,file,output,triangles,", 0), 0u);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4) << csv;
  EXPECT_NE(csv.find("\n2,failed,f.0002.vdb,m.0002.ply,,,,,,"), std::string::npos) << csv;
}

TEST_F(Sequence, OneFrameWhoseGridNeedsAnOptionDoesNotStopTheOthers) {
  ASSERT_EQ(run("make fog --voxel 0.1 -o f.0002.vdb --quiet").exitCode, 0);
  const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --report all.csv --json");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.err.find("f.0002.vdb"), std::string::npos) << outcome.err;
  const Json json = test::parseJson(outcome.out);
  EXPECT_EQ(statesOf(json), (States{"done", "failed", "done"}));
  EXPECT_EQ(json["frames"][1]["error"]["code"], "invalid_argument");
  EXPECT_TRUE(exists("all.csv"));
}

TEST_F(Sequence, WhatIsWrongWithTheFirstFrameIsReported) {
  ASSERT_EQ(run("make fog --voxel 0.1 -o f.0001.vdb --quiet").exitCode, 0);
  const Outcome outcome =
      run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 0-4 --report all.csv --quiet");
  EXPECT_EQ(outcome.exitCode, 2);
  EXPECT_NE(outcome.err.find("a fog volume needs --iso"), std::string::npos) << outcome.err;
  const std::string csv = readBytes(folder / "all.csv");
  EXPECT_NE(csv.find("\n0,missing,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\n1,failed,f.0001.vdb,"), std::string::npos) << csv;
  EXPECT_EQ(csv.find("\n2,"), std::string::npos) << csv;
}

// Each took a process, and a kilobyte of memory.
TEST_F(Sequence, AbsentFramesAreCheap) {
  const Outcome outcome =
      run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 0-199999", "", "ulimit -v 2000000; ");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("\n200,000 frames: 3 done, 199,997 missing, in "), std::string::npos);
  EXPECT_NE(outcome.out.find("\n[200000/200000] f.199999.vdb: missing\n"), std::string::npos);
}

TEST_F(Sequence, EmptyFramesAreWrittenEmpty) {
  const Outcome outcome =
      run("mesh 'f.####.vdb' -o 'm.####.ply' --iso 2.5 --report all.json --inside below");
  EXPECT_EQ(outcome.exitCode, 1);  // as all are
  EXPECT_NE(outcome.err.find("no frame has a surface"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("no surface, an empty mesh: m.0001.ply"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(readMesh(folder / "m.0001.ply").triangleCount(), 0u);
  const Json json = test::parseJson(readBytes(folder / "all.json"));
  EXPECT_EQ(statesOf(json), (States{"empty", "empty", "empty"}));
}

// As where smoke has not begun, and its file holds no temperature.
TEST_F(Sequence, EmptyFramesNeedNoAttributes) {
  const auto empty = openvdb::createLevelSet<openvdb::FloatGrid>();
  empty->setName("nothing");
  writeGrids({empty}, folder / "f.0002.vdb");
  const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --attribute sphere");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("no surface, an empty mesh: m.0002.ply"), std::string::npos)
      << outcome.out;
  EXPECT_NE(readBytes(folder / "m.0001.ply").find("property float sphere"), std::string::npos);
}

TEST_F(Sequence, TellsTheFilesOfSeveralGrids) {
  const auto first = readGrid(folder / "s.vdb");
  const auto second = first->deepCopyGrid();
  second->setName("second");
  writeGrids({first, second}, folder / "f.0001.vdb");
  const Outcome outcome = run("mesh 'f.####.vdb' -o 'm_{}.####.ply' --frames 1 --grid '*'");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find(": m_sphere.0001.ply, m_second.0001.ply\n"), std::string::npos)
      << outcome.out;
  ASSERT_EQ(
      run("mesh 'f.####.vdb' -o 'm_{}.####.ply' --frames 1,2 --grid '*' --report r.csv").exitCode,
      0);
  const std::string table = readBytes(folder / "r.csv");
  EXPECT_NE(table.find(",\"m_sphere.0001.ply, m_second.0001.ply\","), std::string::npos) << table;
  const Outcome one = run("mesh 'f.####.vdb' -o 'm_{}.####.ply' --frames 2 --json");
  EXPECT_EQ(Json::parse(one.out)["frames"][0]["output"], "m_sphere.0002.ply");
}

TEST_F(Sequence, GridsThatAFrameDoesNotHaveAreEmptyThere) {
  const auto first = readGrid(folder / "s.vdb");
  const auto second = first->deepCopyGrid();
  second->setName("second");
  writeGrids({first, second}, folder / "f.0001.vdb");
  const std::string words = "mesh 'f.####.vdb' --frames 1,2 ";
  const Outcome all = run(words + "-o all.usda --grid second --grid sphere");
  EXPECT_EQ(all.exitCode, 0) << all.err;
  EXPECT_EQ(all.err, "");
  EXPECT_NE(readBytes(folder / "all.usda").find("2: [],"), std::string::npos);
  EXPECT_NE(run(words + "-o all.usda --grid sceond --grid sphere").err.find("\"sceond\""),
            std::string::npos);
  EXPECT_EQ(run(words + "-o all.usda --grid sceond").exitCode, 1);
}

TEST_F(Sequence, NamesTheGridThatItTookOnce) {
  const auto first = readGrid(folder / "s.vdb");
  const auto second = first->deepCopyGrid();
  second->setName("second");
  for (const char* frame : {"f.0001.vdb", "f.0002.vdb"}) {
    writeGrids({first, second}, folder / frame);
  }
  const std::string err = run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1,2").err;
  EXPECT_EQ(err,
            "tufa: note: grid \"sphere\" was taken, one of 2 that can be meshed; --grid chooses\n");
}

TEST_F(Sequence, IsovaluesThatDifferFromFrameToFrameAreTold) {
  for (const int frame : {1, 2}) {
    auto grid = openvdb::FloatGrid::create(0);  // of no class
    grid->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(4)), static_cast<float>(frame));
    writeGrids({grid}, folder / ("t." + std::to_string(frame) + ".vdb"));
  }
  const Outcome two = run("mesh t.#.vdb -o t.#.ply --quiet");
  EXPECT_EQ(two.exitCode, 0) << two.err;
  EXPECT_NE(two.err.find("grid \"\" differs from frame to frame, from 0.5 to 1"), std::string::npos)
      << two.err;
  EXPECT_EQ(run("mesh t.#.vdb -o t.#.ply --quiet --iso 0.25").err, "");
}

TEST_F(Sequence, ResumeLeavesOutWhatIsNewer) {
  ASSERT_EQ(run("mesh 'f.####.vdb' -o 'm.####.ply' --quiet").exitCode, 0);
  const auto now = std::filesystem::last_write_time(folder / "m.0002.ply");
  std::filesystem::last_write_time(folder / "f.0001.vdb", now - std::chrono::hours(1));
  std::filesystem::last_write_time(folder / "f.0002.vdb", now + std::chrono::hours(1));
  std::filesystem::last_write_time(folder / "f.0004.vdb", now - std::chrono::hours(1));
  const Json json =
      test::parseJson(run("mesh 'f.####.vdb' -o 'm.####.ply' --resume --json --frames 1-4").out);
  EXPECT_EQ(statesOf(json), (States{"skipped", "done", "missing", "skipped"}));
}

TEST_F(Sequence, CheckedFramesThatAreNotWatertightFail) {
  // A clipped level set is open.
  const Outcome outcome =
      run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-2 --check --clip -2,-2,-2,2,2,0");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.err.find("m.0001.ply is not watertight"), std::string::npos) << outcome.err;
  EXPECT_TRUE(exists("m.0002.ply"));
  EXPECT_NE(outcome.out.find("f.0001.vdb: failed: "), std::string::npos) << outcome.out;
}

TEST_F(Sequence, ResumeChecksWhatIsThere) {
  const std::string command = "mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-2 --check";
  ASSERT_EQ(run(command).exitCode, 0);
  const auto now = std::filesystem::last_write_time(folder / "m.0002.ply");
  for (const char* input : {"f.0001.vdb", "f.0002.vdb"}) {
    std::filesystem::last_write_time(folder / input, now - std::chrono::hours(1));
  }
  const Outcome sound = run(command + " --resume");
  EXPECT_EQ(sound.exitCode, 0) << sound.err;
  EXPECT_NE(sound.out.find("skipped, its mesh is newer and watertight: m.0002.ply"),
            std::string::npos)
      << sound.out;
  // A mesh that an earlier run has written and not found watertight.
  ASSERT_EQ(run("mesh f.0002.vdb -o m.0002.ply --clip -2,-2,-2,2,2,0").exitCode, 0);
  const Outcome open = run(command + " --resume --report all.json");
  EXPECT_EQ(open.exitCode, 1);
  EXPECT_NE(open.err.find("m.0002.ply is not watertight"), std::string::npos) << open.err;
  EXPECT_EQ(statesOf(test::parseJson(readBytes(folder / "all.json"))),
            (States{"skipped", "failed"}));
  EXPECT_EQ(run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-2 --resume").exitCode, 0);
}

TEST_F(Sequence, WhatIsWrongWithAllFramesIsToldOnce) {
  expectFailure("mesh 'f.####.vdb' -o m.ply", 2, "all frames would be written to m.ply");
  expectFailure("mesh s.vdb -o m.ply --frames 1-2", 2, "####");
  expectFailure("mesh s.vdb -o m.ply --jobs 2", 2, "--jobs");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --frames 4-1", 2, "--frames");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-4x0", 2, "--frames");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --frames 7-9", 3, "no file of the sequence");
  expectFailure("mesh 'g.####.vdb' -o 'm.####.ply'", 3, "no file of the sequence");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.txt'", 2, "ending");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --report all.txt", 2, ".csv");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.ply' --tolerance x", 2, "--tolerance");
  expectFailure("mesh 'f.####.vdb' -o 'f.####.vdb'", 2, "overwritten");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.####.ply'", 2, "# in several places");
}

/// The attributes of the first mesh of a .usda of one frame, as they are declared, and their
/// values.
std::map<std::string, std::string> attributesOf(const std::string& usda) {
  std::map<std::string, std::string> values;
  std::istringstream lines(usda.substr(usda.find("def Mesh")));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find(" = ");
    if (equals == std::string::npos || line.find("uniform") != std::string::npos) continue;
    std::string value = line.substr(equals + 3);
    value.resize(std::min(value.rfind(']') + 1, value.size()));
    values[line.substr(8, equals - 8)] = value;
  }
  return values;
}

/// What tests/usd says by other readers, and for what they do not look at.
TEST_F(Sequence, OneUsdaHasTheValuesOfEveryFrame) {
  ASSERT_EQ(run("make sphere --voxel 0.15 -o f.0002.vdb --quiet").exitCode, 0);
  const Outcome outcome = run("mesh 'f.####.vdb' -o all.usda --frames 1-4 --jobs 2 --fps 24");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("[2/4] f.0002.vdb: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(": all.usda\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\nwrote all.usda, "), std::string::npos) << outcome.out;
  EXPECT_EQ(folder.fileCount(), 5);
  const std::string all = readBytes(folder / "all.usda");
  for (const char* line : {"startTimeCode = 1", "endTimeCode = 4", "timeCodesPerSecond = 24"}) {
    EXPECT_NE(all.find(std::string("\n    ") + line + "\n"), std::string::npos) << line;
  }
  for (const int frame : {1, 2, 4}) {
    const std::string number = std::to_string(frame);
    ASSERT_EQ(run("mesh f.000" + number + ".vdb -o one.usda --quiet").exitCode, 0);
    const auto attributes = attributesOf(readBytes(folder / "one.usda"));
    EXPECT_EQ(attributes.size(), 5u);
    for (const auto& [declaration, value] : attributes) {
      const std::size_t begin = all.find(declaration + ".timeSamples = {\n");
      ASSERT_NE(begin, std::string::npos) << declaration;
      const std::string samples = all.substr(begin, all.find("        }\n", begin) - begin);
      EXPECT_EQ(std::count(samples.begin(), samples.end(), '\n'), 4);
      EXPECT_NE(samples.find("\n            " + number + ": " + value + ",\n"), std::string::npos)
          << declaration << " of frame " << frame;
    }
  }
}

// It was written with six digits.
TEST_F(Sequence, OneUsdaHasTheExactRate) {
  ASSERT_EQ(run("mesh 'f.####.vdb' -o all.usda --fps 23.976023976 --quiet").exitCode, 0);
  EXPECT_NE(readBytes(folder / "all.usda").find("timeCodesPerSecond = 23.976023976\n"),
            std::string::npos);
}

TEST_F(Sequence, ReportsAUsdaThatCannotBeJoined) {
  // Room for each frame's file, but not for that of all, in blocks of 512 bytes.
  ASSERT_EQ(run("mesh f.0001.vdb -o one.usda --quiet").exitCode, 0);
  const auto blocks = std::filesystem::file_size(folder / "one.usda") * 2 / 512;
  const Outcome outcome = run("mesh 'f.####.vdb' -o all.usda --report all.csv --quiet", "",
                              "ulimit -f " + std::to_string(blocks) + "; ");
  EXPECT_EQ(outcome.exitCode, 3);
  EXPECT_EQ(outcome.err.rfind("tufa: cannot write all.usda: ", 0), 0u) << outcome.err;
  EXPECT_NE(readBytes(folder / "all.csv").find("\n4,done,f.0004.vdb,all.usda,"), std::string::npos);
}

TEST_F(Sequence, OneUsdaHasFramesWithoutASurface) {
  const Outcome outcome =
      run("mesh 'f.####.vdb' -o all.usda --frames 1-2 --iso 2.5 --inside below");
  EXPECT_EQ(outcome.exitCode, 1);
  const std::string all = readBytes(folder / "all.usda");
  EXPECT_NE(all.find("point3f[] points.timeSamples = {\n            1: [],\n            2: [],\n"),
            std::string::npos);
}

TEST_F(Sequence, OneUsdaIsWrittenWholeOrNotAtAll) {
  const std::string bytes = readBytes(folder / "s.vdb");
  writeBytes(folder / "f.0002.vdb", bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(run("mesh 'f.####.vdb' -o all.usda --frames 2").exitCode, 1);
  EXPECT_EQ(folder.fileCount(), 4);
  // Others are done.
  EXPECT_EQ(run("mesh 'f.####.vdb' -o all.usda --quiet").exitCode, 1);
  EXPECT_EQ(folder.fileCount(), 5);
  EXPECT_NE(readBytes(folder / "all.usda").find("            4: [("), std::string::npos);
  expectFailure("mesh 'f.####.vdb' -o all.usda --resume", 2, "--resume");
  expectFailure("mesh 'f.####.vdb' -o 'all_{}.usda'", 2, "{}");
  expectFailure("mesh 'f.####.vdb' -o 'm.####.usda' --fps 24", 2, "--fps");
  expectFailure("mesh s.vdb -o m.usda --fps 24", 2, "--fps");
  expectFailure("mesh 'f.####.vdb' -o none/all.usda", 3, "none/all.usda");
}

/// As Command.StopsWhenAsked: waits until the command hears signals.
TEST_F(Sequence, StopsAllFramesWhenAsked) {
  if (!std::filesystem::exists("/proc/self/status")) GTEST_SKIP() << "no /proc to look into";
  ASSERT_EQ(run("make sphere --voxel 0.004 -o f.0001.vdb --quiet").exitCode, 0);
  std::filesystem::copy_file(folder / "f.0001.vdb", folder / "f.0002.vdb",
                             std::filesystem::copy_options::overwrite_existing);
  const auto files = folder.fileCount();
  const Outcome outcome = run("mesh 'f.####.vdb' -o 'm.####.ply' --frames 1-2 --jobs 2",
                              "& until [ \"$(grep -c -e '^Name:.tufa$' -e '^SigCgt:.*[2367abef]$' "
                              "/proc/$!/status)\" = 2 ]; do :; done; kill -INT $!; wait $!");
  EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.fileCount(), files);
}

}  // namespace
}  // namespace tufa
