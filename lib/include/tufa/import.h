#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tufa {

/// How a raw image holds a value.
enum class RawType {
  U8,   ///< unsigned, a byte
  U16,  ///< unsigned, two bytes
  I16,  ///< signed, two bytes
  F32,  ///< IEEE single precision
};

/// What a raw stack does not say of itself, and options of importRaw().
struct RawImport {
  std::array<std::int64_t, 3> size{};  ///< voxels along x, y and z: 1 to a million each
  RawType type = RawType::U8;          ///< of all values
  bool bigEndian = false;              ///< which byte of a value comes first
  std::uint64_t headerBytes = 0;       ///< at the beginning of each file, left out
  /// World units between voxels along x, y and z: 10^-4 to 10^20.
  std::array<double, 3> spacing{1, 1, 1};
  Position origin{0, 0, 0};         ///< of the first voxel, world units
  std::optional<double> threshold;  ///< as SliceOptions::threshold
  bool labels = false;              ///< as SliceOptions::labels
  bool distances = false;           ///< as SliceOptions::distances
  int threads = 0;                  ///< most threads; 0: all. Never changes the result.
  Progress progress;                ///< called from the calling thread; may cancel
};

/// An image of three dimensions, slice by slice, from whatever reads it.
struct ImageSlices {
  std::array<std::int64_t, 3> size{};  ///< voxels along x, y and z: 1 to a million each
  /// From a voxel to the next along x, y and z, world units: spacing, 10^-4 to 10^20, times
  /// direction.
  std::array<Position, 3> steps{Position(1, 0, 0), Position(0, 1, 0), Position(0, 0, 1)};
  Position origin{0, 0, 0};  ///< of the first voxel, world units
  /// Fills in the values of `count` slices from `first` on, x running fastest, then y: the vector
  /// has room for just so many. Called from the calling thread, from the first slice to the last,
  /// and once more from the first where the background has to be found.
  std::function<void(std::int64_t first, std::int64_t count, std::vector<float>& values)> read;
};

/// Options of importSlices().
struct SliceOptions {
  /// Values up to it are background; of distances, values from it on, above 0. Unset: the least
  /// value, of distances the greatest. Not for labels.
  std::optional<double> threshold = {};
  /// The values name things: an Int32 grid of the name "labels", in which 0 is background.
  bool labels = false;
  /// The values are signed distances in world units, below 0 inside: a level set of the name
  /// "surface". Not with labels.
  bool distances = false;
  int threads = 0;         ///< most threads; 0: all. Never changes the result.
  Progress progress = {};  ///< called from the calling thread; may cancel
};

/// Makes a sparse grid of an image, eight slices at a time: of floats as importRaw() does, or of
/// labels. Throws Error: InvalidArgument (size, steps, origin, threshold), UnreadableFile (labels
/// that are not whole, or beyond 2^24; distances of which none is above 0), Cancelled, and what
/// `read` throws.
[[nodiscard]] TUFA_API std::shared_ptr<openvdb::GridBase> importSlices(
    const ImageSlices& image, const SliceOptions& options = {});

/// The type of that name ("u8", "u16", "i16" or "f32"), if there is one.
[[nodiscard]] TUFA_API std::optional<RawType> rawTypeByName(std::string_view name);

/// Reads an image of which the values lie one after the other in one or more files, x running
/// fastest, then y. Voxels above the threshold are active in the float grid that it makes; the
/// others have the threshold's value, and so has all beyond the image; of distances those below it
/// are active. NaN is background. Only eight slices and the grid are in memory. Throws Error:
/// InvalidArgument (size, spacing, origin), UnreadableFile (files that do not hold just so many
/// values), Cancelled.
[[nodiscard]] TUFA_API std::shared_ptr<openvdb::GridBase> importRaw(
    const std::vector<std::filesystem::path>& files, const RawImport& options);

}  // namespace tufa
