// Fields to level sets.

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tufa/voxelize.h>

#include <tufa/error.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "base/job.h"
#include "base/lattice_range.h"
#include "base/number_text.h"
#include "base/parallel.h"
#include "base/vec3.h"
#include "grid/build_blocks.h"
#include "implicit/boxes.h"
#include "voxelize/fog.h"
#include "voxelize/hidden_parts.h"

namespace tufa {
namespace {

using implicit::Box;
using implicit::Field;
using voxelize_field::HiddenParts;
using voxelize_field::SampledBlock;
using Leaf = openvdb::FloatTree::LeafNodeType;

/// Side of the parts of a block that bounds leave out: a bound costs a few samples.
constexpr int kPart = 4;

/// Counts of all blocks, from any thread.
struct Counts {
  std::atomic<std::size_t> samples{0};
  std::atomic<std::size_t> blocks{0};
  std::atomic<std::size_t> activeVoxels{0};
  std::mutex mutex;
  HiddenParts hidden;                     ///< under the mutex
  std::array<int, 3> firstHiddenBlock{};  ///< under the mutex

  /// The place is that of the first block, so that it depends on no order of threads.
  void add(const HiddenParts& parts, const std::array<int, 3>& block) {
    if (parts.found + parts.undecided == 0) return;
    const std::lock_guard lock(mutex);
    if (hidden.found + hidden.undecided == 0 || block < firstHiddenBlock) {
      hidden.first = parts.first;
      firstHiddenBlock = block;
    }
    hidden.found += parts.found;
    hidden.undecided += parts.undecided;
  }
};

/// A value just within the band, for one of that sign beyond it.
float justWithin(float background, float value) {
  return std::copysign(0.999F * background, value);
}

/// Samples the blocks of a lattice, with counts in common.
class Sampler {
 public:
  Sampler(const Field& field, const VoxelizeOptions& options, Counts& counts, base::Job& job)
      : field_(&field), options_(options), counts_(counts), job_(job) {
    const double margin = band() + options.voxelSize;
    region_ = implicit::grown(field.extent(), margin);
  }

  [[nodiscard]] double band() const { return options_.halfWidth * options_.voxelSize; }

  /// It lives as long as the source that is made of it.
  static std::shared_ptr<grid::BlockSource> sourceOf(std::shared_ptr<const Sampler> sampler) {
    auto source = std::make_shared<grid::BlockSource>();
    source->mayBeActive = [sampler](const openvdb::Coord& origin, int side) {
      return !sampler->overLimit() && sampler->meetsRegion(origin, side) &&
             sampler->signOf(origin, side) == 0;
    };
    source->fill = [sampler](Leaf& leaf) { sampler->fill(leaf); };
    source->narrowed = [sampler](const openvdb::Coord& origin, int side) {
      return sampler->narrowed(sampler, origin, side);
    };
    return source;
  }

  /// Whether there are more active voxels than the options allow: nothing more is filled then.
  [[nodiscard]] bool overLimit() const {
    return static_cast<double>(counts_.activeVoxels.load(std::memory_order_relaxed)) >
           options_.bandVoxels;
  }

 private:
  /// The samples of a cube, and all that is within the band of one.
  [[nodiscard]] Box around(const openvdb::Coord& origin, int side) const {
    const Vec3 least = Vec3(origin.x(), origin.y(), origin.z()) * options_.voxelSize;
    const Vec3 reach(band());
    return {least - reach, least + Vec3((side - 1) * options_.voxelSize) + reach};
  }

  [[nodiscard]] bool meetsRegion(const openvdb::Coord& origin, int side) const {
    const Vec3 least = Vec3(origin.x(), origin.y(), origin.z()) * options_.voxelSize;
    const Vec3 greatest = least + Vec3((side - 1) * options_.voxelSize);
    const Vec3 regionLeast = region_.least;
    const Vec3 regionGreatest = region_.greatest;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (greatest[axis] < regionLeast[axis] || least[axis] > regionGreatest[axis]) return false;
    }
    return true;
  }

  /// -1 or 1 if no point within the band of a cube's samples is on the surface, else 0: a surface
  /// further away than the band leaves their values there, whatever the field's scale.
  [[nodiscard]] int signOf(const openvdb::Coord& origin, int side) const {
    const implicit::Interval bound = field_->bound(around(origin, side));
    return bound.least > 0 ? 1 : bound.greatest < 0 ? -1 : 0;
  }

  /// Of a field that has the same values near a cube. It may refer to this one's.
  static std::shared_ptr<const grid::BlockSource> narrowed(
      const std::shared_ptr<const Sampler>& whole, const openvdb::Coord& origin, int side) {
    // The neighbours of samples are asked for too.
    const Box box = implicit::grown(whole->around(origin, side), whole->options_.voxelSize);
    auto field = whole->field_->restricted(box);
    if (!field) return nullptr;
    auto sampler = std::make_shared<Sampler>(*whole);
    sampler->field_ = field.get();
    sampler->own_ = std::move(field);
    sampler->whole_ = whole;
    return sourceOf(std::move(sampler));
  }

  void fill(Leaf& leaf) const {
    // A field of a million parts takes seconds for one block.
    job_.checkCancelled(0, 1);
    const openvdb::Coord origin = leaf.origin();
    SampledBlock block{*field_, {origin.x(), origin.y(), origin.z()}, options_.voxelSize};
    leaf.setValuesOff();
    std::size_t samples = 0;
    constexpr int kSide = static_cast<int>(Leaf::DIM);
    for (int x = 0; x < kSide; x += kPart) {
      for (int y = 0; y < kSide; y += kPart) {
        for (int z = 0; z < kSide; z += kPart) samples += fillPart(leaf, block, x, y, z);
      }
    }
    counts_.samples.fetch_add(samples, std::memory_order_relaxed);
    counts_.blocks.fetch_add(1, std::memory_order_relaxed);
    if (samples > 0 && leaf.isEmpty()) keepCrossing(leaf, block);
    counts_.activeVoxels.fetch_add(leaf.onVoxelCount(), std::memory_order_relaxed);
    if (samples > 0) counts_.add(voxelize_field::findHiddenParts(block), block.origin);
  }

  // Where there is no distance, as beside a gradient that is not a number, the value tells the
  // side: -1 inside, else 1.
  [[nodiscard]] float sideOf(const Position& point) const {
    return field_->value(point) < 0 ? -1.0F : 1.0F;
  }

  std::size_t fillPart(Leaf& leaf, SampledBlock& block, int x0, int y0, int z0) const {
    const openvdb::Coord part = leaf.origin() + openvdb::Coord(x0, y0, z0);
    const int sign = signOf(part, kPart);
    const float background = static_cast<float>(band());
    for (int x = x0; x < x0 + kPart; ++x) {
      for (int y = y0; y < y0 + kPart; ++y) {
        for (int z = z0; z < z0 + kPart; ++z) {
          const std::uint64_t bit = std::uint64_t{1} << (8 * y + z);
          float value = static_cast<float>(sign) * background;
          if (sign == 0) {
            block.sampled[x] |= bit;
            const auto distance =
                static_cast<float>(field_->distance(block.point(x, y, z), band()));
            value = std::isnan(distance) ? sideOf(block.point(x, y, z)) * background : distance;
          }
          if (value < 0) block.inside[x] |= bit;
          const openvdb::Index place = Leaf::coordToOffset(openvdb::Coord(x, y, z));
          const bool active = std::abs(value) < background;
          leaf.setValueOnly(place, active ? value : std::copysign(background, value));
          if (active) leaf.setValueOn(place);
        }
      }
    }
    return sign == 0 ? std::size_t{kPart} * kPart * kPart : 0;
  }

  /// Without active values a block would be dropped, and with it a crossing both of whose ends lie
  /// beyond the band, as at the edge of where a field has a value: an end in the block is made
  /// active, and activateCrossings() does the rest. Between distances there is no such crossing.
  void keepCrossing(Leaf& leaf, const SampledBlock& block) const {
    if (field_->hasUnitGradient()) return;
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      const openvdb::Coord at = Leaf::offsetToLocalCoord(n);
      if (!block.isSampled(at.x(), at.y(), at.z())) continue;
      const bool inside = block.isInside(at.x(), at.y(), at.z());
      for (int way = 0; way < 6; ++way) {
        openvdb::Coord next = at;
        next[way / 2] += way % 2 == 0 ? 1 : -1;
        if (block.isInside(next.x(), next.y(), next.z()) == inside) continue;
        leaf.setValueOn(n, justWithin(static_cast<float>(band()), leaf.getValue(n)));
        return;
      }
    }
  }

  const Field* field_;
  std::shared_ptr<const Field> own_;      ///< the field, if it is a restricted one
  std::shared_ptr<const Sampler> whole_;  ///< keeps what that one may refer to
  const VoxelizeOptions& options_;
  Counts& counts_;
  base::Job& job_;
  Box region_;  ///< where there is anything to sample
};

/// Where a field without slopes beside the surface leaves both ends of a crossing beyond the band,
/// makes them active: the surface would have a hole there.
void activateCrossings(openvdb::FloatGrid& grid, base::Job& job) {
  const auto& tree = grid.tree();
  std::vector<openvdb::Coord> crossings;
  const auto accessor = grid.getConstAccessor();
  std::size_t done = 0;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    constexpr std::size_t kWork = openvdb::FloatTree::LeafNodeType::SIZE;
    job.pollCancelled(kWork * done++);
    for (auto voxel = leaf->cbeginValueAll(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord();
      const bool inside = *voxel < 0;
      for (int axis = 0; axis < 3; ++axis) {
        openvdb::Coord next = at;
        ++next[axis];
        if ((accessor.getValue(next) < 0) == inside) continue;
        if (!voxel.isValueOn()) crossings.push_back(at);
        if (!accessor.isValueOn(next)) crossings.push_back(next);
      }
    }
  }
  for (const openvdb::Coord& at : crossings) {
    grid.tree().setValueOn(at, justWithin(grid.background(), grid.tree().getValue(at)));
  }
}

double reachOf(const Field& field) {
  const Box box = field.extent();
  if (!implicit::isFinite(box)) {
    throw Error(
        ErrorCode::InvalidArgument,
        "the solid may go on for ever; give bounds that it is cut by (implicit::Field::extent())");
  }
  double reach = 0;
  for (const Position& corner : {box.least, box.greatest}) {
    reach = std::max({reach, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  }
  return reach;
}

}  // namespace

openvdb::FloatGrid::Ptr voxelize(const implicit::Field& field, const VoxelizeOptions& options,
                                 VoxelizeReport* report) {
  base::requireVoxelSize(options.voxelSize);
  base::requireHalfWidth(options.halfWidth);
  const int halfExtent =
      grid::extentInVoxels(reachOf(field), options.voxelSize, options.halfWidth + 1);
  openvdb::initialize();

  Counts counts;
  base::Job job(options.threads, options.progress);
  const auto sampler = std::make_shared<const Sampler>(field, options, counts, job);
  auto result = openvdb::FloatGrid::create(static_cast<float>(sampler->band()));
  result->setTransform(openvdb::math::Transform::createLinearTransform(options.voxelSize));
  result->setGridClass(openvdb::GRID_LEVEL_SET);
  result->setName("surface");

  const auto source = Sampler::sourceOf(sampler);
  source->halfExtentVoxels = halfExtent;
  // A surface that passes a cube has a band of thousands of voxels in it.
  constexpr double kLeastInCube = 1024;
  source->mostCubes = static_cast<std::size_t>(std::max(1.0, options.bandVoxels / kLeastInCube));
  job.beginStage("sampling", 1);
  grid::buildBlocks(result->tree(), *source, job);
  if (sampler->overLimit()) {
    throw Error(
        ErrorCode::LimitExceeded,
        "the band around the surface has more than " + base::numberText(options.bandVoxels) +
            " voxels; take larger voxels, or raise the limit (VoxelizeOptions::bandVoxels)");
  }
  // Leaves already hold the right signs; only the tiles between them are still all outside.
  job.run([&] { openvdb::tools::signedFloodFill(result->tree(), true, 1, 1); });
  if (!field.hasUnitGradient()) activateCrossings(*result, job);
  if (options.fog) {
    job.run([&] { voxelize_field::toFog(*result); });
  }
  job.finish();
  if (report != nullptr) {
    report->samples = counts.samples;
    report->blocks = counts.blocks;
    base::runIsolated([&] { report->activeVoxels = result->activeVoxelCount(); });
    report->hiddenVoxels = counts.hidden.found;
    report->undecidedVoxels = counts.hidden.undecided;
    report->firstHidden = counts.hidden.first;
  }
  return result;
}

}  // namespace tufa
