// Files that take their places together, or not at all.

#include <tufa/staged_folder.h>

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using test::readBytes;
using test::writeBytes;

class StagedFolders : public ::testing::Test {
 protected:
  /// The files in the folder by their names, with their bytes; those of folders are "".
  [[nodiscard]] std::map<std::string, std::string> held() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(place)) {
      files[entry.path().filename().string()] =
          entry.is_directory() ? "" : readBytes(entry.path().string());
    }
    return files;
  }

  const test::ScratchFolder folder;
  const std::string place = (folder / "all").string();
};

TEST_F(StagedFolders, ReplaceNothingWhereAPlaceIsADirectory) {
  std::filesystem::create_directories(place + "/b");
  writeBytes(place + "/a", "before");
  const auto before = held();
  {
    StagedFolder staged(place);
    for (const char* name : {"/a", "/b", "/index"}) writeBytes(staged.path() + name, "new");
    test::expectError(ErrorCode::UnwritableFile, "all/b: it is a directory; remove it",
                      [&] { staged.commit("index"); });
  }
  EXPECT_EQ(held(), before);
}

// A directory cannot take the place of a file: that fails when the others have taken theirs.
TEST_F(StagedFolders, PutAllBackWhereTheLastFileFails) {
  std::filesystem::create_directory(place);
  for (const char* name : {"/a", "/b", "/index"}) writeBytes(place + name, "before");
  const auto before = held();
  {
    StagedFolder staged(place);
    for (const char* name : {"/a", "/b", "/c"}) writeBytes(staged.path() + name, "new");
    std::filesystem::create_directory(staged.path() + "/index");
    for (int attempt = 0; attempt < 2; ++attempt) {
      test::expectError(ErrorCode::UnwritableFile, "cannot replace",
                        [&] { staged.commit("index"); });
      for (const auto& [name, bytes] : before) EXPECT_EQ(readBytes(place + "/" + name), bytes);
      EXPECT_EQ(held().size(), before.size() + 1) << "more than the staged files' folder came";
    }
    std::filesystem::remove(staged.path() + "/index");
    writeBytes(staged.path() + "/index", "new");
    staged.commit("index");
  }
  EXPECT_EQ(held(), (std::map<std::string, std::string>{
                        {"a", "new"}, {"b", "new"}, {"c", "new"}, {"index", "new"}}));
}

TEST_F(StagedFolders, KeepPermissionsAndReplaceLinks) {
  std::filesystem::create_directory(place);
  writeBytes(place + "/a", "before");
  writeBytes((folder / "linked").string(), "before");
  std::filesystem::permissions(place + "/a", std::filesystem::perms::owner_read);
  std::filesystem::create_symlink(folder / "linked", place + "/b");
  {
    StagedFolder staged(place);
    for (const char* name : {"/a", "/b", "/index"}) writeBytes(staged.path() + name, "new");
    staged.commit("index");
  }
  EXPECT_EQ(std::filesystem::status(place + "/a").permissions(),
            std::filesystem::perms::owner_read);
  EXPECT_FALSE(std::filesystem::is_symlink(place + "/b"));
  EXPECT_EQ(readBytes(folder / "linked"), "before");
  EXPECT_EQ(held(),
            (std::map<std::string, std::string>{{"a", "new"}, {"b", "new"}, {"index", "new"}}));
}

}  // namespace
}  // namespace tufa
