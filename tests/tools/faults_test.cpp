// The tufa command where the machine fails it: no memory, no space, an end in the middle of
// writing.

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <random>
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
    std::error_code gone;  // it may take its place meanwhile
    const std::uintmax_t size = entry.file_size(gone);
    if (name.starts_with(".tufa-") && !gone && size > 0) return name;
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
    for (const int megabytes : {200, 300}) {
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

/// Where Blosc crashes, TBB cannot start a thread or OpenVDB cannot free a tree, the file is not to
/// blame.
TEST_F(Faults, BlameNoFileForTooLittleMemory) {
  if (sanitized()) GTEST_SKIP() << "a sanitizer needs more addresses than any limit leaves";
  ASSERT_EQ(run("make sphere --voxel 0.004 -o s.vdb").exitCode, 0);
  int failures = 0;
  for (int megabytes = 150; megabytes <= 270; megabytes += 8) {
    const std::string limit = "ulimit -v " + std::to_string(megabytes * 1024) + "; ";
    const Outcome outcome = run("mesh s.vdb --uniform --quiet -o m.ply --threads 2", "", limit);
    if (outcome.exitCode == 0) break;
    ++failures;
    EXPECT_EQ(outcome.exitCode, 3) << limit << outcome.err;
    EXPECT_EQ(outcome.err, "tufa: out of memory\n") << limit;
    EXPECT_EQ(folder.fileCount(), 1) << limit;
  }
  EXPECT_GE(failures, 5);
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

/// Ends the command at forty random times of its writing: there is the file that was there
/// before or the new one, and a rest has the name of a temporary file.
TEST_F(Faults, LeaveNoPartOfAFileUnderItsNameWhenKilled) {
  ASSERT_EQ(run("make sphere --voxel 0.02 -o s.vdb").exitCode, 0);
  ASSERT_EQ(run("mesh s.vdb --uniform --no-repair --quiet -o whole.obj").exitCode, 0);
  const std::string whole = readBytes(folder / "whole.obj");
  const std::string s = folder / "s.vdb";
  const std::string m = folder / "m.obj";
  std::mt19937 random(1);
  int inTheMiddle = 0;
  for (int n = 0; n < 40; ++n) {
    writeBytes(m, "as it was");
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::execl(TUFA_COMMAND, "tufa", "mesh", s.c_str(), "--uniform", "--no-repair", "--quiet", "-o",
              m.c_str(), nullptr);
      ::_exit(127);
    }
    int status = 0;
    bool ended = false;
    while (temporaryFile(folder / "").empty() && !ended) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      ended = ::waitpid(child, &status, WNOHANG) != 0;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20000));
    if (!ended) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
    }
    const std::string rest = temporaryFile(folder / "");
    const std::string now = readBytes(m);
    if (rest.empty()) {
      EXPECT_TRUE(now == whole || now == "as it was") << n;
    } else {
      ++inTheMiddle;
      EXPECT_EQ(now, "as it was");
      EXPECT_TRUE(rest.ends_with(".tmp"));
      std::filesystem::remove(folder / rest);
    }
  }
  EXPECT_GE(inTheMiddle, 1);
}

}  // namespace
}  // namespace tufa
