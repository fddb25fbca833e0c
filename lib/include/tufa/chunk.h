#pragma once

#include <tufa/coord.h>
#include <tufa/export.h>
#include <tufa/io.h>
#include <tufa/mesh.h>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace tufa {

/// The faces of a chunk: -x, +x, -y, +y, -z, +z of index space have the numbers 0 to 5.
inline constexpr int kChunkFaces = 6;

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
  double transitionErrorVoxels = 0;  ///< certified, with the transition strips; 0 at the last LOD
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
  Position least{0, 0, 0};              ///< corner of the bounding box, world space
  Position greatest{0, 0, 0};           ///< corner of the bounding box, world space
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
  /// FNV-1a of 64 bits, in hexadecimal digits, of the LODs of all chunks, whichever were asked for:
  /// tells another volume and other options that shape its surface apart. Empty: unknown.
  std::string surface;
  std::vector<ChunkEntry> chunks;  ///< sorted by index

  /// The place of a chunk in `chunks`, or -1.
  [[nodiscard]] TUFA_API std::ptrdiff_t find(const Coord& index) const;
  /// The place of the chunk beyond a face, 0 to 5, of a chunk, or -1. Throws Error(InvalidArgument)
  /// if there is no such face or chunk.
  [[nodiscard]] TUFA_API std::ptrdiff_t neighbour(std::size_t chunk, int face) const;
};

}  // namespace tufa
