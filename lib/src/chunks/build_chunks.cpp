#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "base/bits.h"
#include "base/box.h"
#include "base/job.h"
#include "base/run_call.h"
#include "chunks/levels/region.h"
#include "chunks/seams/chunk_cells.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "octree/cut_rule.h"
#include "refine/rounding.h"
#include "refine/surface_model.h"

namespace tufa {
namespace {

using chunks::ChunkCells;

// Chunks are built together in regions of at least this many voxels, aligned to their size, so that
// less is built twice at their borders. The region of a chunk depends on its index alone.
constexpr int kLeastRegion = 128;
// Two more blocks are read around a region: an ambiguous face depends on cells at most six away,
// and a vertex that snaps to a crease on cells at most fourteen away.
constexpr int kMargin = 2 * grid::kBlockSize;
constexpr double kIndexEnd = 0.02;
// Regions whose chunks are kept at most, for each thread, until those before them are handed to the
// caller. With more, threads would wait less for each other but use more memory.
constexpr std::size_t kRegionsPerThread = 4;

void requireOptions(const ChunkOptions& options) {
  const auto refuse = [](const std::string& message) {
    throw Error(ErrorCode::InvalidArgument, message);
  };
  if (options.chunkSize < 8 || options.chunkSize > 1024 ||
      !std::has_single_bit(static_cast<unsigned>(options.chunkSize))) {
    refuse("the chunk size must be a power of two from 8 to 1024, not " +
           std::to_string(options.chunkSize));
  }
  if (options.levels < 1 || options.levels > 16) {
    refuse("chunks have 1 to 16 levels, not " + std::to_string(options.levels));
  }
  octree::requireFactor(options.factor);
}

// The regions that hold blocks and chunks that are asked for.
std::set<Coord> findRegions(const grid::Blocks& blocks, const ChunkOptions& options,
                            int regionLevel) {
  const auto regionOf = [&](const Coord& voxel) {
    return Coord(voxel[0] >> regionLevel, voxel[1] >> regionLevel, voxel[2] >> regionLevel);
  };
  std::set<Coord> regions;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    regions.insert(regionOf(blocks.origin(static_cast<grid::BlockRef>(i))));
  }
  if (options.only.empty()) return regions;
  std::set<Coord> asked;
  const int chunkLevel = std::countr_zero(static_cast<unsigned>(options.chunkSize));
  for (const Coord& chunk : options.only) asked.insert(regionOf(chunk << chunkLevel));
  std::erase_if(regions, [&](const Coord& region) { return !asked.contains(region); });
  return regions;
}

// Whether all positions of the grid may be rounded to floats; the same for every region.
bool fitsSinglePrecision(const grid::Blocks& blocks, const grid::Transform& transform) {
  double largest = 0;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const Vec3 corner(blocks.origin(static_cast<grid::BlockRef>(i)));
    for (int c = 0; c < 8; ++c) {
      const Vec3 step((c & 4) * 2.0, (c & 2) * 4.0, (c & 1) * 8.0);
      const Vec3 world = transform.indexToWorld(corner + step);
      largest = std::max({largest, std::abs(world[0]), std::abs(world[1]), std::abs(world[2])});
    }
  }
  const double rounding = 0.5 * std::sqrt(3.0) * std::numeric_limits<float>::epsilon() * largest;
  return rounding <= refine::kMostRounding * grid::Affine(transform).leastHeight();
}

// The middle of all blocks, in world space and in whole floats, if positions need one.
Position middleOf(const grid::Blocks& blocks, const grid::Transform& transform) {
  base::IndexBox box;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    box.add(blocks.origin(static_cast<grid::BlockRef>(i)));
  }
  const Vec3 world = transform.indexToWorld(box.centre());
  return {std::round(world[0]), std::round(world[1]), std::round(world[2])};
}

ChunkIndex describe(const grid::Transform& transform, const ChunkOptions& options) {
  ChunkIndex index;
  index.chunkSize = options.chunkSize;
  double tolerance = options.contour.tolerance;
  for (int i = 0; i < options.levels; ++i, tolerance *= options.factor) {
    index.tolerances.push_back(std::min(tolerance, octree::kLargestTolerance));
  }
  index.voxelSize = grid::Affine(transform).voxelSize();
  index.transform = transform.matrix();
  return index;
}

ChunkEntry entryOf(const chunks::MadeChunk& made) {
  ChunkEntry entry;
  entry.index = made.chunk.index;
  for (std::size_t i = 0; i < made.chunk.levels.size(); ++i) {
    const ChunkLevel& level = made.chunk.levels[i];
    ChunkLevelEntry& out = entry.levels.emplace_back();
    out.vertices = level.positions.size();
    out.interiorTriangles = level.interior.size();
    for (const auto& strip : level.regular) out.regularTriangles += strip.size();
    for (const auto& strip : level.transition) out.transitionTriangles += strip.size();
    base::Box box = base::Box::empty();
    for (const Position& p : level.positions) box.add(p);
    if (box.isEmpty()) box = {Vec3(0), Vec3(0)};
    out.least = box.lower;
    out.greatest = box.upper;
    out.maxErrorVoxels = level.maxErrorVoxels;
    out.transitionErrorVoxels = level.transitionErrorVoxels;
    out.intersectionsLeft = made.pairsLeft[i];
  }
  return entry;
}

class ChunkBuilder {
 public:
  ChunkBuilder(const openvdb::GridBase& grid, const ChunkOptions& options, const ChunkSink& sink,
               ContourReport& report, base::Job& job)
      : grid_(grid), options_(options), sink_(sink), report_(report), job_(job) {}

  ChunkIndex build() {
    ContourOptions contour = options_.contour;
    contour.uniform = false;
    contour.normals = Normals::Gradient;
    chunkLevel_ = std::countr_zero(static_cast<unsigned>(options_.chunkSize));
    region_.rule = octree::readRule(contour, grid::transformOf(grid_));
    region_.rule.maxLevel = std::min(region_.rule.maxLevel, chunkLevel_);
    region_.rule.chunkLevel = chunkLevel_;
    region_.repair = contour.repair;
    region_.simplify = octree::maySimplify(contour);
    job_.beginStage("index", kIndexEnd);
    const grid::Volume volume = grid::openVolume(grid_, contour, job_);
    const grid::Blocks& blocks = volume.blocks;
    ChunkIndex index = describe(volume.transform, options_);
    index.grid = grid::nameOf(grid_);
    region_.tolerances = index.tolerances;
    region_.singlePrecision = fitsSinglePrecision(blocks, volume.transform);
    if (!region_.singlePrecision) index.origin = middleOf(blocks, volume.transform);
    report_.isovalue = blocks.iso().isovalue;
    report_.insideIsBelow = blocks.iso().insideIsBelow;
    report_.distanceField = volume.scale.distance;
    report_.activeVoxels = blocks.activeVoxels();
    report_.nonFiniteValues = blocks.nonFiniteValues();

    const int regionLevel =
        std::max(chunkLevel_, std::countr_zero(static_cast<unsigned>(kLeastRegion)));
    const std::set<Coord> found = findRegions(blocks, options_, regionLevel);
    const std::vector<Coord> regions(found.begin(), found.end());
    const std::size_t atOnce = kRegionsPerThread * base::threadCount();
    for (std::size_t begin = 0; begin < regions.size(); begin += atOnce) {
      const std::size_t end = std::min(regions.size(), begin + atOnce);
      const double share = static_cast<double>(end) / static_cast<double>(regions.size());
      job_.beginStage("chunks", kIndexEnd + (1 - kIndexEnd) * share);
      std::vector<Region> made(end - begin);
      job_.forParts(made.size(), [&](base::Job& part, std::size_t i) {
        made[i] = makeRegion(volume, contour, regions[begin + i], regionLevel, part);
      });
      for (Region& region : made) handOut(std::move(region), index);
    }
    index.chunks = std::move(entries_);
    std::sort(index.chunks.begin(), index.chunks.end(),
              [](const ChunkEntry& a, const ChunkEntry& b) { return a.index < b.index; });
    return index;
  }

 private:
  // The result for a region.
  struct Region {
    std::vector<chunks::MadeChunk> chunks;
    std::uint64_t surfaceCells = 0, openEdges = 0;
  };

  [[nodiscard]] Region makeRegion(const grid::Volume& volume, const ContourOptions& contour,
                                  const Coord& region, int regionLevel, base::Job& job) const {
    const auto size = static_cast<std::int32_t>(1) << regionLevel;
    const Coord corner(region[0] * size, region[1] * size, region[2] * size);
    ChunkCells cells;
    cells.level = chunkLevel_;
    cells.own = {cells.chunkOf(corner), cells.chunkOf(corner.offsetBy(size - 1))};
    const base::IndexBox box{corner.offsetBy(-kMargin), corner.offsetBy(size + kMargin - 1)};
    const uniform::StageEnds ends = {0.1, 0.15, 0.3, 0.35, 0.4, 0.45};
    const refine::SurfaceModel model(grid::partOf(volume, box), contour, ends, job);
    job.beginStage("levels", 1);
    Region made;
    countOwn(model.view(), cells, made);
    made.chunks = chunks::makeRegion(model, cells, region_, job);
    std::erase_if(made.chunks,
                  [&](const chunks::MadeChunk& chunk) { return !isAskedFor(chunk.chunk.index); });
    return made;
  }

  void handOut(Region&& region, const ChunkIndex& index) {
    report_.surfaceCells += region.surfaceCells;
    report_.openEdges += region.openEdges;
    for (chunks::MadeChunk& made : region.chunks) {
      ChunkEntry entry = entryOf(made);
      for (const ChunkLevelEntry& level : entry.levels) {
        report_.intersectionsLeft += level.intersectionsLeft;
      }
      base::runIsolated([&] { sink_(index, std::move(made.chunk)); });
      entries_.push_back(std::move(entry));
    }
  }

  // Counts what lies in the region itself: the margin belongs to other regions too, and where it
  // ends the surface is open.
  static void countOwn(const uniform::SurfaceView& base, const ChunkCells& cells, Region& made) {
    for (std::size_t i = 0; i < base.topology.blocks.size(); ++i) {
      const uniform::SurfaceBlock& block = base.topology.blocks[i];
      if (!cells.own.contains(cells.chunkOf(base.origin(i)))) continue;
      made.surfaceCells += block.cellCount;
      if (block.special < 0) continue;
      for (const grid::BlockBits& cut : base.topology.specials[block.special].cut) {
        for (const std::uint64_t slab : cut.slabs) {
          made.openEdges += static_cast<std::size_t>(base::countBits(slab));
        }
      }
    }
  }

  [[nodiscard]] bool isAskedFor(const Coord& chunk) const {
    return options_.only.empty() ||
           std::find(options_.only.begin(), options_.only.end(), chunk) != options_.only.end();
  }

  const openvdb::GridBase& grid_;
  const ChunkOptions& options_;
  const ChunkSink& sink_;
  ContourReport& report_;
  base::Job& job_;
  int chunkLevel_ = 0;  ///< log2 of a chunk's size
  chunks::RegionOptions region_;
  std::vector<ChunkEntry> entries_;
};

}  // namespace

ChunkIndex buildChunks(const openvdb::GridBase& grid, const ChunkOptions& options,
                       const ChunkSink& sink, ContourReport* report) {
  requireOptions(options);
  if (!sink) throw Error(ErrorCode::InvalidArgument, "there is no sink to hand the chunks to");
  grid::requireMeshable(grid);
  return base::runCall(options.contour, report, [&](ContourReport& out, base::Job& job) {
    return ChunkBuilder(grid, options, sink, out, job).build();
  });
}

}  // namespace tufa
