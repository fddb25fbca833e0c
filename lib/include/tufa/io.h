#pragma once

#include <tufa/export.h>
#include <tufa/grid_files.h>
#include <tufa/mesh.h>
#include <tufa/progress.h>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tufa {

/// The formats of meshes that Tufa reads and writes.
enum class MeshFormat {
  Ply,   ///< .ply: binary when written
  Obj,   ///< .obj
  Stl,   ///< .stl: binary when written
  Off,   ///< .off
  Glb,   ///< .glb: binary glTF 2.0
  Usda,  ///< .usda: OpenUSD as text; written only
  /// .3mf, for printing: a mesh of triangles in a unit of length, z up; written only, and where
  /// Tufa was built with lib3mf, see hasFormat().
  ThreeMf,
};

/// The axis of the volume that points up. In glTF it is y: a volume with z up is rotated. .usda
/// says which it is.
enum class UpAxis {
  Y,  ///< as in Houdini and glTF
  Z,  ///< as in Blender
};

/// How a .glb stores vertices and indices.
enum class GlbCompression {
  None,       ///< positions and normals as floats: every program reads that
  Quantized,  ///< positions in 16 bits, normals in 8: KHR_mesh_quantization
  Meshopt,    ///< the same, and packed: EXT_meshopt_compression
};

/// The names of the formats in the order of MeshFormat: "ply", "obj", and so on.
[[nodiscard]] TUFA_API std::span<const std::string_view> meshFormatNames();

/// Whether this build of Tufa writes a format: all of them but, without lib3mf, .3mf.
[[nodiscard]] TUFA_API bool hasFormat(MeshFormat format);

/// The format that a file name's ending says, in either case of letters. Throws
/// Error(InvalidArgument) if it says none.
[[nodiscard]] TUFA_API MeshFormat meshFormatOf(const std::filesystem::path& path);

/// Options of write().
struct WriteOptions {
  std::string name = "mesh";  ///< of the object inside formats that name objects (.obj, .glb)
  /// .glb, .obj and .usda: where the normals of two faces at an edge differ by more than this
  /// angle, each side keeps a normal of its own; so do sides that turn by more than twice the angle
  /// over small faces between. In .glb, which has one normal a vertex, the vertices there become
  /// several at one position. A normal that is more than half this angle off the faces around it
  /// gives way to theirs. Degrees, 0 to 180; 180, or a mesh without normals, splits and changes
  /// none.
  double creaseAngle = 40;
  UpAxis up = UpAxis::Y;  ///< .glb, .usda and .3mf: of the volume
  double scale = 1;       ///< .glb, .usda and .3mf: metres in a world unit; above 0
  /// .glb: all meshes of a file in one grid. No vertices are joined: a mesh in which rounding to 16
  /// bits would bring two to one place, or three on a line, is stored in floats.
  GlbCompression compression = GlbCompression::None;
  int threads = 0;    ///< most threads; 0: as many as the TBB arena allows. Never changes the file.
  Progress progress;  ///< called from the calling thread; may cancel
};

/// What write() and writeMeshes() wrote.
struct WriteReport {
  std::vector<std::string> floatMeshes;  ///< names of those that could not be quantized
  /// How far a position was moved at most where a format stores floats (.stl, .glb without
  /// compression or where floatMeshes are, .usda), world units: what errors may be larger by.
  double rounding = 0;
};

/// A mesh and its name in a file.
struct NamedMesh {
  std::string name;  ///< of the node in .glb, of the object in .obj, of the prim in .usda
  Mesh mesh;         ///< world space
};

/// Writes a mesh in the format that the file name's ending says: .ply (binary), .obj, .stl
/// (binary), .off, .glb, .usda (text) or .3mf. Quads stay quads in .ply, .obj and .off, and in
/// .usda where no normals are split. Attributes go into .ply, .glb and .usda.
///
/// .ply, .obj and .off keep double precision if some position needs it (contour() rounds to single
/// where that does no harm); .glb and .usda then store positions relative to a translation; .stl is
/// single precision always, and so is .3mf, to a millionth of a millimetre, or of a micrometre
/// where a world unit is shorter than a hundredth of a millimetre. The file appears whole or not at
/// all: it is written under a temporary name in the same folder and renamed. A pipe or a device is
/// written to as it is, as .ply if it has no ending.
///
/// Throws Error: UnwritableFile, InvalidArgument (unknown ending, an option out of its range),
/// LimitExceeded (more than the format can hold; positions that no float is near, but for .ply,
/// .obj and .off; an .stl, .glb or .usda whose single precision turns triangles over, or moves
/// positions by more than a twentieth of an edge in the mean), Cancelled.
TUFA_API void write(const Mesh& mesh, const std::filesystem::path& path,
                    const WriteOptions& options = {}, WriteReport* report = nullptr);

/// Writes several meshes to one file: .glb, a node each, .obj and .3mf, an object each, or .usda, a
/// prim each. Their names are used in place of WriteOptions::name. Otherwise as write(); throws
/// Error(InvalidArgument) for formats that hold one mesh only.
TUFA_API void writeMeshes(const std::vector<NamedMesh>& meshes, const std::filesystem::path& path,
                          const WriteOptions& options = {}, WriteReport* report = nullptr);

/// Throws Error(InvalidArgument) if write() knows no format of this ending.
TUFA_API void requireMeshEnding(const std::filesystem::path& path);

/// Throws Error(UnwritableFile) if it is certain already that write() or writeGrids() could not
/// write there: for programs that work for long before they write. A full disk shows only later.
TUFA_API void requireWritable(const std::filesystem::path& path);

/// Reads a mesh: .ply (text or binary), .obj, .stl (text or binary), .off or .glb. Polygons with
/// more than four corners are fanned; vertices at equal positions are shared in .stl and, where
/// normals or the like could have split them, in .glb. Of a .glb with levels of detail the finest
/// is read. Throws Error: UnreadableFile with the place where reading failed, InvalidArgument
/// (unknown ending).
[[nodiscard]] TUFA_API Mesh readMesh(const std::filesystem::path& path);

/// Writes bytes, such as a report beside a mesh, as write() writes meshes: whole or not at all, and
/// directly to a pipe or a device. Throws Error(UnwritableFile).
TUFA_API void writeFile(std::string_view bytes, const std::filesystem::path& path);

/// The same, of what `writeTo` puts into a stream. What it throws passes through, and leaves no
/// file; the stream throws Error where writing fails, and a stream that has failed otherwise when
/// `writeTo` returns makes no file either, so that its state need not be asked.
TUFA_API void writeFile(const std::function<void(std::ostream&)>& writeTo,
                        const std::filesystem::path& path);

}  // namespace tufa
