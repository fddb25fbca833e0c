// `tufa fit`.

#include <tufa/fit.h>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa::test {
namespace {

class FitCommand : public CommandTest {
 protected:
  void SetUp() override {
    if (!canFitBlobs()) GTEST_SKIP() << "built without Ceres Solver";
    ASSERT_EQ(run("make torus --voxel 0.1 -o t.vdb --quiet").exitCode, 0);
    ASSERT_EQ(run("mesh t.vdb -o t.ply --quiet").exitCode, 0);
  }
};

TEST_F(FitCommand, WritesAScene) {
  const Outcome outcome = run("fit t.ply -o t.json --blobs 8 --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto json = test::parseJson(outcome.out);
  EXPECT_EQ(json["blobs"], 8);
  EXPECT_EQ(json["steps"].size(), 8u);
  EXPECT_LT(json["rms_distance"], 0.02 * json["diagonal"].get<double>());
  EXPECT_EQ(run("model t.json -o b.vdb --voxel 0.1 --quiet").exitCode, 0);
  EXPECT_EQ(run("mesh b.vdb -o b.ply --quiet --check").exitCode, 0);
  EXPECT_EQ(run("picture t.json -o b.png --size 64x64 --quiet").exitCode, 0);
}

TEST_F(FitCommand, Refuses) {
  expectFailure("fit none.ply -o t.json", 3, "none.ply");
  expectFailure("fit t.ply -o t.vdb", 2, ".json");
  expectFailure("fit t.ply -o t.json --blobs 0", 2, "blobs");
  expectFailure("fit t.ply -o t.json --weights 1,2", 2, "--weights");
  expectFailure("fit t.vdb -o t.json", 2, "t.vdb");
  EXPECT_FALSE(std::filesystem::exists(folder / "t.json"));
}

}  // namespace
}  // namespace tufa::test
