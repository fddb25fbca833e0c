#include <tufa/staged_folder.h>

#include <unistd.h>

#include <tufa/error.h>
#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

namespace tufa {
namespace {

/// Within the folder of files that wait, those that they replace, while they change places.
constexpr const char* kBeforeFolder = ".before";

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

std::vector<std::filesystem::path> namesIn(const std::filesystem::path& folder,
                                           std::error_code& error) {
  std::vector<std::filesystem::path> names;
  std::filesystem::directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// What can be done before anything has moved: refuses places that cannot be taken, and gives a
/// file the permissions of the one that it replaces.
void prepareExchange(const std::filesystem::path& file, const std::filesystem::path& place) {
  std::error_code error;
  const auto before = std::filesystem::symlink_status(place, error);
  if (std::filesystem::is_directory(before)) {
    throw Error(ErrorCode::UnwritableFile, "cannot replace " + place.string() +
                                               ": it is a directory; remove it, or write to "
                                               "another folder");
  }
  if (!std::filesystem::is_regular_file(before)) return;
  std::filesystem::permissions(file, before.permissions(), error);
  if (error) failTo("keep the permissions of " + place.string(), error);
}

/// Files that take the places of others, one after another, all by renames.
class FileExchange {
 public:
  FileExchange(std::filesystem::path from, std::filesystem::path to)
      : from_(std::move(from)), to_(std::move(to)), before_(from_ / kBeforeFolder) {}

  /// The last one replaces what is there in one step, as nothing behind it can fail.
  void take(const std::filesystem::path& name, bool isLast) {
    Step& step = steps_.emplace_back(Step{name});
    std::error_code error;
    if (!isLast && std::filesystem::exists(std::filesystem::symlink_status(to_ / name, error))) {
      makeFolder(before_);
      std::filesystem::rename(to_ / name, before_ / name, error);
      if (error) failTo("replace " + (to_ / name).string(), error);
      step.isAside = true;
    }
    std::filesystem::rename(from_ / name, to_ / name, error);
    if (error) failTo("replace " + (to_ / name).string(), error);
    step.isTaken = true;
  }

  /// Brings everything back; whether all came.
  bool undo() {
    bool isWhole = true;
    for (; !steps_.empty(); steps_.pop_back()) {
      const Step& step = steps_.back();
      std::error_code error;
      if (step.isTaken) std::filesystem::rename(to_ / step.name, from_ / step.name, error);
      if (step.isAside) std::filesystem::rename(before_ / step.name, to_ / step.name, error);
      isWhole = isWhole && !error;
    }
    std::error_code ignored;
    std::filesystem::remove(before_, ignored);
    return isWhole;
  }

 private:
  struct Step {
    std::filesystem::path name;
    bool isAside = false;  ///< what was there
    bool isTaken = false;  ///< the place, by the new file
  };
  std::filesystem::path from_, to_, before_;
  std::vector<Step> steps_;
};

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
  std::error_code error;
  std::vector<std::filesystem::path> names = namesIn(staging_, error);
  if (error) failTo("list the files in " + staging_.string(), error);
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::filesystem::path& name) { return name != last; });
  for (const std::filesystem::path& name : names) prepareExchange(staging_ / name, folder_ / name);
  FileExchange exchange(staging_, folder_);
  try {
    for (const std::filesystem::path& name : names) exchange.take(name, &name == &names.back());
  } catch (const std::exception& failure) {
    if (exchange.undo()) throw;
    // Not to be taken away.
    const std::filesystem::path kept = std::exchange(staging_, std::filesystem::path());
    throw Error(ErrorCode::UnwritableFile, std::string(failure.what()) + "; what was in " +
                                               folder_.string() + " before is partly in " +
                                               (kept / kBeforeFolder).string() +
                                               " now: move it back from there");
  }
  std::filesystem::remove_all(staging_ / kBeforeFolder, error);
}

}  // namespace tufa
