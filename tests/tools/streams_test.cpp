// The tufa command in a pipe: standard input and output in the place of files.

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <tufa/io.h>

#include "support/json.h"
#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Outcome;
using test::readBytes;
using test::writeBytes;
using Json = nlohmann::json;

class Pipes : public CommandTest {
 protected:
  /// `tufa ARGUMENTS < FILE`, by a pipe.
  Outcome runOn(const std::string& file, const std::string& arguments) {
    return run(arguments, "", "cat " + file + " | ");
  }
};

TEST_F(Pipes, MeshGivesTheBytesOfAFile) {
  makeSphere();
  for (const std::string format : {"ply", "obj", "stl", "off", "glb"}) {
    ASSERT_EQ(run("mesh s.vdb -o m." + format + " --quiet").exitCode, 0);
    const Outcome outcome = runOn("s.vdb", "mesh - -o - --format " + format);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, readBytes(folder / ("m." + format))) << format;
    EXPECT_NE(outcome.err.find("wrote standard output, in "), std::string::npos) << outcome.err;
  }
}

TEST_F(Pipes, SummariesGoToStandardErrorBesideData) {
  makeSphere();
  const Outcome outcome = run("mesh s.vdb -o - --format ply --json");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(test::parseJson(outcome.err).at("output"), "-");
  EXPECT_EQ(outcome.out.rfind("ply\n", 0), 0u);
  EXPECT_EQ(run("mesh s.vdb -o - --format ply --quiet").err, "");
  EXPECT_EQ(run("mesh s.vdb -o - --format ply --quiet --threads 64").err, "");
  // A failure leaves standard output empty.
  const Outcome failure = run("mesh s.vdb -o - --format ply --grid none --json");
  EXPECT_EQ(failure.exitCode, 3);
  EXPECT_EQ(failure.out, "");
  EXPECT_NE(failure.err.find("\"unknown_grid\""), std::string::npos) << failure.err;
}

TEST_F(Pipes, ChainOfAllSubcommands) {
  const Outcome outcome =
      run("make sphere --voxel 0.1 -o - --quiet | '" TUFA_COMMAND
          "' mesh - -o - --format off --quiet | '" TUFA_COMMAND
          "' voxelize - --format off --voxel 0.1 -o - --quiet | '" TUFA_COMMAND
          "' lod - -o - --format glb --levels 2 --quiet | '" TUFA_COMMAND "' check - --format glb");
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(outcome.out.rfind("standard input\n", 0), 0u) << outcome.out;
  EXPECT_EQ(folder.fileCount(), 0);
}

TEST_F(Pipes, LodGivesTheBytesOfAFile) {
  makeSphere();
  ASSERT_EQ(run("lod s.vdb -o mesh.glb --levels 2 --quiet").exitCode, 0);
  const Outcome outcome = run("lod s.vdb -o - --format glb --levels 2");
  EXPECT_EQ(outcome.exitCode, 0);
  EXPECT_EQ(outcome.out, readBytes(folder / "mesh.glb"));
  EXPECT_NE(outcome.err.find("wrote standard output"), std::string::npos) << outcome.err;
  expectFailure("lod s.vdb -o - --format ply", 2, "ply not in {glb,usda}");
  expectFailure("lod s.vdb -o - --format glb --separate", 2, "a file for each");
}

TEST_F(Pipes, ReadVolumesAsFilesAre) {
  makeSphere();
  const Outcome fromPipe = runOn("s.vdb", "info - --json");
  const Outcome fromFile = run("info s.vdb --json");
  EXPECT_EQ(test::parseJson(fromPipe.out).at("grids"), test::parseJson(fromFile.out).at("grids"));
  ASSERT_EQ(run("mesh s.vdb -o s.ply --quiet").exitCode, 0);
  EXPECT_EQ(runOn("s.vdb", "check s.ply --against - --quiet").exitCode, 0);
  EXPECT_EQ(runOn("s.vdb", "chunks - -o d --quiet --levels 1").exitCode, 0);
}

TEST_F(Pipes, SayWhatIsWrong) {
  makeSphere();
  expectFailure("mesh s.vdb -o -", 2, "--format");
  expectFailure("mesh s.vdb -o m.ply --format ply", 2, "m.ply");
  expectFailure("mesh s.vdb -o - --format vdb", 2, "--format");
  expectFailure("check -", 2, "--format");
  expectFailure("check none.ply --format ply", 2, "standard input");
  expectFailure("check - --format ply --against -", 2, "once only");
  expectFailure("info - < /dev/null", 3, "cannot read standard input: the file is empty");
  writeBytes(folder / "cut.vdb", readBytes(folder / "s.vdb").substr(0, 5000));
  expectFailure("mesh - -o m.ply < cut.vdb", 3, "cannot read standard input");
  expectFailure("check - --format ply < cut.vdb", 3, "cannot read standard input");
}

// OpenVDB built with log4cplus warns of a version that it does not know on standard output.
TEST_F(Pipes, OpenVdbSaysNothingOnThem) {
  makeSphere();
  std::string bytes = readBytes(folder / "s.vdb");
  ++bytes[8];
  writeBytes(folder / "new.vdb", bytes);
  for (const char* arguments : {"info new.vdb", "mesh new.vdb -o - --format ply --quiet"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_EQ(outcome.out, "") << arguments;
    EXPECT_NE(outcome.err.find("cannot read new.vdb: its format is version "), std::string::npos)
        << outcome.err;
  }
}

// A signal that came while a call waited was heard once that call was done, which may be never.
TEST_F(Pipes, StopWhileNobodyOpensOrReadsThem) {
  if (!std::filesystem::exists("/proc/self/status")) GTEST_SKIP() << "no /proc to look into";
  ASSERT_EQ(run("make sphere --voxel 0.05 -o s.vdb --quiet").exitCode, 0);
  ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
  // As Command.StopsWhenAsked, and once its one thread sleeps.
  const std::string interrupt =
      "& until [ \"$(grep -c -e '^Name:.tufa$' -e '^State:.S' -e '^SigCgt:.*[2367abef]$' "
      "/proc/$!/status)\" = 3 ]; do :; done; kill -INT $!; wait $!";
  const auto expectStop = [&](const std::string& output, const std::string& after,
                              const std::string& before) {
    const Outcome outcome =
        run("mesh s.vdb --uniform --quiet --threads 1 -o " + output, after + interrupt, before);
    EXPECT_EQ(outcome.exitCode, 130) << output;
    EXPECT_EQ(outcome.err, "tufa: interrupted\n") << output;
  };
  const std::string openWithoutReading = "exec 9<>pipe.ply; ";
  expectStop("pipe.ply", "", "");
  expectStop("pipe.ply", "", openWithoutReading);
  expectStop("- --format ply", ">&9 ", openWithoutReading);
}

TEST_F(Pipes, WithNamesTakeAFormat) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o m.off --quiet").exitCode, 0);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const Outcome outcome =
      run("mesh s.vdb -o pipe --format off --quiet", "; wait", "cat pipe > got.off & ");
  EXPECT_EQ(readBytes(folder / "got.off"), readBytes(folder / "m.off")) << outcome.err;
  expectFailure("mesh s.vdb -o m.ply --format ply", 2, "the ending of m.ply says its format");
  expectFailure("mesh s.vdb -o m --format ply", 2, "m is a file, whose name needs an ending");
  expectFailure("info pipe", 3, "give it as -, standard input");
  expectFailure("check pipe", 2, "give it as -, standard input");
  std::filesystem::rename(folder / "pipe", folder / "pipe.ply");
  expectFailure("check pipe.ply", 3, "give it as -, standard input");
}

TEST_F(Pipes, AFullOrClosedOutputIsAnError) {
  makeSphere();
  const Outcome full = run("mesh s.vdb -o - --format ply --quiet", ">/dev/full");
  EXPECT_EQ(full.exitCode, 3);
  EXPECT_EQ(full.err, "tufa: cannot write standard output: No space left on device\n");
  const Outcome closed = run("make sphere -o - --voxel 0.1 --quiet", ">&-");
  EXPECT_EQ(closed.exitCode, 3);
  EXPECT_NE(closed.err.find("cannot write standard output"), std::string::npos) << closed.err;
}

TEST_F(Pipes, InfoAndCheckTakeSeveralFiles) {
  makeSphere();
  ASSERT_EQ(run("mesh s.vdb -o a.ply --quiet").exitCode, 0);
  ASSERT_EQ(run("mesh s.vdb -o b.off --quiet").exitCode, 0);
  const Outcome info = run("info s.vdb s.vdb --json");
  EXPECT_EQ(info.exitCode, 0);
  ASSERT_EQ(test::parseJson(info.out).at("files").size(), 2u);
  EXPECT_EQ(test::parseJson(info.out)["files"][1]["grids"][0]["name"], "sphere");

  const Outcome check = run("check a.ply b.off --against s.vdb");
  EXPECT_EQ(check.exitCode, 0) << check.err;
  EXPECT_NE(check.out.find("a.ply\n"), std::string::npos);
  EXPECT_NE(check.out.find("b.off\n"), std::string::npos);

  // One that cannot be read does not keep the others from being looked at.
  writeBytes(folder / "bad.ply", "ply\nformat");
  const Outcome mixed = run("check bad.ply a.ply --json");
  EXPECT_EQ(mixed.exitCode, 3);
  const Json files = test::parseJson(mixed.out).at("files");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0]["error"]["code"], "unreadable_file");
  EXPECT_EQ(files[1]["watertight"], true);

  writeBytes(folder / "open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(run("check open.off a.ply --quiet").exitCode, 1);
}

}  // namespace
}  // namespace tufa
