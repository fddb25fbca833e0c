#pragma once

#include <tufa/contour.h>
#include <tufa/coord.h>
#include <tufa/export.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace tufa {

/// The faces of a chunk: -x, +x, -y, +y, -z, +z of index space have the numbers 0 to 5.
inline constexpr int kChunkFaces = 6;

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
  /// The chunks to make; empty: all. A chunk has the same bytes whichever are made with it.
  std::vector<Coord> only;
};

/// A curve along which the surface passes a face of a chunk, at one LOD of the chunk.
struct ChunkSeam {
  std::vector<VertexIndex> vertices;  ///< in the order of the chunk's triangles beside them
  bool closed = false;                ///< the last vertex is followed by the first
  /// For each vertex the place of the one of the next LOD's curve that it becomes there; its own at
  /// the last LOD.
  std::vector<Position> next;
};

/// A chunk at one LOD: an interior, and for each face two strips, one of which is drawn. All
/// triangles index the same vertices.
struct ChunkLevel {
  std::vector<Position> positions;  ///< world space
  std::vector<Normal> normals;      ///< one for each position
  /// Values at the positions, for files; buildChunks() leaves them empty, see sampleAttribute().
  /// The same at equal positions, as they depend on nothing else.
  std::vector<Attribute> attributes = {};
  std::vector<Triangle> interior;  ///< always drawn
  /// To a neighbour of the same LOD or a finer one.
  /// Only triangles that are others beside a coarser neighbour; the rest is `interior`.
  std::array<std::vector<Triangle>, kChunkFaces> regular;
  /// The same triangles beside a neighbour that is coarser by one LOD; none at the last LOD.
  std::array<std::vector<Triangle>, kChunkFaces> transition;
  /// The chunk's curves on each face, for strips to neighbours that are coarser by more.
  std::array<std::vector<ChunkSeam>, kChunkFaces> seams;
  double maxErrorVoxels = 0;         ///< certified, with the regular strips
  double transitionErrorVoxels = 0;  ///< certified, with the transition strips
};

/// A cube of chunkSize voxels along each edge, from index * chunkSize on, that the surface passes.
struct Chunk {
  Coord index;                     ///< in chunks
  std::vector<ChunkLevel> levels;  ///< the finest first
};

/// What is known of one LOD of a chunk without its mesh.
struct ChunkLevelEntry {
  std::string file;                     ///< relative to the folder; empty if not written
  std::string checksum;                 ///< of the file, as writeChunk() gives it; empty: unknown
  std::size_t vertices = 0;             ///< with those of both kinds of strips
  std::size_t interiorTriangles = 0;    ///< of ChunkLevel::interior
  std::size_t regularTriangles = 0;     ///< of all six regular strips
  std::size_t transitionTriangles = 0;  ///< of all six transition strips
  Position least;                       ///< corner of the bounding box, world space
  Position greatest;                    ///< corner of the bounding box, world space
  double maxErrorVoxels = 0;            ///< as ChunkLevel has it
  double transitionErrorVoxels = 0;     ///< as ChunkLevel has it
  std::size_t intersectionsLeft = 0;    ///< pairs of its triangles that intersect
  /// Of the interior and regular strips, degrees. Only buildChunks() knows it: chunks.json does not
  /// have it, nor the next one.
  double smallestAngle = 0;
  /// Of the interior and regular strips: triangles with an angle below ContourOptions::minAngle.
  std::size_t trianglesUnderMinAngle = 0;
};

/// What is known of a chunk without its meshes.
struct ChunkEntry {
  Coord index;                          ///< in chunks
  std::vector<ChunkLevelEntry> levels;  ///< the finest first
};

/// All chunks of a volume.
struct ChunkIndex {
  std::string grid;                ///< name of the grid
  int chunkSize = 64;              ///< voxels
  std::vector<double> tolerances;  ///< of each LOD, voxels
  double voxelSize = 1;            ///< world units: the cube root of a voxel's volume
  /// From index to world space: rows of a matrix that a row vector (x, y, z, 1) is multiplied with.
  std::array<std::array<double, 4>, 4> transform{};
  /// World point, the same for all chunks, that files of single precision count positions from.
  Position origin{0, 0, 0};
  double creaseAngle = 40;                            ///< as in ChunkOptions
  GlbCompression compression = GlbCompression::None;  ///< None if 16 bits cannot hold the chunks
  /// If compressed: world units between neighbouring places of the lattice that all positions are
  /// on. Times `scale` a power of two, so that no program that computes in floats moves a vertex.
  double step = 0;
  UpAxis up = UpAxis::Y;  ///< as in ChunkOptions
  double scale = 1;       ///< as in ChunkOptions
  /// Names, widths and roles of the attributes in the files, without values; what writes chunks
  /// fills it in.
  std::vector<Attribute> attributes = {};
  std::vector<ChunkEntry> chunks;  ///< sorted by index

  /// The place of a chunk in `chunks`, or -1.
  [[nodiscard]] TUFA_API std::ptrdiff_t find(const Coord& index) const;
  /// The place of the chunk beyond a face, 0 to 5, of a chunk, or -1. Throws Error(InvalidArgument)
  /// if there is no such face or chunk.
  [[nodiscard]] TUFA_API std::ptrdiff_t neighbour(std::size_t chunk, int face) const;
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
/// Memory holds the grid, its whole uniform mesh and all LODs; which chunks are asked for does not
/// change that.
TUFA_API ChunkIndex buildChunks(const openvdb::GridBase& grid, const ChunkOptions& options,
                                const ChunkSink& sink, ContourReport* report = nullptr);

/// The triangles of a chunk to draw: its interior, and for each face the transition strip if the
/// face's bit in `mask` is set, else the regular one. Only the vertices that they use, with their
/// attributes. Throws Error(InvalidArgument) where there are no such strips: a mask other than 0 at
/// the last LOD.
[[nodiscard]] TUFA_API Mesh meshForMask(const Chunk& chunk, std::size_t level, unsigned mask);

/// A bit for each face of a chunk whose neighbour is drawn at a coarser LOD. `lods` has an LOD for
/// each of the index's chunks. Throws Error(InvalidArgument) if it does not fit, or there is no
/// such chunk.
[[nodiscard]] TUFA_API unsigned transitionMask(const ChunkIndex& index, std::size_t chunk,
                                               const std::vector<std::size_t>& lods);

/// Makes LODs finer until neighbours differ by at most one. Throws Error(InvalidArgument) if `lods`
/// does not fit the index.
TUFA_API void restrictLods(const ChunkIndex& index, std::vector<std::size_t>& lods);

/// For each chunk the coarsest LOD whose certified error covers at most `pixelError` pixels, made
/// finer where neighbours would differ by more than one LOD. Throws Error(InvalidArgument) if a
/// chunk of the index has no levels.
[[nodiscard]] TUFA_API std::vector<std::size_t> selectLods(const ChunkIndex& index,
                                                           const Camera& camera,
                                                           double pixelError = 1);

/// One mesh of all chunks, each at its own LOD; vertices at equal positions become one. LODs of
/// neighbours may differ by more than one if the chunks have their seams. Missing chunks leave
/// their neighbours open. Attributes are left out: sample them at the mesh's vertices. Throws
/// Error(InvalidArgument) if `lods` does not fit, or where seams are needed and missing.
[[nodiscard]] TUFA_API Mesh assembleChunks(const std::vector<Chunk>& chunks,
                                           const std::vector<std::size_t>& lods);

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
/// UnwritableFile, InvalidArgument for compressed chunks off the index's lattice, LimitExceeded for
/// a .glb above 4 GiB.
TUFA_API std::vector<ChunkFile> writeChunk(const ChunkIndex& index, const Chunk& chunk,
                                           const std::string& folder, ChunkFormat format);

/// Writes chunks.json. Throws Error(UnwritableFile).
TUFA_API void writeChunkIndex(const ChunkIndex& index, const std::string& folder);

/// Reads chunks.json. Throws Error(UnreadableFile).
[[nodiscard]] TUFA_API ChunkIndex readChunkIndex(const std::string& folder);

/// Reads the meshes of a chunk back, without seams and attributes. Throws Error(UnreadableFile),
/// also for a file that is another one than chunks.json lists.
[[nodiscard]] TUFA_API Chunk readChunk(const ChunkIndex& index, std::size_t chunk,
                                       const std::string& folder);

}  // namespace tufa
