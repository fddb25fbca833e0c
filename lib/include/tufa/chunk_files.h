#pragma once

#include <tufa/chunk.h>
#include <tufa/export.h>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tufa {

/// How chunks are stored.
enum class ChunkFormat {
  Glb,  ///< a primitive for the interior and for each strip, one vertex buffer
  Ply,  ///< a face property `part`: 0 the interior, 1 to 6 regular strips, 7 to 12 transition ones
};

/// A file of a chunk.
struct ChunkFile {
  std::string name;      ///< relative to the folder; empty if the LOD has no triangles
  std::string checksum;  ///< of its bytes, FNV-1a of 64 bits, in hexadecimal digits
};

/// Writes the meshes of a chunk into a folder and returns the files, one for each LOD. Each appears
/// whole or not at all. The index says how a .glb is stored; a .ply is in world units,
/// uncompressed. May be called from several threads for different chunks. Throws Error:
/// UnwritableFile; InvalidArgument for a chunk whose indices point nowhere or whose arrays do not
/// fit, and for compressed chunks off the index's lattice; LimitExceeded for a .glb above 4 GiB.
TUFA_API std::vector<ChunkFile> writeChunk(const ChunkIndex& index, const Chunk& chunk,
                                           const std::string& folder, ChunkFormat format);

/// Writes chunks.json. The index is that of buildChunks(), with the ChunkFile that writeChunk()
/// gave for each LOD put into its ChunkLevelEntry: readChunk() needs them. Throws Error:
/// UnwritableFile, InvalidArgument for an index that readChunkIndex() would refuse: one without
/// levels, unsorted, with numbers that are not finite, with files outside the folder.
TUFA_API void writeChunkIndex(const ChunkIndex& index, const std::string& folder);

/// A folder that gets chunks all together: until commit(), and if that never comes, it holds what
/// it held. See StagedFolder.
class TUFA_API ChunkFolder {
 public:
  /// Nothing is made before there is something to write. `threads`: most that write at a time, 0:
  /// as many as there are.
  explicit ChunkFolder(std::string folder, ChunkFormat format = ChunkFormat::Glb, int threads = 0);
  ~ChunkFolder();
  ChunkFolder(const ChunkFolder&) = delete;
  ChunkFolder& operator=(const ChunkFolder&) = delete;

  /// Takes a chunk that a ChunkSink is given, and writes those at hand once they are many: most of
  /// the time goes into making files. Throws Error as writeChunk() does.
  void add(const ChunkIndex& index, Chunk&& chunk);

  /// Writes what is left and the index of buildChunks(), in which it puts down the files, and moves
  /// all to their places, chunks.json last. Files that chunks.json listed before are removed if
  /// they are none of these. With `keepsOthers`, for ChunkOptions::only, chunks that are listed
  /// there and not in the index stay. Throws Error: UnwritableFile; InvalidArgument for chunks that
  /// were not added, and with `keepsOthers` where those before are of another volume or other
  /// options.
  void commit(ChunkIndex& index, bool keepsOthers = false);

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

/// Reads chunks.json. Throws Error(UnreadableFile).
[[nodiscard]] TUFA_API ChunkIndex readChunkIndex(const std::string& folder);

/// Reads the meshes of a chunk back, without seams and attributes. Throws Error(UnreadableFile),
/// also for a file that is another one than chunks.json lists.
[[nodiscard]] TUFA_API Chunk readChunk(const ChunkIndex& index, std::size_t chunk,
                                       const std::string& folder);

}  // namespace tufa
