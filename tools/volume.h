#pragma once

#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/io.h>
#include <tufa/openvdb_fwd.h>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tufa::tools {

// What the commands that mesh a volume share.

/// Declares the options for where the surface of a volume lies and how its finest mesh is made; the
/// isovalue as text, for readIsovalue(). `methods`: whether other methods than the dual one may
/// take them.
void addContourOptions(CLI::App& app, ContourOptions& options, std::optional<std::string>& isovalue,
                       bool methods = false);

/// Declares `--up` and `--scale`, for formats that say what is up and how long a metre is.
void addFrameOptions(CLI::App& app, UpAxis& up, double& scale,
                     const std::string& formats = ".glb, .usda and .3mf");

/// Declares `--quantize` and `--compress`, for .glb.
void addCompressionOptions(CLI::App& app, GlbCompression& compression);

/// Says on standard error that something could not be quantized.
void noteFloats(const std::string& what);

/// Says on standard error that single precision has moved vertices, world units, by more than a
/// hundredth of a voxel.
void noteRounding(double rounding, double voxelSize);

/// Declares `--nan` alone.
void addNonFiniteOption(CLI::App& app, NonFinite& nonFinite);

/// Declares `--inside` alone.
void addInsideOption(CLI::App& app, Inside& inside);

/// Declares `--iso` alone.
CLI::Option* addIsovalueOption(CLI::App& app, std::optional<std::string>& isovalue);

/// What `--iso` says: a number, or "auto" for what the library chooses. Throws
/// Error(InvalidArgument) for any other text, and for none if the grid is a fog volume: half way
/// between its least and its greatest value is another surface in every frame of a sequence.
[[nodiscard]] std::optional<double> readIsovalue(const std::optional<std::string>& text,
                                                 const openvdb::GridBase& grid,
                                                 const std::string& file);

/// Whether that message will be thrown, for which the grid's values must be in memory.
[[nodiscard]] bool lacksIsovalue(const std::optional<std::string>& text,
                                 const openvdb::GridBase& grid);

/// Says on standard error which isovalue was chosen, where that depends on the data.
void noteIsovalue(const std::optional<std::string>& text, const openvdb::GridBase& grid,
                  double isovalue);

/// What to do about a name or pattern that means no grid, where others do.
enum class Lacking { Refuse, Skip };

/// The grids of a file that some names and patterns mean, in the order of the file; patterns, with
/// * and ?, mean those that can be meshed only. Throws Error(UnknownGrid) if there are none, and if
/// one that is lacking is to be refused.
[[nodiscard]] std::vector<std::string> chooseGrids(const std::string& file,
                                                   const std::vector<std::string>& patterns,
                                                   Lacking lacking = Lacking::Refuse);

/// Says on standard error that a grid was taken because none was named, if there was a choice.
void noteChoice(const std::string& file, const std::string& grid);

/// Throws Error(InvalidArgument) that names the option if OpenVDB takes no voxels of that size.
void requireVoxelSize(const std::string& option, double size);

/// A distance as text has it.
struct Length {
  double value = 0;
  bool world = false;  ///< in world units, else in voxels
};

/// "0.1" is in voxels, "0.1w" or "0.1W" in world units; nothing for any other text.
[[nodiscard]] std::optional<Length> lengthIn(const std::string& text);

[[nodiscard]] bool isLevelSet(const openvdb::GridBase& grid);

/// The cube root of a voxel's volume, in world units.
[[nodiscard]] double voxelSizeOf(const openvdb::GridBase& grid);

/// "0.1" is in voxels, "0.1w" or "0.1W" in world units; gives voxels. `option` is for the message.
[[nodiscard]] double readTolerance(const std::string& option, const std::string& text,
                                   const openvdb::GridBase& grid);

/// readGrid(), GridFile, GridFile::load() and describeGrids(), under a CrashGuard: the only ways to
/// the volumes of a file.
[[nodiscard]] std::shared_ptr<openvdb::GridBase> readVolume(const std::string& file,
                                                            const std::optional<std::string>& name);
[[nodiscard]] GridFile openVolume(const std::string& file, const std::optional<std::string>& name);
[[nodiscard]] std::shared_ptr<openvdb::GridBase> loadVolume(GridFile& volume,
                                                            const std::string& file);
[[nodiscard]] std::vector<GridInfo> describeVolumes(const std::string& file);

/// Whether a grid holds integers, whose labels are meshed one by one.
[[nodiscard]] bool holdsLabels(const GridInfo& info);

/// readVolume() for a grid that multiplies the tolerance. Throws Error(UnsupportedGrid) if its
/// values are no floats: contour() would find that only after much work.
[[nodiscard]] std::shared_ptr<const openvdb::GridBase> readToleranceGrid(const std::string& file,
                                                                         const std::string& name);

/// The grid's name, empty if it has none.
[[nodiscard]] std::string nameOf(const openvdb::GridBase& grid);

/// Throws Error(UnsupportedGrid) if the grid has no active voxels.
void requireVoxels(const openvdb::GridBase& grid, const std::string& file);

/// Throws Error(UnsupportedGrid) with the grid's range of values if its mesh is empty. `filters`:
/// what the grid of the file went through, as FilterRun::text() has it.
void requireSurface(const Mesh& mesh, double isovalue, const openvdb::GridBase& grid,
                    const std::string& file, const std::string& filters = {});

/// Prints what the user should know about the data to standard error. That the surface is open,
/// only if a mesh is given that is: where grids are clipped, data may end beside a surface that is
/// whole.
void noteData(const ContourReport& report, const Mesh* mesh = nullptr);

/// Prints to standard error in what a mesh, named by `what`, is not watertight.
void noteBroken(const CheckReport& check, const ContourReport& report, const std::string& what);

/// Seconds that some work takes.
template <class Work>
double timed(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace tufa::tools
