#include <tufa/staged_folder.h>

#include <unistd.h>

#include <tufa/error.h>
#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

namespace tufa {
namespace {

[[noreturn]] void failTo(const std::string& what, const std::error_code& error) {
  throw Error(ErrorCode::UnwritableFile, "cannot " + what + ": " + error.message());
}

/// Makes a folder; whether it was not there before.
bool makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  const bool made = std::filesystem::create_directory(folder, error);
  if (error) failTo("make the folder " + folder.string(), error);
  return made;
}

}  // namespace

StagedFolder::StagedFolder(std::filesystem::path folder)
    : folder_(std::move(folder)), made_(makeFolder(folder_)) {
  const std::string stem = ".tufa-" + std::to_string(::getpid()) + "-";
  constexpr int kAttempts = 1000;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto candidate = folder_ / (stem + std::to_string(attempt) + ".tmp");
    // Never into what someone else made, or a process of the same number left behind.
    std::error_code ignored;
    const auto status = std::filesystem::symlink_status(candidate, ignored);
    if (std::filesystem::exists(status) || !makeFolder(candidate)) continue;
    staging_ = candidate;
    return;
  }
  failTo("make a folder in " + folder_.string(), std::make_error_code(std::errc::file_exists));
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(staging_, ignored);
  if (made_) std::filesystem::remove(folder_, ignored);  // if nothing came into it
}

void StagedFolder::commit(const std::string& last) {
  std::vector<std::filesystem::path> names;
  for (const auto& entry : std::filesystem::directory_iterator(staging_)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::filesystem::path& name) { return name != last; });
  for (const std::filesystem::path& name : names) {
    std::error_code error;
    const auto before = std::filesystem::symlink_status(folder_ / name, error);
    if (std::filesystem::is_regular_file(before)) {
      std::filesystem::permissions(staging_ / name, before.permissions(), error);
      if (error) failTo("keep the permissions of " + (folder_ / name).string(), error);
    }
    std::filesystem::rename(staging_ / name, folder_ / name, error);
    if (error) failTo("replace " + (folder_ / name).string(), error);
  }
}

}  // namespace tufa
