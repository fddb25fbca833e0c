// The tufa command where the machine fails it: no memory, no space, an end in the middle of
// writing.

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tools/command_fixture.h"

namespace tufa {
namespace {

using test::CommandTest;
using test::Mount;
using test::Outcome;
using test::readBytes;
using test::writeBytes;

using Faults = CommandTest;

/// Whether the program was built with a sanitizer, which takes terabytes of addresses.
constexpr bool sanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#else
  return false;
#endif
}

/// The name of a file that a write has begun in the folder; empty if there is none.
std::string temporaryFile(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(".tufa-") && entry.file_size() > 0) return name;
  }
  return "";
}

/// Whatever memory there is, the command does its work or says that it cannot.
TEST_F(Faults, TellOfTooLittleMemory) {
  if (sanitized()) GTEST_SKIP() << "a sanitizer needs more addresses than any limit leaves";
  ASSERT_EQ(run("make noise -o s.vdb").exitCode, 0);
  int failures = 0;
  for (const char* arguments :
       {"mesh s.vdb --uniform --quiet -o m.ply --threads 2",
        "mesh s.vdb --quiet -o m.ply --threads 1 --check", "make sphere --voxel 0.005 -o v.vdb"}) {
    // With less, libraries that are loaded at the start cannot begin their threads.
    for (const int megabytes : {200, 300, 450}) {
      const std::string limit = "ulimit -v " + std::to_string(megabytes * 1024) + "; ";
      const Outcome outcome = run(arguments, "", limit);
      if (outcome.exitCode == 0) continue;
      ++failures;
      EXPECT_EQ(outcome.exitCode, 3) << limit << arguments << "\n" << outcome.err;
      EXPECT_NE(outcome.err.find("tufa: out of memory\n"), std::string::npos) << outcome.err;
      EXPECT_EQ(folder.fileCount(), 1) << limit << arguments;
    }
    std::filesystem::remove(folder / "m.ply");
    std::filesystem::remove(folder / "v.vdb");
  }
  EXPECT_GE(failures, 3);
}

TEST_F(Faults, TellOfFilesThatGrowTooLarge) {
  makeSphere();
  const Outcome outcome = run("mesh s.vdb --uniform --quiet -o m.ply", "", "ulimit -f 16; ");
  EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.fileCount(), 1);
}

/// What was there before survives a write that fails.
TEST_F(Faults, KeepTheFileThatWasThere) {
  makeSphere();
  const Mount disk(folder / "disk", 0, "size=16k");
  if (!disk.mounted()) GTEST_SKIP() << "no file system may be mounted here";
  writeBytes(folder / "disk/m.ply", "as it was");
  EXPECT_EQ(run("mesh s.vdb --uniform --quiet -o disk/m.ply").exitCode, 3);
  EXPECT_EQ(readBytes(folder / "disk/m.ply"), "as it was");
}

/// Ends the command once it has begun to write. It may be done sooner, then once more.
TEST_F(Faults, LeaveNoPartOfAFileUnderItsNameWhenKilled) {
  ASSERT_EQ(run("make sphere --voxel 0.01 -o s.vdb").exitCode, 0);
  const std::string s = folder / "s.vdb";
  const std::string m = folder / "m.obj";
  bool inTheMiddle = false;
  for (int attempt = 0; attempt < 20 && !inTheMiddle; ++attempt) {
    writeBytes(m, "as it was");
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::execl(TUFA_COMMAND, "tufa", "mesh", s.c_str(), "--uniform", "--no-repair", "--quiet", "-o",
              m.c_str(), nullptr);
      ::_exit(127);
    }
    int status = 0;
    while (temporaryFile(folder / "").empty() && ::waitpid(child, &status, WNOHANG) == 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    const std::string rest = temporaryFile(folder / "");
    inTheMiddle = !rest.empty();
    if (inTheMiddle) {
      EXPECT_EQ(readBytes(m), "as it was");
      EXPECT_TRUE(rest.ends_with(".tmp"));
    }
  }
  EXPECT_TRUE(inTheMiddle);
}

}  // namespace
}  // namespace tufa
