#pragma once

#include <tufa/export.h>
#include <tufa/fwd.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tufa {

namespace base {
class LeafSource;
}

/// What a .vdb file tells about one grid.
struct GridInfo {
  std::string name;                 ///< empty if it has none
  std::string valueType;            ///< "float", "double", "vec3s", ...
  std::string gridClass;            ///< "level set", "fog volume", "unknown", ...
  std::string transform;            ///< "uniform scale", "affine", "frustum", ...
  double voxelSize[3] = {0, 0, 0};  ///< world length of a voxel's edges
  std::size_t activeVoxels = 0;     ///< those of active tiles included
  std::size_t leaves = 0;           ///< leaf nodes of 8^3 voxels
  std::size_t tiles = 0;            ///< active tiles
  std::size_t memoryBytes = 0;      ///< of the grid's tree
  int boundsMin[3] = {0, 0, 0};     ///< first index of the active voxels' bounding box
  int boundsMax[3] = {0, 0, 0};     ///< last index of it
  /// Value where the tree holds none; NaN in grids that are neither of float nor of double.
  double background = std::numeric_limits<double>::quiet_NaN();
  std::optional<double> minValue;   ///< of the active values that are finite
  std::optional<double> maxValue;   ///< of the active values that are finite
  std::size_t nonFiniteValues = 0;  ///< NaN or infinite active values
  bool meshable = false;            ///< contour() takes it
  std::string whyNot;               ///< if not, the reason
  /// What else its maker has noted, as names and values, sorted by name. Without what is told above
  /// and what OpenVDB counts when it writes a file.
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// Describes a grid.
[[nodiscard]] TUFA_API GridInfo describeGrid(const openvdb::GridBase& grid);

/// Describes every grid of a .vdb file. Throws Error(UnreadableFile).
[[nodiscard]] TUFA_API std::vector<GridInfo> describeGrids(const std::filesystem::path& path);

/// A grid of a .vdb file.
struct GridName {
  std::string name;       ///< grids of the same name are told apart as "name[0]", "name[1]", ...
  bool meshable = false;  ///< contour() takes it; whether it has active voxels is not known yet
};

/// Lists every grid of a .vdb file, in the order of the file, without reading any values. Throws
/// Error(UnreadableFile).
[[nodiscard]] TUFA_API std::vector<GridName> listGrids(const std::filesystem::path& path);

/// Reads one grid of a .vdb file: by name, or, without one, the first level set that can be meshed,
/// else the first grid that can be meshed. Throws Error: UnreadableFile, UnknownGrid (the message
/// lists the names there are), UnsupportedGrid (nothing in the file can be meshed, or the transform
/// of the grid of that name is out of range). Grids of points, which cannot be meshed, come with
/// their active voxels but without the points.
[[nodiscard]] TUFA_API std::shared_ptr<openvdb::GridBase> readGrid(
    const std::filesystem::path& path, const std::optional<std::string>& name = {});

/// One grid of a .vdb file whose values stay in the file until they are needed, for work on volumes
/// that are larger than memory: see buildChunks(). The file must not change meanwhile.
class TUFA_API GridFile {
 public:
  /// Opens a grid, which is chosen as by readGrid(), and throws as that does. Where leaves cannot
  /// be read one by one, the grid is read as a whole: of a .nvdb, of a .vdb without offsets or of
  /// before 2013, where grids share a tree, and where values are neither floats nor doubles.
  explicit GridFile(const std::filesystem::path& path, const std::optional<std::string>& name = {});
  /// The bytes must outlive the object.
  explicit GridFile(const FileBytes& file, const std::optional<std::string>& name = {});
  /// What was moved from may only be assigned to or destroyed.
  GridFile(GridFile&&) noexcept;
  GridFile& operator=(GridFile&&) noexcept;  ///< the same
  ~GridFile();

  /// The grid: metadata, transform, tiles and which voxels are active. Leaves have their values
  /// only if isLoaded().
  [[nodiscard]] std::shared_ptr<const openvdb::GridBase> outline() const;
  /// Whether all values are in memory.
  [[nodiscard]] bool isLoaded() const;
  /// The whole grid, read unless it has been. Throws Error(UnreadableFile).
  std::shared_ptr<openvdb::GridBase> load();

  /// For the library itself: what reads values; null if isLoaded().
  [[nodiscard]] base::LeafSource* leaves();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes grids to a .vdb file, whole or not at all. Throws Error(UnwritableFile).
TUFA_API void writeGrids(const std::vector<std::shared_ptr<const openvdb::GridBase>>& grids,
                         const std::filesystem::path& path);

}  // namespace tufa
