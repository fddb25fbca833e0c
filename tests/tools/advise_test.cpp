// `tufa advise`.

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa::test {
namespace {

class AdviseCommand : public CommandTest {};

TEST_F(AdviseCommand, SaysWhatVoxelSizeItWouldTake) {
  // Too coarse for its plates.
  ASSERT_EQ(run("make bracket --voxel 0.05 -o b.vdb --quiet").exitCode, 0);
  const Outcome text = run("advise b.vdb");
  EXPECT_EQ(text.exitCode, 1) << text.err;
  EXPECT_NE(text.out.find("it would take"), std::string::npos) << text.out;
  const Outcome object = run("advise b.vdb --json");
  EXPECT_EQ(object.exitCode, 1);
  const auto json = test::parseJson(object.out);
  EXPECT_EQ(json["enough"], false);
  EXPECT_LT(json["voxel_size_needed"], json["voxel_size"]);
  EXPECT_GT(json["thin_sharp_cells"], 0);
}

TEST_F(AdviseCommand, IsContentWithASphere) {
  makeSphere();
  const Outcome outcome = run("advise s.vdb");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("fine enough      yes"), std::string::npos) << outcome.out;
  EXPECT_EQ(run("advise s.vdb --smooth 30 --quiet").exitCode, 1);
}

TEST_F(AdviseCommand, Refuses) {
  makeSphere();
  expectFailure("advise none.vdb", 3, "none.vdb");
  expectFailure("advise s.vdb --smooth 0", 2, "voxels");
  expectFailure("advise s.vdb --spare 2", 2, "--spare");
  expectFailure("advise s.vdb --iso 100", 3, "no surface");
}

}  // namespace
}  // namespace tufa::test
