#pragma once

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "support/scratch_folder.h"

namespace tufa::test {

/// A small file system in memory, mounted on a folder; not every place lets a test mount one.
class Mount {
 public:
  Mount(std::filesystem::path folder, unsigned long flags, const char* options)
      : folder_(std::move(folder)) {
    std::filesystem::create_directory(folder_);
    mounted_ = ::mount("tufa-test", folder_.c_str(), "tmpfs", flags, options) == 0;
  }
  ~Mount() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  Mount(const Mount&) = delete;
  Mount& operator=(const Mount&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }

 private:
  std::filesystem::path folder_;
  bool mounted_ = false;
};

struct Outcome {
  int exitCode = -1;
  std::string out;
  std::string err;
};

/// Runs the command in a folder of its own.
class CommandTest : public ::testing::Test {
 protected:
  /// Runs `tufa ARGUMENTS` in the scratch folder. `after` is shell text behind its redirections,
  /// `before` a shell command ahead of it.
  Outcome run(const std::string& arguments, const std::string& after = "",
              const std::string& before = "") {
    const std::string line = "cd '" + (folder / "").string() + "' || exit; " + before +
                             "'" TUFA_COMMAND "' " + arguments + " >'" + (logs / "out").string() +
                             "' 2>'" + (logs / "err").string() + "' " + after;
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readBytes(logs / "out"),
            readBytes(logs / "err")};
  }

  /// Expects an exit code, one line of error that holds `part`, and no new file.
  void expectFailure(const std::string& arguments, int exitCode, const std::string& part) {
    const auto files = folder.fileCount();
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, exitCode) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.err.rfind("tufa: ", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(folder.fileCount(), files) << arguments;
  }

  void makeSphere() { ASSERT_EQ(run("make sphere --voxel 0.1 -o s.vdb").exitCode, 0); }

  const ScratchFolder folder;

 private:
  struct Logs {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("tufa-logs-" + std::to_string(::getpid()));
    Logs() { std::filesystem::create_directories(path); }
    ~Logs() { std::filesystem::remove_all(path); }
    std::filesystem::path operator/(const char* name) const { return path / name; }
  } logs;
};

}  // namespace tufa::test
