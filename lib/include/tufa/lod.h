#pragma once

#include <tufa/contour.h>
#include <tufa/export.h>
#include <tufa/io.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace tufa {

/// Options of buildLods().
struct LodOptions {
  /// How the surface is read and LOD 0 is made. `tolerance` is that of LOD 0; `uniform` is ignored.
  ContourOptions contour;
  int levels = 5;     ///< LODs at most, 1 to 100
  double factor = 4;  ///< each LOD's tolerance over that of the LOD before; above 1, to 10^6
  /// Tolerances of all LODs in voxels, rising, in place of `levels` and `factor`.
  std::vector<double> tolerances;
  /// Most triangles of each LOD, falling, in place of tolerances: each LOD has as many, or up to 5
  /// % fewer, and reports the resulting error. LOD 0 has no more than the uniform mesh. Needs edge
  /// collapse: `contour.simplify`, and no bounds on cells or angles.
  std::vector<std::size_t> triangles;
  /// An LOD may be made without connected components of the surface, closed cavities among them,
  /// that fit into a box whose diagonal is its tolerance, but never without the one of most
  /// vertices. Handles and tunnels stay. For a number of triangles that is otherwise out of reach,
  /// larger components are left out too, the smallest first; the LOD's tolerance shows it.
  bool allowTopologyChange = false;
  /// The projected error, in pixels, at which an LOD may be drawn; see Lod::screenCoverage.
  double pixelError = 1;
  int screenHeight = 1080;  ///< pixels, for Lod::screenCoverage
};

/// A connected component of the surface that an LOD was made without.
struct DroppedComponent {
  Position centre{0, 0, 0};  ///< of its bounding box, world space
  double sizeVoxels = 0;     ///< diagonal of that box
};

/// One level of detail.
struct Lod {
  Mesh mesh;                ///< world space
  double tolerance = 0;     ///< voxels; if triangles were asked for, the resulting largest error
  Certificate certificate;  ///< distance to the uniform mesh of the grid, without what was dropped
  /// Components that the LOD before still has, see LodOptions::allowTopologyChange.
  std::vector<DroppedComponent> dropped;
  /// Draw this LOD while the model's bounding sphere covers at least this share of the screen's
  /// height; below, the next LOD's error is no more than LodOptions::pixelError. 0 for the last.
  double screenCoverage = 0;
  std::size_t intersectionsLeft = 0;  ///< pairs of polygons that intersect
  double seconds = 0;                 ///< wall clock, without what all LODs share
};

/// Levels of detail of one surface. All have the topology of the uniform mesh, apart from
/// components that were dropped; errors rise and triangles fall from LOD to LOD.
struct LodChain {
  std::vector<Lod> levels;   ///< the finest first; none without a surface
  double voxelSize = 1;      ///< world units: the cube root of a voxel's volume
  Position centre{0, 0, 0};  ///< of the bounding sphere of LOD 0
  double radius = 0;         ///< of that sphere, world units
  double sharedSeconds = 0;  ///< wall clock of what all LODs share: reading, uniform mesh, clusters
  /// Why there are fewer LODs of a surface than asked for; empty if there are not. A number of
  /// triangles that the LOD before does not exceed is left out; one that is out of reach ends the
  /// chain. A tolerance is left out where the LOD would not have fewer triangles than the one
  /// before by as much as is worth the error: three in ten at four times the tolerance or more,
  /// less at less. The first of these ends a chain by `LodOptions::factor` without
  /// `allowTopologyChange`, as what is left is needed for the topology; otherwise later tolerances
  /// are tried. And no tolerance is above 10^6.
  std::string stopped;
};

/// A camera that looks at a model.
struct Camera {
  Position eye{0, 0, 0};            ///< world space
  double verticalAngle = 0.785398;  ///< of view, radians, above 0 and below pi
  int screenHeight = 1080;          ///< pixels, above 0
};

/// Makes levels of detail of the surface of `grid`, which is read once: the first is the mesh of
/// contour(), each other one comes from the one before by collapsing edges or, where
/// `contour.simplify` and the bounds on cells rule that out, is another cut of the same cluster
/// forest. See contour() for what each mesh keeps, and for the errors thrown; throws
/// Error(InvalidArgument) for options out of their range too.
[[nodiscard]] TUFA_API LodChain buildLods(const openvdb::GridBase& grid,
                                          const LodOptions& options = {},
                                          ContourReport* report = nullptr);

/// The coarsest LOD whose certified error covers at most `pixelError` pixels; 0 if there is none.
/// Throws Error(InvalidArgument) for a camera or a number of pixels that cannot be.
[[nodiscard]] TUFA_API std::size_t selectLod(const LodChain& chain, const Camera& camera,
                                             double pixelError = 1);

/// Options of writeLods(). `allLevelsScene` and `compression` are for .glb only, `up` and `scale`
/// for .glb, .usda and .3mf.
struct LodWriteOptions {
  std::string name = "mesh";  ///< of nodes and meshes: NAME_LOD0, NAME_LOD1, ...
  /// .glb, .obj and .usda: normals are split where those of two faces at an edge differ by more
  /// than this angle: degrees, 0 to 180; 180 splits none. In .glb the vertices there become
  /// several.
  double creaseAngle = 40;
  /// A second scene of all LODs, NAME_all_levels, for programs that find LODs by their names.
  /// Without it the nodes of coarser LODs stand in no scene, and MSFT_lod alone leads to them.
  bool allLevelsScene = false;
  UpAxis up = UpAxis::Y;  ///< of the volume
  double scale = 1;       ///< metres in a world unit; above 0
  /// No vertices are joined: an LOD in which rounding to 16 bits would bring two to one place, or
  /// three on a line, is stored in floats.
  GlbCompression compression = GlbCompression::None;
  int threads = 0;    ///< most threads; 0: as many as the TBB arena allows. Never changes the file.
  Progress progress;  ///< called from the calling thread; may cancel
};

/// What writeLods() wrote.
struct LodWriteReport {
  std::vector<std::filesystem::path> files;  ///< one, or one for each LOD
  /// Vertices of each LOD; in a .glb, with those that creases add.
  std::vector<std::size_t> vertices;
  std::vector<std::size_t> floatLevels;  ///< LODs that could not be quantized
  double rounding = 0;                   ///< see WriteReport::rounding
};

/// The file of an LOD: `path` with braces {} in its file name replaced by the LOD's number, or
/// `path` itself if it has none.
[[nodiscard]] TUFA_API std::filesystem::path lodFile(const std::filesystem::path& path,
                                                     std::size_t level);

/// Writes all LODs to one .glb: nodes and meshes NAME_LOD0, NAME_LOD1, ..., of which the first has
/// the extension MSFT_lod and alone stands in the default scene, so that programs that know nothing
/// of LODs show the finest. Each node's `extras` hold its errors and counts. Triangles are ordered
/// for the vertex cache, vertices by their first use.
///
/// A .usda has the LODs as a variant set, LOD, of which LOD0 is chosen.
///
/// A file name with braces makes one file for each LOD, see lodFile(), of any format that write()
/// has; other than .glb, they are in world units as write() makes them. Without LODs that is an
/// empty mesh as level 0.
///
/// Each file appears whole or not at all. Throws Error: UnwritableFile, InvalidArgument (an option
/// out of its range, one file of a format without LODs), LimitExceeded (more than the format can
/// hold, or than single precision does, as in write()), Cancelled.
TUFA_API void writeLods(const LodChain& chain, const std::filesystem::path& path,
                        const LodWriteOptions& options = {}, LodWriteReport* report = nullptr);

}  // namespace tufa
