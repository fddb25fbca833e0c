// Raw stacks to sparse grids.

#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <tufa/import.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/job.h"
#include "base/known_enum.h"
#include "base/number_text.h"
#include "io/grid/raw_slices.h"

namespace tufa {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr std::int64_t kDim = Leaf::DIM;

constexpr std::array<std::string_view, 4> kTypes{"u8", "u16", "i16", "f32"};

void requireUsable(const RawImport& options) {
  constexpr std::int64_t kMost = 1000000;
  base::requireKnown(options.type, RawType::F32, "the type of values");
  for (const std::int64_t side : options.size) {
    if (side >= 1 && side <= kMost) continue;
    throw Error(ErrorCode::InvalidArgument, "the image must have 1 to " + std::to_string(kMost) +
                                                " voxels along each axis, not " +
                                                std::to_string(side));
  }
  constexpr double kShortest = 1e-4;
  constexpr double kLongest = 1e20;
  for (const double spacing : options.spacing) {
    if (spacing >= kShortest && spacing <= kLongest) continue;
    throw Error(ErrorCode::InvalidArgument, "spacing must be from " + base::numberText(kShortest) +
                                                " to " + base::numberText(kLongest) + ", not " +
                                                base::numberText(spacing));
  }
  for (const double x : {options.origin.x, options.origin.y, options.origin.z}) {
    if (std::abs(x) <= kLongest) continue;
    throw Error(ErrorCode::InvalidArgument, "the origin must lie within " +
                                                base::numberText(kLongest) + ", not at " +
                                                base::numberText(x));
  }
  if (options.threshold && !std::isfinite(*options.threshold)) {
    throw Error(ErrorCode::InvalidArgument, "the threshold must be finite");
  }
}

/// Calls visit(first slice, values) for all slices, a row of blocks at a time.
template <class Visit>
void forLayers(io::RawSlices& slices, const RawImport& options, base::Job& job,
               const Visit& visit) {
  std::vector<float> values;
  const auto area = static_cast<std::size_t>(options.size[0] * options.size[1]);
  for (std::int64_t z = 0; z < options.size[2]; z += kDim) {
    const std::int64_t count = std::min<std::int64_t>(kDim, options.size[2] - z);
    job.checkCancelled(static_cast<std::size_t>(z), static_cast<std::size_t>(options.size[2]));
    values.resize(area * static_cast<std::size_t>(count));
    slices.read(values);
    visit(z, values);
  }
}

float leastOf(io::RawSlices& slices, const RawImport& options, base::Job& job) {
  float least = std::numeric_limits<float>::infinity();
  forLayers(slices, options, job, [&](std::int64_t, const std::vector<float>& values) {
    for (const float value : values) {
      if (value < least) least = value;
    }
  });
  slices.rewind();
  return std::isfinite(least) ? least : 0;
}

/// The block at (x, y) of a row of them, if any of its voxels is above the threshold.
std::unique_ptr<Leaf> leafAt(const RawImport& options, const std::vector<float>& values,
                             const openvdb::Coord& origin, float threshold) {
  auto leaf = std::make_unique<Leaf>(origin, threshold);
  const std::int64_t width = options.size[0];
  const std::int64_t area = width * options.size[1];
  const std::int64_t ends[3] = {std::min(options.size[0] - origin.x(), kDim),
                                std::min(options.size[1] - origin.y(), kDim),
                                std::min(options.size[2] - origin.z(), kDim)};
  for (std::int64_t z = 0; z < ends[2]; ++z) {
    for (std::int64_t y = 0; y < ends[1]; ++y) {
      const std::int64_t row = z * area + (origin.y() + y) * width + origin.x();
      for (std::int64_t x = 0; x < ends[0]; ++x) {
        const float value = values[static_cast<std::size_t>(row + x)];
        if (!(value > threshold)) continue;
        leaf->setValueOn(
            openvdb::Coord(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)), value);
      }
    }
  }
  return leaf->isEmpty() ? nullptr : std::move(leaf);
}

}  // namespace

std::optional<RawType> rawTypeByName(std::string_view name) {
  for (std::size_t n = 0; n < kTypes.size(); ++n) {
    if (kTypes[n] == name) return static_cast<RawType>(n);
  }
  return std::nullopt;
}

std::shared_ptr<openvdb::GridBase> importRaw(const std::vector<std::filesystem::path>& files,
                                             const RawImport& options) {
  requireUsable(options);
  openvdb::initialize();
  io::RawSlices slices(files, options);
  base::Job job(options.threads, options.progress);
  float threshold = 0;
  if (options.threshold) {
    threshold = static_cast<float>(*options.threshold);
  } else {
    job.beginStage("looking for the background", 0.3);
    threshold = leastOf(slices, options, job);
  }
  auto grid = openvdb::FloatGrid::create(threshold);
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  transform->postScale({options.spacing[0], options.spacing[1], options.spacing[2]});
  transform->postTranslate({options.origin.x, options.origin.y, options.origin.z});
  grid->setTransform(transform);
  grid->setName("image");

  job.beginStage("importing", 1);
  const auto columns = static_cast<std::size_t>((options.size[0] + kDim - 1) / kDim);
  const auto rows = static_cast<std::size_t>((options.size[1] + kDim - 1) / kDim);
  std::vector<std::unique_ptr<Leaf>> leaves(columns * rows);
  forLayers(slices, options, job, [&](std::int64_t z, const std::vector<float>& values) {
    base::runWithThreads(options.threads, [&] {
      constexpr std::size_t kGrain = 16;
      base::runRanges(leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
          const openvdb::Coord origin(static_cast<int>(n % columns * kDim),
                                      static_cast<int>(n / columns * kDim), static_cast<int>(z));
          leaves[n] = leafAt(options, values, origin, threshold);
        }
      });
    });
    for (auto& leaf : leaves) {
      if (leaf) grid->tree().addLeaf(leaf.release());
    }
  });
  job.run([&] { openvdb::tools::prune(grid->tree()); });
  job.finish();
  return grid;
}

}  // namespace tufa
