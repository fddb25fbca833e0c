#pragma once

#include <tufa/export.h>
#include <filesystem>
#include <string>

namespace tufa {

/// A folder that gets new files all together: they are written beside the old ones, to a folder in
/// it, and take their places when all of them are whole. Until then, and if that never comes, the
/// folder holds what it held. All members throw Error(UnwritableFile). For chunks there is
/// ChunkFolder.
class TUFA_API StagedFolder {
 public:
  /// Makes the folder if it is not there.
  explicit StagedFolder(std::filesystem::path folder);
  /// Takes away what was not committed, and the folder itself if it was made for it.
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Where to write.
  [[nodiscard]] std::string path() const { return staging_.string(); }

  /// Moves the files to their places, the one named `last` behind all others. A file that is
  /// replaced keeps its permissions; a link is replaced, not followed. If one cannot be moved, all
  /// are put back. While they move, the old ones are in `.before` in path(): that is where they are
  /// if the process is killed then.
  void commit(const std::string& last);

 private:
  std::filesystem::path folder_;
  std::filesystem::path staging_;
  bool made_ = false;  ///< the folder, for these files
};

}  // namespace tufa
