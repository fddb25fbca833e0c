#pragma once

#include <tufa/export.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tufa {

// What <tufa/io.h> and <tufa/lod.h> do with files, for bytes in memory and for streams.

/// The bytes of a whole file.
struct FileBytes {
  std::string_view bytes;       ///< must outlive the call
  std::string name = "memory";  ///< in place of the file's in messages
};

/// Reads a mesh as readMesh() does from a file. Throws Error(UnreadableFile).
[[nodiscard]] TUFA_API Mesh readMesh(const FileBytes& file, MeshFormat format);

/// Reads one grid of the bytes of a .vdb file as readGrid() does from a file, and throws the same.
/// The bytes need no offsets: what writeGrids() has written to a stream is read too.
[[nodiscard]] TUFA_API std::shared_ptr<openvdb::GridBase> readGrid(
    const FileBytes& file, const std::optional<std::string>& name = {});

/// Lists the grids of the bytes of a .vdb file. Throws Error(UnreadableFile).
[[nodiscard]] TUFA_API std::vector<GridName> listGrids(const FileBytes& file);

/// Describes the grids of the bytes of a .vdb file. Throws Error(UnreadableFile).
[[nodiscard]] TUFA_API std::vector<GridInfo> describeGrids(const FileBytes& file);

/// Writes a mesh to a stream, from its beginning to its end without seeking, in the bytes that
/// write() would give a file. Throws Error: UnwritableFile if the stream fails, and what write()
/// throws; what the stream itself throws passes through. On failure part of the mesh may have been
/// written.
TUFA_API void write(const Mesh& mesh, std::ostream& stream, MeshFormat format,
                    const WriteOptions& options = {}, WriteReport* report = nullptr);

/// Writes several meshes to a stream, as .glb, .obj or .usda: see writeMeshes() for files.
TUFA_API void writeMeshes(const std::vector<NamedMesh>& meshes, std::ostream& stream,
                          MeshFormat format, const WriteOptions& options = {},
                          WriteReport* report = nullptr);

/// Writes all LODs to a stream as one .glb or .usda: see writeLods() for files. The report names no
/// file.
TUFA_API void writeLods(const LodChain& chain, std::ostream& stream, MeshFormat format,
                        const LodWriteOptions& options = {}, LodWriteReport* report = nullptr);

/// Writes grids to a stream as a .vdb without offsets. Throws Error(UnwritableFile).
TUFA_API void writeGrids(const std::vector<std::shared_ptr<const openvdb::GridBase>>& grids,
                         std::ostream& stream);

}  // namespace tufa
