#pragma once

#include <tufa/chunk.h>
#include <tufa/contour.h>
#include <tufa/coord.h>
#include <tufa/export.h>
#include <tufa/grid_files.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>
#include <functional>
#include <vector>

namespace tufa {

/// Options of buildChunks().
struct ChunkOptions {
  /// How the surface is read. `tolerance` is that of LOD 0; vertices near planes between chunks
  /// move by up to 0.02 voxels whatever it is. Ignored: `uniform`, `normals` (always the
  /// gradient's), `repair` (always made), `keepLeaves`, `keepCells`. Needs edge collapse:
  /// `simplify`, and no bounds on cells or angles.
  ContourOptions contour;
  int chunkSize = 64;  ///< voxels along each edge, a power of two from 8 to 1024
  int levels = 4;      ///< LODs of each chunk, 1 to 16
  double factor = 4;   ///< each LOD's tolerance over that of the LOD before; above 1, to 10^6
  /// Normals are split where those of two faces at an edge differ by more than this angle, so that
  /// a position on a crease has several vertices: degrees, 0 to 180; 180 splits none. On faces of
  /// chunks those of the first LOD that has a vertex at its place count, for all LODs.
  double creaseAngle = 40;
  /// How files of .glb are to be stored. If not as floats, all positions are moved to one lattice,
  /// see ChunkIndex::step.
  GlbCompression compression = GlbCompression::None;
  UpAxis up = UpAxis::Y;  ///< .glb: of the volume
  double scale = 1;       ///< .glb: metres in a world unit; above 0
  /// Active voxels of a slab, or more. Of volumes of twice as many and more LOD 0 is made in slabs
  /// of chunks one after another, so that memory holds the uniform mesh of one: see
  /// docs/stages/chunks.md. Volumes whose tolerance is scaled from place to place are not.
  std::size_t slabVoxels = 8'000'000;
  /// The chunks to make; empty: all. A chunk has the same bytes whichever are made with it.
  std::vector<Coord> only;
};

/// Receives the chunks, one at a time, on the calling thread, in an order that is always the same.
/// The index has everything but its `chunks`.
using ChunkSink = std::function<void(const ChunkIndex& index, Chunk&& chunk)>;

/// Divides the surface of `grid` into chunks, each at several levels of detail. Whatever LOD each
/// chunk is drawn at, the surface is closed where neighbours differ by at most one LOD and the
/// strips are chosen by transitionMask(): vertices on common faces are the same bits, positions and
/// normals. See contour() for what is kept and for the errors thrown; throws Error(InvalidArgument)
/// for options out of their range too.
///
/// Memory holds the grid, the uniform mesh of a slab (see ChunkOptions::slabVoxels) and all LODs;
/// which chunks are asked for does not change that. Of a volume in slabs the report's counts of
/// creases and repairs are too high by what lies near a plane between two of them.
TUFA_API ChunkIndex buildChunks(const openvdb::GridBase& grid, const ChunkOptions& options,
                                const ChunkSink& sink, ContourReport* report = nullptr);

/// The same of a grid that stays in its file: memory holds the values of a slab at a time, and of
/// the others which voxels are active. The chunks are the same bytes. Throws Error(UnreadableFile)
/// too.
TUFA_API ChunkIndex buildChunks(GridFile& file, const ChunkOptions& options, const ChunkSink& sink,
                                ContourReport* report = nullptr);

/// The triangles of a chunk to draw: its interior, and for each face the transition strip if the
/// face's bit in `mask` is set, else the regular one. Only the vertices that they use, with their
/// attributes. Throws Error(InvalidArgument) where there are no such strips, a mask other than 0 at
/// the last LOD, and for a chunk whose indices point nowhere.
[[nodiscard]] TUFA_API Mesh meshForMask(const Chunk& chunk, std::size_t level, unsigned mask);

/// A bit for each face of a chunk whose neighbour is drawn at a coarser LOD. `lods` has an LOD for
/// each of the index's chunks. Throws Error(InvalidArgument) if it does not fit, or there is no
/// such chunk.
[[nodiscard]] TUFA_API unsigned transitionMask(const ChunkIndex& index, std::size_t chunk,
                                               const std::vector<std::size_t>& lods);

/// Makes LODs finer until neighbours differ by at most one. Throws Error(InvalidArgument) if `lods`
/// does not fit the index, or a chunk has no such LOD.
TUFA_API void restrictLods(const ChunkIndex& index, std::vector<std::size_t>& lods);

/// For each chunk the coarsest LOD whose certified error covers at most `pixelError` pixels, made
/// finer where neighbours would differ by more than one LOD. Errors are seen from the nearest point
/// of a chunk; a strip beside a coarser neighbour has up to the error of that neighbour's LOD,
/// which is judged from where the neighbour begins. Throws Error(InvalidArgument) if a chunk of the
/// index has no levels, and as selectLod().
[[nodiscard]] TUFA_API std::vector<std::size_t> selectLods(const ChunkIndex& index,
                                                           const Camera& camera,
                                                           double pixelError = 1);

/// One mesh of all chunks, each at its own LOD; vertices at equal positions become one. LODs of
/// neighbours may differ by more than one if the chunks have their seams. Missing chunks leave
/// their neighbours open. Attributes are left out: sample them at the mesh's vertices. Throws
/// Error(InvalidArgument) if `lods` does not fit, for chunks whose indices point nowhere, or where
/// seams are needed and missing.
[[nodiscard]] TUFA_API Mesh assembleChunks(const std::vector<Chunk>& chunks,
                                           const std::vector<std::size_t>& lods);

}  // namespace tufa
