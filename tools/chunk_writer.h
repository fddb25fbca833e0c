#pragma once

#include <tufa/chunk_files.h>
#include <tufa/coord.h>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace tufa::tools {

/// Writes chunks to a folder, several at a time: most of the time goes into making files.
class ChunkWriter {
 public:
  /// `threads`: most at work, 1 or more.
  ChunkWriter(ChunkFormat format, int threads) : format_(format), threads_(threads) {}

  /// Takes a chunk to write, and writes those at hand once they are many. Throws Error as
  /// writeChunk() does.
  void add(const ChunkIndex& index, Chunk&& chunk, const std::string& folder);
  /// Writes what is left. Throws as add() does.
  void finish();
  /// The files of each chunk that is written.
  [[nodiscard]] const std::vector<ChunkFile>& files(const Coord& chunk) const {
    return files_.at(chunk);
  }

 private:
  ChunkFormat format_;
  int threads_;
  std::string folder_;
  ChunkIndex index_;  ///< without its chunks
  std::vector<Chunk> waiting_;
  std::map<Coord, std::vector<ChunkFile>> files_;
};

}  // namespace tufa::tools
