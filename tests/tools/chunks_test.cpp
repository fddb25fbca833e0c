// `tufa chunks` from outside: what is in the folder, and what its chunks make together.

#include <gtest/gtest.h>

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::Outcome;
using test::readBytes;

class ChunksCommand : public test::CommandTest {
 protected:
  void makeChunks(const std::string& arguments) {
    ASSERT_EQ(run("make sphere --voxel 0.05 -o v.vdb").exitCode, 0);
    const Outcome outcome = run("chunks v.vdb -o d --chunk 16 --levels 3 " + arguments);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  }

  [[nodiscard]] std::set<std::string> namesIn(const std::string& name) const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / name)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }
};

TEST_F(ChunksCommand, FillsAFolder) {
  makeChunks("--quiet");
  const ChunkIndex index = readChunkIndex((folder / "d").string());
  EXPECT_EQ(index.chunkSize, 16);
  EXPECT_EQ(index.tolerances.size(), 3u);
  EXPECT_GT(index.chunks.size(), 20u);
  std::set<std::string> expected{"chunks.json"};
  for (const ChunkEntry& chunk : index.chunks) {
    for (const ChunkLevelEntry& level : chunk.levels) {
      EXPECT_LE(level.maxErrorVoxels, index.tolerances[&level - chunk.levels.data()]);
      if (!level.file.empty()) expected.insert(level.file);
    }
  }
  EXPECT_EQ(namesIn("d"), expected);
}

TEST_F(ChunksCommand, TakesFoldersWithASlashBehind) {
  makeSphere();
  const Outcome made = run("chunks s.vdb -o new/ --chunk 16 --levels 2");
  EXPECT_EQ(made.exitCode, 0) << made.err;
  EXPECT_EQ(run("chunks --assemble new/ --lods all:0 -o a.ply").exitCode, 0);
  EXPECT_EQ(run("chunks --assemble new/chunks.json --lods all:0 -o b.ply").exitCode, 0);
  EXPECT_EQ(test::readBytes(folder / "a.ply"), test::readBytes(folder / "b.ply"));
}

TEST_F(ChunksCommand, GivesTheKeysOfItsReport) {
  ASSERT_EQ(run("make sphere --voxel 0.1 -o v.vdb").exitCode, 0);
  const Outcome outcome = run("chunks v.vdb -o d --chunk 16 --levels 2 --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = test::parseJson(outcome.out);
  for (const char* key :
       {"file", "grid", "output", "isovalue", "inside", "active_voxels", "voxel_size", "chunk_size",
        "chunks", "levels", "seconds", "peak_memory_bytes", "threads"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  ASSERT_EQ(json["levels"].size(), 2u);
  EXPECT_GT(json["levels"][0]["triangles"]["transition"], 0);
  EXPECT_EQ(json["levels"][1]["triangles"]["transition"], 0);
}

TEST_F(ChunksCommand, AssemblesClosedMeshesOfAnyLevels) {
  for (const char* format : {"glb", "ply", "glb --compress --up z --scale 0.01"}) {
    makeChunks(std::string("--quiet --format ") + format);
    for (const char* lods : {"all:0", "all:2", "random", "random:7", "random:8", "random:9",
                             "camera:5,-3,1", "camera:0.6,0.6,0.6"}) {
      const Outcome outcome =
          run(std::string("chunks --assemble d --lods ") + lods + " -o m.ply --check");
      EXPECT_EQ(outcome.exitCode, 0) << format << " " << lods << "\n" << outcome.out << outcome.err;
    }
  }
}

TEST_F(ChunksCommand, AssemblesIntoTheFolderAgain) {
  makeChunks("--quiet");
  for (int i = 0; i < 2; ++i) {
    const Outcome outcome = run("chunks --assemble d --lods all:1 -o d/seen.ply");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  }
  const ChunkIndex index = readChunkIndex((folder / "d").string());
  const std::string file = "d/" + index.chunks.at(0).levels.at(0).file;
  expectFailure("chunks --assemble d --lods all:1 -o " + file, 2, "would be overwritten");
}

TEST_F(ChunksCommand, AssemblesTheLevelsItSays) {
  makeChunks("--quiet");
  const auto lodsOf = [&](const std::string& lods) {
    const Outcome outcome = run("chunks --assemble d -o m.ply --json --lods " + lods);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return test::parseJson(outcome.out)["lods"].get<std::vector<std::size_t>>();
  };
  const ChunkIndex index = readChunkIndex((folder / "d").string());
  EXPECT_EQ(lodsOf("all:1"), std::vector<std::size_t>(index.chunks.size(), 1));
  EXPECT_EQ(lodsOf("random:5"), lodsOf("random:5"));
  EXPECT_NE(lodsOf("random:5"), lodsOf("random:6"));
  Camera camera;
  camera.eye = {3, 2, 1};
  EXPECT_EQ(lodsOf("camera:3,2,1 --pixel-error 2"), selectLods(index, camera, 2));
}

TEST_F(ChunksCommand, MakesChunksAloneAsTheyAreTogether) {
  makeChunks("--quiet");
  std::filesystem::rename(folder / "d", folder / "together");
  const ChunkIndex index = readChunkIndex((folder / "together").string());
  // Some at a time, the chunks.json of the runs before kept.
  for (std::size_t i = 0; i < index.chunks.size(); i += 9) {
    std::string only;
    for (std::size_t n = i; n < std::min(i + 9, index.chunks.size()); ++n) {
      const Coord& at = index.chunks[n].index;
      only +=
          " " + std::to_string(at[0]) + "," + std::to_string(at[1]) + "," + std::to_string(at[2]);
    }
    makeChunks("--quiet --only" + only);
  }
  ASSERT_EQ(namesIn("d"), namesIn("together"));
  for (const std::string& name : namesIn("d")) {
    EXPECT_EQ(readBytes(folder / "d" / name), readBytes(folder / "together" / name)) << name;
  }
  expectFailure("chunks v.vdb -o d --chunk 16 --levels 2 --only 0,0,0", 2,
                "of other options: they differ in the tolerances; make");
  makeChunks("--quiet");
  for (const std::string other : {"--iso 0.01", "--offset 1", "--min-angle 20"}) {
    expectFailure("chunks v.vdb -o d --chunk 16 --levels 3 --only 0,0,0 " + other, 2,
                  "differ in the surface");
  }
}

TEST_F(ChunksCommand, ASecondRunLeavesNoFileOfTheFirst) {
  makeChunks("--quiet");
  std::ofstream(folder / "d" / "notes.txt") << "of someone else";
  ASSERT_EQ(run("chunks v.vdb -o d --chunk 32 --levels 1 --quiet").exitCode, 0);
  std::set<std::string> expected{"chunks.json", "notes.txt"};
  for (const ChunkEntry& chunk : readChunkIndex((folder / "d").string()).chunks) {
    expected.insert(chunk.levels.at(0).file);
  }
  EXPECT_EQ(namesIn("d"), expected);
}

TEST_F(ChunksCommand, CancelledRunsLeaveTheFirstResult) {
  makeChunks("--quiet");
  const auto contents = [&] {
    std::map<std::string, std::string> files;
    for (const std::string& name : namesIn("d")) files[name] = readBytes(folder / "d" / name);
    return files;
  };
  const auto first = contents();
  const std::string second = "chunks v.vdb -o d --chunk 16 --levels 3 --tolerance 0.3 --quiet";
  ASSERT_EQ(run(second).exitCode, 0);
  const auto replaced = contents();
  makeChunks("--quiet");
  int cancelled = 0;
  for (int milliseconds = 5; milliseconds <= 400; milliseconds += milliseconds / 4 + 5) {
    // Otherwise it signals its group as well, and a second interrupt ends the command at once.
    const std::string before = "timeout --foreground --preserve-status -s INT " +
                               std::to_string(milliseconds * 1e-3) + " ";
    const int exitCode = run(second, "", before).exitCode;
    if (exitCode == 0) {
      EXPECT_EQ(contents(), replaced);
      makeChunks("--quiet");
      continue;
    }
    ++cancelled;
    // The interrupt may come after the folders were swapped, too.
    const auto now = contents();
    ASSERT_TRUE(now == first || now == replaced) << milliseconds;
    if (now == replaced) makeChunks("--quiet");
    std::filesystem::remove_all(folder / "new");
    const std::string fresh = "chunks v.vdb -o new --chunk 16 --levels 3 --quiet";
    if (run(fresh, "", before).exitCode != 0) {
      EXPECT_EQ(std::filesystem::exists(folder / "new"),
                std::filesystem::exists(folder / "new" / "chunks.json"));
    }
  }
  EXPECT_GT(cancelled, 0);
}

/// Whenever it comes, SIGKILL leaves one of the two results or a mixture that is told.
TEST_F(ChunksCommand, KilledRunsLeaveNoMixtureUntold) {
  makeChunks("--quiet");
  const std::string second = "chunks v.vdb -o d --chunk 16 --levels 3 --tolerance 0.3 --quiet";
  std::mt19937 random(1);
  for (int n = 0; n < 40; ++n) {
    const double seconds = 1e-3 * static_cast<double>(random() % 300);
    run(second + (n % 2 == 0 ? "" : " --format ply"), "",
        "timeout -s KILL " + std::to_string(seconds) + " ");
    const Outcome outcome = run("chunks --assemble d --lods all:0 -o m.ply --check --quiet");
    EXPECT_TRUE(
        outcome.exitCode == 0 ||
        (outcome.exitCode == 3 && (outcome.err.find("another checksum") != std::string::npos ||
                                   outcome.err.find("No such file") != std::string::npos)))
        << outcome.exitCode << " " << outcome.err;
    if (outcome.exitCode != 0) makeChunks("--quiet");
  }
}

TEST_F(ChunksCommand, RefusesWhatItCannotDo) {
  makeSphere();
  expectFailure("chunks -o d", 2, "FILE or --assemble DIR is needed");
  expectFailure("chunks s.vdb -o d --chunk 24", 2, "24");
  expectFailure("chunks s.vdb -o d --factor 1", 2, "1");
  expectFailure("chunks s.vdb -o d --levels 17", 2, "--levels");
  expectFailure("chunks s.vdb -o d --only 1,2", 2, "\"1,2\"");
  expectFailure("chunks s.vdb -o d --format obj", 2, "--format");
  expectFailure("chunks s.vdb -o d --lods all:0", 2, "only for --assemble");
  expectFailure("chunks s.vdb -o d --normals faces", 2, "--normals");
  expectFailure("chunks --assemble d --lods all:0 --pixel-error 2 -o m.ply", 2,
                "camera:X,Y,Z only");
  expectFailure("chunks s.vdb -o missing/d", 3, "no folder");
  expectFailure("chunks missing.vdb -o d", 3, "missing.vdb");
  expectFailure("chunks s.vdb --assemble d --lods all:0 -o m.ply", 2, "takes no volume");
  expectFailure("chunks --assemble d -o m.ply", 2, "needs --lods");
  expectFailure("chunks --assemble d --lods all:0 -o m.ply", 3, "chunks.json");
  expectFailure("chunks --assemble d --lods all:0 -o m.xyz", 2, "ending");
  ASSERT_EQ(run("chunks s.vdb -o d --chunk 16 --levels 2").exitCode, 0);
  expectFailure("chunks --assemble d -o m.ply --lods all:2", 2, "no level 2");
  for (const std::string lods : {"all:-1", "all:1x", "all", "some", "random:x", "camera:1,2"}) {
    expectFailure("chunks --assemble d -o m.ply --lods " + lods, 2, "--lods is");
  }
}

}  // namespace
}  // namespace tufa
