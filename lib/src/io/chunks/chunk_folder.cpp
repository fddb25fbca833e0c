// Chunks to a folder, all or none.

#include <tufa/chunk_files.h>
#include <tufa/error.h>
#include <tufa/staged_folder.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "base/job.h"

namespace tufa {
namespace {

// Chunks that wait to be written: enough that threads end at about the same time, and few beside
// the levels that they come from.
constexpr std::size_t kAtOnce = 128;
constexpr const char* kIndexName = "chunks.json";

bool hasIndex(const std::string& folder) {
  return std::filesystem::exists(std::filesystem::path(folder) / kIndexName);
}

bool sameNames(const std::vector<Attribute>& a, const std::vector<Attribute>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.name == y.name && x.width == y.width && x.role == y.role;
  });
}

/// That of an index's files; empty if there are none.
std::filesystem::path endingIn(const ChunkIndex& index) {
  for (const ChunkEntry& chunk : index.chunks) {
    for (const ChunkLevelEntry& level : chunk.levels) {
      if (!level.file.empty()) return std::filesystem::path(level.file).extension();
    }
  }
  return {};
}

/// Whether both have files, with other endings.
bool haveOtherFormats(const ChunkIndex& a, const ChunkIndex& b) {
  const std::filesystem::path first = endingIn(a), second = endingIn(b);
  return !first.empty() && !second.empty() && first != second;
}

/// In what chunks of an earlier run differ, so that they would not meet those of this one, with
/// commas between.
std::string differences(const ChunkIndex& before, const ChunkIndex& index) {
  const bool isKnown = !before.surface.empty() && !index.surface.empty();
  const std::pair<const char*, bool> parts[] = {
      {"the grid", before.grid != index.grid},
      {"its transform", before.transform != index.transform || !(before.origin == index.origin)},
      {"the chunk size", before.chunkSize != index.chunkSize},
      {"the tolerances", before.tolerances != index.tolerances},
      {"the crease angle", before.creaseAngle != index.creaseAngle},
      {"the compression", before.compression != index.compression || before.step != index.step},
      {"the axis that points up", before.up != index.up},
      {"the scale", before.scale != index.scale},
      {"the attributes", !sameNames(before.attributes, index.attributes)},
      {"the format", haveOtherFormats(before, index)},
  };
  std::string text;
  for (const auto& [name, differs] : parts) {
    if (differs) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  // Most of these come with another surface.
  if (text.empty() && isKnown && before.surface != index.surface) {
    return "the surface, as with other values, another isovalue or a filter";
  }
  return text;
}

/// Adds the chunks of an earlier run that this one has not built again.
void keepOthers(ChunkIndex& index, const std::string& folder) {
  if (!hasIndex(folder)) return;
  const ChunkIndex before = readChunkIndex(folder);
  if (const std::string text = differences(before, index); !text.empty()) {
    throw Error(ErrorCode::InvalidArgument,
                folder + " holds chunks of another volume or of other options: they differ in " +
                    text + "; make these with the same, or all of them again");
  }
  std::map<Coord, ChunkEntry> chunks;
  for (const std::vector<ChunkEntry>* entries : {&before.chunks, &std::as_const(index.chunks)}) {
    for (const ChunkEntry& chunk : *entries) chunks.insert_or_assign(chunk.index, chunk);
  }
  index.chunks.clear();
  for (auto& [place, chunk] : chunks) index.chunks.push_back(std::move(chunk));
}

std::vector<std::string> filesOf(const ChunkIndex& index) {
  std::vector<std::string> files;
  for (const ChunkEntry& chunk : index.chunks) {
    for (const ChunkLevelEntry& level : chunk.levels) files.push_back(level.file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Whether a name is one that writeChunk() gives: a list from elsewhere may name anything.
bool isChunkFile(const std::filesystem::path& path) {
  const std::filesystem::path ending = path.extension();
  return path.filename() == path && path.string().starts_with("chunk_") &&
         (ending == ".glb" || ending == ".ply");
}

/// The files of an earlier run in a folder that are not those of this one.
std::vector<std::filesystem::path> filesLeftOver(const std::string& folder,
                                                 const ChunkIndex& index) {
  std::vector<std::filesystem::path> left;
  ChunkIndex before;
  try {
    if (!hasIndex(folder)) return left;
    before = readChunkIndex(folder);
  } catch (const Error&) {
    return left;  // nobody knows what its files are
  }
  const std::vector<std::string> files = filesOf(index);
  for (const std::string& name : filesOf(before)) {
    const std::filesystem::path path = name;
    if (!isChunkFile(path)) continue;
    if (!std::binary_search(files.begin(), files.end(), name)) left.push_back(folder / path);
  }
  return left;
}

}  // namespace

class ChunkFolder::Writer {
 public:
  Writer(std::string folder, ChunkFormat format, int threads)
      : folder_(std::move(folder)), format_(format), threads_(threads) {}

  void add(const ChunkIndex& index, Chunk&& chunk) {
    if (waiting_.empty()) index_ = index;
    waiting_.push_back(std::move(chunk));
    if (waiting_.size() == kAtOnce) writeWaiting();
  }

  void commit(ChunkIndex& index, bool keepsOthers) {
    writeWaiting();
    nameFiles(index);
    ChunkIndex written = index;
    if (keepsOthers) keepOthers(written, folder_);
    removeUnnamed(index);
    writeChunkIndex(written, staged().path());
    const std::vector<std::filesystem::path> old = filesLeftOver(folder_, written);
    staged().commit(kIndexName);
    staged_.reset();
    for (const std::filesystem::path& file : old) {
      std::error_code ignored;
      std::filesystem::remove(file, ignored);
    }
  }

 private:
  StagedFolder& staged() {
    if (!staged_) staged_.emplace(folder_);
    return *staged_;
  }

  void writeWaiting() {
    if (waiting_.empty()) return;
    const std::string place = staged().path();
    std::vector<std::vector<ChunkFile>> made(waiting_.size());
    base::Job job(threads_, {});
    job.run([&] {
      job.forRanges(waiting_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          made[i] = writeChunk(index_, waiting_[i], place, format_);
        }
      });
    });
    for (std::size_t i = 0; i < made.size(); ++i) files_[waiting_[i].index] = std::move(made[i]);
    waiting_.clear();
  }

  void nameFiles(ChunkIndex& index) const {
    for (ChunkEntry& chunk : index.chunks) {
      const auto made = files_.find(chunk.index);
      if (made == files_.end() || made->second.size() != chunk.levels.size()) {
        throw Error(ErrorCode::InvalidArgument, "the index lists a chunk that was not added");
      }
      for (std::size_t i = 0; i < chunk.levels.size(); ++i) {
        chunk.levels[i].file = made->second[i].name;
        chunk.levels[i].checksum = made->second[i].checksum;
      }
    }
  }

  // Files of chunks that were taken out of the index again.
  void removeUnnamed(const ChunkIndex& index) {
    const std::vector<std::string> named = filesOf(index);
    for (const auto& [place, made] : files_) {
      for (const ChunkFile& file : made) {
        if (file.name.empty() || std::binary_search(named.begin(), named.end(), file.name))
          continue;
        std::error_code ignored;
        std::filesystem::remove(std::filesystem::path(staged().path()) / file.name, ignored);
      }
    }
  }

  std::string folder_;
  ChunkFormat format_;
  int threads_;
  std::optional<StagedFolder> staged_;
  ChunkIndex index_;  ///< without its chunks
  std::vector<Chunk> waiting_;
  std::map<Coord, std::vector<ChunkFile>> files_;
};

ChunkFolder::ChunkFolder(std::string folder, ChunkFormat format, int threads)
    : writer_(std::make_unique<Writer>(std::move(folder), format, threads)) {}

ChunkFolder::~ChunkFolder() = default;

void ChunkFolder::add(const ChunkIndex& index, Chunk&& chunk) {
  writer_->add(index, std::move(chunk));
}

void ChunkFolder::commit(ChunkIndex& index, bool keepsOthers) {
  writer_->commit(index, keepsOthers);
}

}  // namespace tufa
