#include "advise/hidden_sheets.h"

#include <array>
#include <cmath>
#include <vector>

#include "grid/samples.h"

namespace tufa::advise {

using grid::BlockSamples;

namespace {

// Of a sheet, in voxels: what rounding and curvature make of none is thinner.
constexpr float kLeastDepth = 0.05F;

// The cosine of the angle between the gradients on both sides is under this: an edge of the shape
// that passes between two samples is none.
constexpr float kOpposite = -0.7F;

class SheetFinder {
 public:
  SheetFinder(const grid::FieldScale& scale, const BlockSamples& samples)
      : scale_(scale), samples_(samples) {}

  /// Of the edge from a sample to the next along an axis.
  [[nodiscard]] bool hidesSheet(int lower, int axis) const {
    const int step = BlockSamples::stride(axis);
    const int upper = lower + step;
    if ((samples_[lower] < 0) != (samples_[upper] < 0)) return false;
    // Seen from outside: the inside is the same with other signs.
    const float side = samples_[lower] < 0 ? -1.0F : 1.0F;
    const float a = side * samples_[lower], b = side * samples_[upper];
    const float fall = a - side * samples_[lower - step];
    const float rise = side * samples_[upper + step] - b;
    if (!(a < 1 && b < 1 && fall < 0 && rise > 0)) return false;
    const float along = (b - rise - a) / (fall - rise);
    if (!(along > 0 && along < 1 && a + fall * along < -kLeastDepth)) return false;
    return areOpposite(lower, side * fall, upper, side * rise, axis);
  }

 private:
  /// With these derivatives along the axis.
  [[nodiscard]] bool areOpposite(int lower, float atLower, int upper, float atUpper,
                                 int axis) const {
    std::array<float, 3> g{}, h{}, sum{};
    for (int i = 0; i < 3; ++i) {
      g[i] = i == axis ? atLower : slope(lower, i);
      h[i] = i == axis ? atUpper : slope(upper, i);
      sum[i] = g[i] + h[i];
    }
    const auto squared = [&](const std::array<float, 3>& v) {
      return scale_.squaredLength(v[0], v[1], v[2]);
    };
    const float gg = squared(g), hh = squared(h);
    return 0.5F * (squared(sum) - gg - hh) < kOpposite * std::sqrt(gg * hh);
  }

  [[nodiscard]] float slope(int at, int axis) const {
    const int step = BlockSamples::stride(axis);
    return 0.5F * (samples_[at + step] - samples_[at - step]);
  }

  const grid::FieldScale& scale_;
  const BlockSamples& samples_;
};

}  // namespace

std::size_t countHiddenSheets(const grid::Volume& volume, base::Job& job) {
  const std::size_t count = volume.blocks.count();
  std::vector<std::uint32_t> found(count, 0);
  job.forRanges(count, 32, [&](std::size_t begin, std::size_t end) {
    const auto accessor = volume.blocks.accessor();
    BlockSamples samples;
    const SheetFinder finder(volume.scale, samples);
    for (std::size_t i = begin; i < end; ++i) {
      const auto block = static_cast<grid::BlockRef>(i);
      samples.gather(volume.blocks, volume.scale, block, volume.blocks.neighbours(block, *accessor),
                     *accessor);
      for (int cell = 0; cell < grid::kBlockCells; ++cell) {
        const int at = BlockSamples::index(cell >> 6, (cell >> 3) & 7, cell & 7);
        if (!(std::abs(samples[at]) < 1)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          if (finder.hidesSheet(at, axis)) ++found[i];
        }
      }
    }
  });
  std::size_t all = 0;
  for (const std::uint32_t here : found) all += here;
  return all;
}

}  // namespace tufa::advise
