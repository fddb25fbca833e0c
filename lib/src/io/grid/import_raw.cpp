// Raw stacks to sparse grids.

#include <tufa/import.h>

#include <tufa/error.h>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/known_enum.h"
#include "base/number_text.h"
#include "io/grid/raw_slices.h"

namespace tufa {
namespace {

constexpr std::array<std::string_view, 4> kTypes{"u8", "u16", "i16", "f32"};

}  // namespace

std::optional<RawType> rawTypeByName(std::string_view name) {
  for (std::size_t n = 0; n < kTypes.size(); ++n) {
    if (kTypes[n] == name) return static_cast<RawType>(n);
  }
  return std::nullopt;
}

std::shared_ptr<openvdb::GridBase> importRaw(const std::vector<std::filesystem::path>& files,
                                             const RawImport& options) {
  base::requireKnown(options.type, RawType::F32, "the type of values");
  for (const double length : options.spacing) {
    if (length > 0) continue;
    throw Error(ErrorCode::InvalidArgument,
                "the spacing must be above 0, not " + base::numberText(length));
  }
  ImageSlices image;
  image.size = options.size;
  image.steps = {Position(options.spacing[0], 0, 0), Position(0, options.spacing[1], 0),
                 Position(0, 0, options.spacing[2])};
  image.origin = options.origin;
  io::RawSlices slices(files, options);
  image.read = [&](std::int64_t first, std::int64_t /*count*/, std::vector<float>& values) {
    if (first == 0) slices.rewind();
    slices.read(values);
  };
  SliceOptions sliceOptions;
  sliceOptions.threshold = options.threshold;
  sliceOptions.labels = options.labels;
  sliceOptions.distances = options.distances;
  sliceOptions.threads = options.threads;
  sliceOptions.progress = options.progress;
  return importSlices(image, sliceOptions);
}

}  // namespace tufa
