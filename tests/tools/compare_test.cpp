// `tufa compare`.

#include <fstream>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa::test {
namespace {

class CompareCommand : public CommandTest {};

TEST_F(CompareCommand, WritesReportsOfAllKindsWithTheSameFigures) {
  makeSphere();
  const Outcome outcome =
      run("compare s.vdb --methods mc,volume-to-mesh-0 --truth sphere -o r.html -o r.json -o r.md "
          "--json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto json = test::parseJson(outcome.out);
  EXPECT_EQ(readBytes(folder / "r.json"), outcome.out);
  EXPECT_EQ(json["file"], "s.vdb");
  EXPECT_EQ(json["trilinear_euler_characteristic"], 2);
  EXPECT_EQ(json["differs_at"]["point"].size(), 3u);
  ASSERT_EQ(json["methods"].size(), 2u);
  const auto& cubes = json["methods"][0];
  EXPECT_EQ(cubes["method"], "mc");
  EXPECT_EQ(cubes["check"]["watertight"], true);
  EXPECT_GT(cubes["distance"]["surface_to_mesh"]["largest"], 0);
  EXPECT_GT(cubes["truth"]["mesh_to_truth"]["rms"], 0);
  EXPECT_FALSE(cubes["truth"].contains("creases_to_mesh"));

  const std::string triangles = std::to_string(cubes["check"]["triangles"].get<int>());
  const std::string shown =
      triangles.substr(0, triangles.size() - 3) + "," + triangles.substr(triangles.size() - 3);
  const std::string page = readBytes(folder / "r.html");
  EXPECT_NE(page.find("<td>" + shown + "</td>"), std::string::npos);
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("data:image/png", at)) != std::string::npos; ++at) {
    ++pictures;
  }
  EXPECT_EQ(pictures, 4u);
  EXPECT_EQ(page.find("http"), std::string::npos);  // needs no other file
  const std::string text = readBytes(folder / "r.md");
  EXPECT_NE(text.find("| mc | "), std::string::npos);
  EXPECT_NE(text.find("| " + shown + " |"), std::string::npos);
}

TEST_F(CompareCommand, PrintsATable) {
  makeSphere();
  const Outcome outcome = run("compare s.vdb --methods mc,mc-original");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("mc-original"), std::string::npos);
  EXPECT_NE(outcome.out.find("Euler (2)"), std::string::npos);
}

TEST_F(CompareCommand, RefusesBeforeAnyWork) {
  makeSphere();
  expectFailure("compare s.vdb -o r.txt", 2, ".html, .json or .md");
  expectFailure("compare s.vdb -o s.vdb", 2, "ends in none");
  expectFailure("compare s.vdb -o r.md -o r.md", 2, "r.md");
  expectFailure("compare s.vdb --methods mc,cubes", 2, "cubes");
  expectFailure("compare s.vdb --truth noise", 2, "--truth");
  expectFailure("compare s.vdb --ambiguity original", 2, "--ambiguity");
  expectFailure("compare s.vdb -o none/r.md", 3, "folder");
  expectFailure("compare s.vdb --iso 100 --quiet -o r.md", 3, "no surface");
}

}  // namespace
}  // namespace tufa::test
