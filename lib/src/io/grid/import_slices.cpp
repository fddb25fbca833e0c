// Images, slice by slice, to sparse grids.

#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <tufa/import.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/job.h"
#include "base/number_text.h"
#include "base/vec3.h"
#include "io/grid/raw_slices.h"

namespace tufa {
namespace {

constexpr std::int64_t kDim = openvdb::FloatTree::LeafNodeType::DIM;
static_assert(openvdb::Int32Tree::LeafNodeType::DIM == kDim);

void requireUsable(const ImageSlices& image, const SliceOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::InvalidArgument, what);
  };
  io::requireImageSize(image.size);
  if (!image.read) {
    throw Error(ErrorCode::InvalidArgument, "the image has no function that reads its slices");
  }
  constexpr double kShortest = 1e-4;
  constexpr double kLongest = 1e20;
  double volume = 1;
  for (const Position& step : image.steps) {
    const double spacing = Vec3(step).length();
    volume *= spacing;
    if (spacing >= kShortest && spacing <= kLongest) continue;
    refuse("spacing must be from " + base::numberText(kShortest) + " to " +
           base::numberText(kLongest) + ", not " + base::numberText(spacing));
  }
  constexpr double kFlattest = 1e-3;
  const double spanned = Vec3(image.steps[0]).dot(Vec3(image.steps[1]).cross(Vec3(image.steps[2])));
  if (!(std::abs(spanned) > kFlattest * volume)) {
    refuse("the axes of the image must not lie in a plane");
  }
  for (const double x : {image.origin.x, image.origin.y, image.origin.z}) {
    if (std::abs(x) <= kLongest) continue;
    refuse("the origin must lie within " + base::numberText(kLongest) + ", not at " +
           base::numberText(x));
  }
  if (options.threshold && !std::isfinite(static_cast<float>(*options.threshold))) {
    refuse("the threshold must be finite in single precision");
  }
  if (options.threshold && options.labels) refuse("labels have no threshold: 0 is background");
  if (options.distances && options.labels) refuse("values are labels or distances, not both");
  if (options.distances && options.threshold && !(static_cast<float>(*options.threshold) > 0)) {
    refuse("the threshold of distances must be above 0, not " +
           base::numberText(*options.threshold));
  }
}

openvdb::math::Transform::Ptr transformOf(const ImageSlices& image) {
  const auto& [x, y, z] = image.steps;
  const bool alongAxes = x.y == 0 && x.z == 0 && y.x == 0 && y.z == 0 && z.x == 0 && z.y == 0;
  if (alongAxes && x.x > 0 && y.y > 0 && z.z > 0) {
    auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    transform->postScale({x.x, y.y, z.z});
    transform->postTranslate({image.origin.x, image.origin.y, image.origin.z});
    return transform;
  }
  return openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4R(x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, image.origin.x,
                     image.origin.y, image.origin.z, 1.0));
}

/// Calls visit(first slice, values) for all slices, a row of blocks at a time.
template <class Visit>
void forLayers(const ImageSlices& image, base::Job& job, const Visit& visit) {
  std::vector<float> values;
  const auto area = static_cast<std::size_t>(image.size[0] * image.size[1]);
  for (std::int64_t z = 0; z < image.size[2]; z += kDim) {
    const std::int64_t count = std::min(kDim, image.size[2] - z);
    job.checkCancelled(static_cast<std::size_t>(z), static_cast<std::size_t>(image.size[2]));
    const std::size_t size = area * static_cast<std::size_t>(count);
    values.resize(size);
    image.read(z, count, values);
    if (values.size() != size) {
      throw Error(ErrorCode::InvalidArgument,
                  "the reader of slices must fill the values that it is given, " +
                      std::to_string(size) + ", and not resize them to " +
                      std::to_string(values.size()));
    }
    visit(z, values);
  }
}

/// The first of all values in an order, or 0 if there is none that is finite.
template <class Before>
float firstOf(const ImageSlices& image, base::Job& job, const Before& before) {
  std::optional<float> first;
  forLayers(image, job, [&](std::int64_t, const std::vector<float>& values) {
    for (const float value : values) {
      if (std::isfinite(value) && (!first || before(value, *first))) first = value;
    }
  });
  return first.value_or(0.0F);
}

/// What of an image is kept: values above the threshold.
struct Densities {
  using Tree = openvdb::FloatTree;
  float background = 0;
  [[nodiscard]] bool keeps(float value) const { return value > background; }
  [[nodiscard]] static float valueOf(float value) { return value; }
  void require(const std::vector<float>& /*values*/) const {}
};

/// Distances below the threshold, inside and near it.
struct Distances {
  using Tree = openvdb::FloatTree;
  float background = 0;
  [[nodiscard]] bool keeps(float value) const { return value < background; }
  [[nodiscard]] static float valueOf(float value) { return value; }
  void require(const std::vector<float>& /*values*/) const {}
};

/// All labels but 0.
struct Labels {
  using Tree = openvdb::Int32Tree;
  std::int32_t background = 0;
  [[nodiscard]] static bool keeps(float value) { return value != 0; }
  [[nodiscard]] static std::int32_t valueOf(float value) {
    return static_cast<std::int32_t>(value);
  }
  static void require(const std::vector<float>& values) {
    // Floats hold whole numbers up to there; the next one may stand for another.
    constexpr float kMost = 16777215;
    for (const float value : values) {
      if (value == std::floor(value) && std::abs(value) <= kMost) continue;
      throw Error(ErrorCode::UnreadableFile, "labels must be whole numbers of at most " +
                                                 std::to_string(static_cast<int>(kMost)) +
                                                 ", not " +
                                                 base::numberText(static_cast<double>(value)));
    }
  }
};

/// The block at (x, y) of a row of them, if any of its voxels is kept.
template <class Kind>
std::unique_ptr<typename Kind::Tree::LeafNodeType> leafAt(const ImageSlices& image,
                                                          const std::vector<float>& values,
                                                          const openvdb::Coord& origin,
                                                          const Kind& kind) {
  using Leaf = typename Kind::Tree::LeafNodeType;
  auto leaf = std::make_unique<Leaf>(origin, kind.background);
  const std::int64_t width = image.size[0];
  const std::int64_t area = width * image.size[1];
  const std::int64_t ends[3] = {std::min(image.size[0] - origin.x(), kDim),
                                std::min(image.size[1] - origin.y(), kDim),
                                std::min(image.size[2] - origin.z(), kDim)};
  for (std::int64_t z = 0; z < ends[2]; ++z) {
    for (std::int64_t y = 0; y < ends[1]; ++y) {
      const std::int64_t row = z * area + (origin.y() + y) * width + origin.x();
      for (std::int64_t x = 0; x < ends[0]; ++x) {
        const float value = values[static_cast<std::size_t>(row + x)];
        if (!kind.keeps(value)) continue;
        leaf->setValueOn(
            openvdb::Coord(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)),
            kind.valueOf(value));
      }
    }
  }
  return leaf->isEmpty() ? nullptr : std::move(leaf);
}

template <class Kind>
std::shared_ptr<openvdb::GridBase> gridOf(const ImageSlices& image, const Kind& kind,
                                          const SliceOptions& options, base::Job& job) {
  using Leaf = typename Kind::Tree::LeafNodeType;
  const auto grid = openvdb::Grid<typename Kind::Tree>::create(kind.background);
  grid->setTransform(transformOf(image));
  job.beginStage("importing", 1);
  const auto columns = static_cast<std::size_t>((image.size[0] + kDim - 1) / kDim);
  const auto rows = static_cast<std::size_t>((image.size[1] + kDim - 1) / kDim);
  std::vector<std::unique_ptr<Leaf>> leaves(columns * rows);
  forLayers(image, job, [&](std::int64_t z, const std::vector<float>& values) {
    kind.require(values);
    base::runWithThreads(options.threads, [&] {
      constexpr std::size_t kGrain = 16;
      base::runRanges(leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
          const openvdb::Coord origin(static_cast<int>(n % columns * kDim),
                                      static_cast<int>(n / columns * kDim), static_cast<int>(z));
          leaves[n] = leafAt(image, values, origin, kind);
        }
      });
    });
    for (auto& leaf : leaves) {
      if (leaf) grid->tree().addLeaf(leaf.release());
    }
  });
  job.run([&] { openvdb::tools::prune(grid->tree()); });
  return grid;
}

/// The value that counts as background: the threshold, or else the first value in an order.
template <class Before>
float backgroundOf(const ImageSlices& image, const SliceOptions& options, base::Job& job,
                   const Before& before) {
  if (options.threshold) return static_cast<float>(*options.threshold);
  job.beginStage("looking for the background", 0.3);
  return firstOf(image, job, before);
}

std::shared_ptr<openvdb::GridBase> levelSetOf(const ImageSlices& image, const SliceOptions& options,
                                              base::Job& job) {
  const Distances distances{backgroundOf(image, options, job, std::greater<>())};
  if (!(distances.background > 0)) {
    throw Error(ErrorCode::UnreadableFile,
                "none of the values is above 0, as signed distances are outside");
  }
  auto grid = gridOf(image, distances, options, job);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

}  // namespace

std::shared_ptr<openvdb::GridBase> importSlices(const ImageSlices& image,
                                                const SliceOptions& options) {
  requireUsable(image, options);
  openvdb::initialize();
  base::Job job(options.threads, options.progress);
  std::shared_ptr<openvdb::GridBase> grid;
  if (options.labels) {
    grid = gridOf(image, Labels{}, options, job);
    grid->setName("labels");
  } else if (options.distances) {
    grid = levelSetOf(image, options, job);
  } else {
    grid = gridOf(image, Densities{backgroundOf(image, options, job, std::less<>())}, options, job);
    grid->setName("image");
  }
  job.finish();
  return grid;
}

}  // namespace tufa
