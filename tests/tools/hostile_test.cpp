// Files and folders made to harm whoever looks at them.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/io.h>
#include <tufa/shapes.h>
#include <chrono>
#include <nlohmann/json.hpp>

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
  const Json json = Json::parse(run("info m.vdb --json").out);
  EXPECT_EQ(json["grids"][0]["name"].get<std::string>().substr(0, 5), name.substr(0, 5));
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
  const Json json = Json::parse(info.out)["grids"][0];
  EXPECT_EQ(json["tiles"], 32768);
  EXPECT_EQ(json["active_voxels"], 32768ull << 36);
  EXPECT_EQ(json["max_value"], 1);
  expectFailure("mesh t.vdb -o m.ply --iso auto", 3, "--tile-faces");
  expectFailure("chunks t.vdb -o d --iso 0.5", 3, "--tile-faces");
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(elapsed.count(), 6);
}

}  // namespace
}  // namespace tufa
