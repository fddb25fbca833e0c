// Files and folders made to harm whoever looks at them.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/io.h>
#include <tufa/shapes.h>
#include <chrono>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::readBytes;
using test::writeBytes;
using Json = nlohmann::json;

class Hostile : public CommandTest {
 protected:
  void writeNamed(const std::string& file, const std::vector<std::string>& names) {
    ShapeOptions options;
    options.voxelSize = 0.2;
    std::vector<openvdb::GridBase::ConstPtr> grids;
    for (const std::string& name : names) {
      const auto grid = makeShape(Shape::Sphere, options);
      grid->setName(name);
      grids.push_back(grid);
    }
    writeGrids(grids, folder / file);
  }
};

/// A terminal obeys an escape sequence in what it shows, and a new line pretends to be another
/// message.
TEST_F(Hostile, NamesOfGridsAreShownEscaped) {
  const std::string name =
      "a\x1b]0;title\x07\x1b[2J\ntufa: all is well\xc2\x9b"
      "b";
  const std::string shown = R"(a\x1b]0;title\x07\x1b[2J\x0atufa: all is well\xc2\x9bb)";
  writeNamed("m.vdb", {name});
  writeNamed("two.vdb", {name, name + "2"});
  const auto expectEscaped = [&](const std::string& arguments, int exitCode) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, exitCode) << outcome.err;
    for (const std::string& text : {outcome.out, outcome.err}) {
      for (const char c : {'\x1b', '\x07', '\x9b'}) EXPECT_EQ(text.find(c), text.npos) << arguments;
      EXPECT_EQ(text.find("\ntufa: all"), text.npos) << arguments;
    }
    EXPECT_NE((outcome.out + outcome.err).find(shown), std::string::npos)
        << arguments << "\n"
        << outcome.out << outcome.err;
  };
  expectEscaped("info m.vdb", 0);
  expectEscaped("info two.vdb", 0);
  expectEscaped("mesh m.vdb -o m.ply", 0);
  expectEscaped("mesh two.vdb -o m.ply", 0);
  expectEscaped("mesh two.vdb -o two.glb --grid '*'", 0);
  expectEscaped("mesh two.vdb -o m.ply --grid none", 3);
  expectEscaped("lod m.vdb -o m.glb --levels 2", 0);
  expectEscaped("chunks m.vdb -o d", 0);
  expectEscaped("chunks m.vdb -o d2 --grid none", 3);
  const Json json = test::parseJson(run("info m.vdb --json").out);
  EXPECT_EQ(json["grids"][0]["name"].get<std::string>().substr(0, 5), name.substr(0, 5));
}

// One was written over the other.
TEST_F(Hostile, NamesOfGridsThatMakeOneFileAreRefused) {
  writeNamed("two.vdb", {"a/b", "a_b"});
  expectFailure("mesh two.vdb -o 'x{}.ply' --grid '*'", 2,
                R"(the grids "a/b" and "a_b" would both be written to xa_b.ply)");
  EXPECT_EQ(run("mesh two.vdb -o 'x{}.ply' --grid a/b --quiet").exitCode, 0);
  EXPECT_EQ(run("mesh two.vdb -o two.glb --grid '*' --quiet").exitCode, 0);
  writeNamed("odd.vdb", {"-rf", "a\x1b[2J\n\xc2\x9b", "\xc3\xa9"});
  ASSERT_EQ(run("mesh odd.vdb -o '{}.ply' --grid '*' --quiet").exitCode, 0);
  for (const char* file : {"_rf.ply", "a_[2J___.ply", "\xc3\xa9.ply"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  }
}

TEST_F(Hostile, NamesOfFilesAreShownEscaped) {
  writeNamed("s.vdb", {"s"});
  const std::string hostile = "a\x1b[2J";
  std::filesystem::copy_file(folder / "s.vdb", folder / (hostile + ".1.vdb"));
  const auto expectEscaped = [&](const std::string& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos) << arguments;
    EXPECT_NE(outcome.out.find(R"(a\x1b[2J)"), std::string::npos) << outcome.out;
  };
  const std::string name = "'" + hostile + ".1.vdb'", mesh = "'" + hostile + ".ply'";
  expectEscaped("info " + name);
  expectEscaped("mesh s.vdb -o " + mesh);
  expectEscaped("check " + mesh);
  expectEscaped("compare " + name + " --methods dual");
  expectEscaped("lod s.vdb -o '" + hostile + "{}.glb' --levels 2");
  expectEscaped("chunks s.vdb -o '" + hostile + "' --levels 1");
  expectEscaped("mesh '" + hostile + ".#.vdb' -o '" + hostile + ".#.ply'");
}

/// 557 KB that took over 12 seconds.
TEST_F(Hostile, ManyTilesAtTheRootTakeNoTime) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  for (int n = 0; n < 32768; ++n) {
    const openvdb::Coord place(4096 * (n % 32), 4096 * (n / 32 % 32), 4096 * (n / 1024));
    grid->tree().addTile(3, place, 1, true);
  }
  writeGrids({grid}, folder / "t.vdb");
  const auto begin = std::chrono::steady_clock::now();
  const Outcome info = run("info t.vdb --json");
  ASSERT_EQ(info.exitCode, 0) << info.err;
  const Json json = test::parseJson(info.out)["grids"][0];
  EXPECT_EQ(json["tiles"], 32768);
  EXPECT_EQ(json["active_voxels"], 32768ull << 36);
  EXPECT_EQ(json["max_value"], 1);
  expectFailure("mesh t.vdb -o m.ply --iso auto", 3, "--tile-faces");
  expectFailure("chunks t.vdb -o d --iso 0.5", 3, "--tile-faces");
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(elapsed.count(), 6);
}

TEST_F(Hostile, FilesLargerThanMemoryNameThemselves) {
  for (const char* name : {"s.ply", "s.glb", "s.stl", "s.obj", "s.vdb"}) {
    writeBytes(folder / name, "ply\n");
    std::filesystem::resize_file(folder / name, std::uintmax_t{100} << 30);
    const std::string file = name;
    expectFailure((file == "s.vdb" ? "info " : "check ") + file, 3, "cannot read " + file);
    std::filesystem::remove(folder / name);
  }
  std::filesystem::create_directory(folder / "d");
  writeBytes(folder / "d/chunks.json", "{");
  std::filesystem::resize_file(folder / "d/chunks.json", std::uintmax_t{100} << 30);
  expectFailure("chunks --assemble d --lods all:0 -o m.ply", 3, "cannot read d/chunks.json");
}

TEST_F(Hostile, FoldersWithoutChunksAreOneError) {
  makeSphere();
  ASSERT_EQ(run("chunks s.vdb -o d --quiet --levels 2").exitCode, 0);
  Json index = test::parseJson(readBytes(folder / "d/chunks.json"));
  index["chunks"] = Json::array();
  writeBytes(folder / "d/chunks.json", index.dump());
  for (const char* lods : {"all:0", "all:1", "random", "random:7", "camera:1,2,3"}) {
    expectFailure(std::string("chunks --assemble d -o m.ply --lods ") + lods, 3,
                  "d holds no chunks to assemble");
  }
  index["tolerances_voxels"] = Json::array();
  writeBytes(folder / "d/chunks.json", index.dump());
  expectFailure("chunks --assemble d -o m.ply --lods random", 3, "it has no levels");
}

TEST_F(Hostile, LinksOutOfAFolderOfChunksAreRefused) {
  makeSphere();
  ASSERT_EQ(run("chunks s.vdb -o d --quiet --levels 2").exitCode, 0);
  const Json index = test::parseJson(readBytes(folder / "d/chunks.json"));
  const std::string file = index["chunks"][0]["levels"][0]["file"];
  const std::filesystem::path chunk = folder / "d" / file;
  std::filesystem::rename(chunk, folder / "outside.glb");
  std::filesystem::create_symlink("../outside.glb", chunk);
  expectFailure("chunks --assemble d --lods all:0 -o m.ply", 3, "link out of the folder");
  // A link within, and a folder that is itself reached by one.
  std::filesystem::remove(chunk);
  std::filesystem::rename(folder / "outside.glb", folder / "d/moved.glb");
  std::filesystem::create_symlink("moved.glb", chunk);
  std::filesystem::create_directory_symlink("d", folder / "e");
  EXPECT_EQ(run("chunks --assemble e --lods all:0 -o m.ply").exitCode, 0);
}

TEST_F(Hostile, ReplacedFilesStayAsClosedAsTheyWere) {
  makeSphere();
  using std::filesystem::perms;
  for (const perms mode : {perms{0600}, perms{0640}, perms{0666}, perms{0755}}) {
    for (const char* name : {"m.ply", "s2.vdb"}) {
      writeBytes(folder / name, "");
      std::filesystem::permissions(folder / name, mode);
    }
    ASSERT_EQ(run("mesh s.vdb -o m.ply --quiet").exitCode, 0);
    ASSERT_EQ(run("make sphere --voxel 0.2 -o s2.vdb --quiet").exitCode, 0);
    for (const char* name : {"m.ply", "s2.vdb"}) {
      EXPECT_GT(std::filesystem::file_size(folder / name), 0U);
      EXPECT_EQ(std::filesystem::status(folder / name).permissions(), mode) << name;
    }
  }
}

TEST_F(Hostile, ReplacedChunksStayAsClosedAsTheyWere) {
  makeSphere();
  ASSERT_EQ(run("chunks s.vdb -o d --quiet --levels 2").exitCode, 0);
  const auto closed = std::filesystem::perms{0600};
  std::filesystem::permissions(folder / "d", std::filesystem::perms{0700});
  for (const auto& entry : std::filesystem::directory_iterator(folder / "d")) {
    std::filesystem::permissions(entry.path(), closed);
  }
  ASSERT_EQ(run("chunks s.vdb -o d --quiet --levels 2 --tolerance 0.3").exitCode, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "d")) {
    EXPECT_EQ(entry.status().permissions(), closed) << entry.path();
  }
  EXPECT_EQ(std::filesystem::status(folder / "d").permissions(), std::filesystem::perms{0700});
}

TEST_F(Hostile, LinksThatLeadNowhereAreNotReplaced) {
  makeSphere();
  std::filesystem::create_symlink("none.ply", folder / "link.ply");
  std::filesystem::create_symlink("none.vdb", folder / "link.vdb");
  expectFailure("mesh s.vdb -o link.ply", 3, "leads nowhere");
  expectFailure("make sphere -o link.vdb", 3, "leads nowhere");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.ply"));
  writeBytes(folder / "none.ply", "");
  EXPECT_EQ(run("mesh s.vdb -o link.ply --quiet").exitCode, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.ply"));
  EXPECT_GT(std::filesystem::file_size(folder / "none.ply"), 0U);
}

TEST_F(Hostile, HelpTellsOfAFullDevice) {
  for (const char* arguments : {"--help", "--version", "help", "mesh --help", "help mesh"}) {
    const Outcome full = run(arguments, ">/dev/full");
    EXPECT_EQ(full.exitCode, 1) << arguments;
    EXPECT_NE(full.err.find("cannot write standard output"), std::string::npos) << full.err;
  }
}

}  // namespace
}  // namespace tufa
