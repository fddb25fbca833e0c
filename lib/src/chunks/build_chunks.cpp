#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/box.h"
#include "base/checksum.h"
#include "base/index_box.h"
#include "base/job.h"
#include "base/known_enum.h"
#include "base/run_call.h"
#include "base/small_angles.h"
#include "chunks/chain/chunk_chain.h"
#include "chunks/chain/lattice.h"
#include "chunks/chain/mixed_forms.h"
#include "chunks/chain/shaded_level.h"
#include "chunks/chain/split_level.h"
#include "chunks/cut/cut_volume.h"
#include "chunks/slabs/reduce_slabs.h"
#include "chunks/slabs/split_into_slabs.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "intersect/surface.h"
#include "octree/cut_rule.h"
#include "refine/rounding.h"

namespace tufa {
namespace {

// Shares of the time that stages took on the sample volumes.
constexpr chunks::CutEnds kEnds = {{0.01, 0.02, 0.06, 0.07, 0.08, 0.12}, 0.14};
constexpr double kFirstLevelEnd = 0.75;
// Voxels by which faces along planes between chunks may be moved to them, and the least tolerance
// that leaves enough then.
constexpr double kFlatDistance = 0.02;
constexpr double kLeastForFlat = 0.05;
constexpr double kLevelsEnd = 0.95;

chunks::CutEnds scaled(chunks::CutEnds ends, double by) {
  for (double* end :
       {&ends.uniform.blocks, &ends.uniform.topology, &ends.uniform.vertices,
        &ends.uniform.polygons, &ends.uniform.creases, &ends.uniform.repair, &ends.cut}) {
    *end *= by;
  }
  return ends;
}

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
  if (!octree::maySimplify(options.contour)) {
    refuse(
        "chunks are made by collapsing edges: not without simplifying, or with bounds on angles or "
        "cells");
  }
  octree::requireFactor(options.factor);
  if (options.levels > 1 && options.contour.tolerance == 0) {
    refuse(
        "no level can follow one of tolerance 0, as each level's tolerance is a multiple of that "
        "before: ask for one level");
  }
  if (!(options.creaseAngle >= 0 && options.creaseAngle <= 180)) {
    refuse("the crease angle must be between 0 and 180 degrees");
  }
  base::requireKnown(options.compression, GlbCompression::Meshopt, "the compression");
  base::requireKnown(options.up, UpAxis::Z, "the axis that points up");
  if (!(options.scale > 0 && std::isfinite(options.scale))) refuse("the scale must be above 0");
}

// Whether all positions of the grid may be rounded to floats.
bool fitsSinglePrecision(const grid::Volume& volume) {
  return refine::largestRounding(volume) <= refine::kMostRounding * volume.affine.leastHeight();
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

ChunkIndex describe(const grid::Volume& volume, const ChunkOptions& options) {
  ChunkIndex index;
  index.chunkSize = options.chunkSize;
  double tolerance = options.contour.tolerance;
  for (int i = 0; i < options.levels; ++i, tolerance *= options.factor) {
    index.tolerances.push_back(std::min(tolerance, octree::kLargestTolerance));
  }
  index.voxelSize = grid::Affine(volume.transform).voxelSize();
  index.transform = volume.transform.matrix();
  index.creaseAngle = options.creaseAngle;
  index.compression = options.compression;
  if (options.compression != GlbCompression::None) {
    index.step = chunks::latticeStep(volume.transform, options.chunkSize, options.scale);
  }
  index.up = options.up;
  index.scale = options.scale;
  return index;
}

ChunkLevelEntry entryOf(const ChunkLevel& level, std::size_t pairsLeft, double minAngle) {
  ChunkLevelEntry out;
  out.vertices = level.positions.size();
  out.interiorTriangles = level.interior.size();
  base::SmallAngles angles;
  angles.add(level.positions, level.interior, minAngle);
  for (const auto& strip : level.regular) {
    out.regularTriangles += strip.size();
    angles.add(level.positions, strip, minAngle);
  }
  for (const auto& strip : level.transition) out.transitionTriangles += strip.size();
  base::Box box = base::Box::empty();
  for (const Position& p : level.positions) box.add(p);
  if (box.isEmpty()) box = {Vec3(0), Vec3(0)};
  out.least = box.lower;
  out.greatest = box.upper;
  out.maxErrorVoxels = level.maxErrorVoxels;
  out.transitionErrorVoxels = level.transitionErrorVoxels;
  out.intersectionsLeft = pairsLeft;
  out.smallestAngle = angles.smallest;
  out.trianglesUnderMinAngle = angles.below;
  return out;
}

std::string checksumOf(const std::vector<chunks::ChainLevel>& levels) {
  base::Checksum sum;
  for (const chunks::ChainLevel& level : levels) {
    sum.addAll(level.positions);
    sum.addAll(level.triangles);
  }
  return sum.text();
}

// For each chunk the pairs of triangles of a level that intersect, as they are, beside the next
// level, or on some faces beside it. `isMoved`: the level's vertices have moved since it was made.
std::vector<std::size_t> countPairs(const chunks::CutMesh& cut, const chunks::ChainLevel& level,
                                    bool isMoved, base::Job& job) {
  std::vector<std::size_t> counts(cut.chunks.size(), 0);
  const auto count = [&](bool isChanged) {
    Mesh mesh;
    mesh.positions = level.positions;
    std::vector<std::uint32_t> chunkOf;
    std::vector<intersect::PolygonIndex> candidates;
    for (std::size_t t = 0; t < level.triangles.size(); ++t) {
      job.pollCancelled(t);
      const Triangle other = chunks::changed(level, level.triangles[t]);
      if (isChanged && chunks::isGone(other)) continue;
      if (!isChanged || !(other == level.triangles[t])) {
        candidates.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
      }
      mesh.triangles.push_back(isChanged ? other : level.triangles[t]);
      chunkOf.push_back(level.chunkOf[t]);
    }
    if (candidates.empty()) return;
    const intersect::Surface surface(mesh, job);
    for (const intersect::PolygonPair& pair : intersect::findPairs(surface, candidates, job)) {
      ++counts[chunkOf[pair.a]];
    }
  };
  if (isMoved || !level.isSearched) count(false);
  if (isMoved || !level.isChangedSearched) count(true);
  for (const auto& [t, other] : chunks::findMixedForms(level, job)) ++counts[level.chunkOf[t]];
  return counts;
}

class ChunkBuilder {
 public:
  ChunkBuilder(const grid::StoredGrid& grid, const ChunkOptions& options, const ChunkSink& sink,
               ContourReport& report, base::Job& job)
      : grid_(grid),
        options_(options),
        sink_(sink),
        report_(report),
        job_(job),
        only_(options.only) {
    std::sort(only_.begin(), only_.end());
  }

  ChunkIndex build() {
    chunks::CutOptions cutting;
    ContourOptions& contour = cutting.contour = options_.contour;
    contour.uniform = false;
    contour.normals = Normals::Gradient;
    // Vertices at one place, where the surface touches itself, would be one to what joins chunks by
    // positions; and what is separated later only, costs errors, triangles and time.
    contour.repair = true;
    const octree::CutRule rule = octree::readRule(contour, grid::transformOf(grid_.grid));
    job_.beginStage("blocks", kEnds.uniform.blocks);
    grid::Volume volume = grid::openVolume(grid_, contour, job_);
    ChunkIndex index = describe(volume, options_);
    index.grid = grid::nameOf(grid_.grid);
    cutting.chunkSize = options_.chunkSize;
    if (!rule.scale && rule.tolerance >= kLeastForFlat) cutting.flatDistance = kFlatDistance;
    cutting.singlePrecision = fitsSinglePrecision(volume);
    cutting.latticeStep = index.step;
    if (!cutting.singlePrecision) index.origin = middleOf(volume.blocks, volume.transform);
    const grid::Affine affine = volume.affine;
    chunks::CutMesh cut = cutOrReduce(std::move(volume), rule, cutting);
    if (cut.mesh.positions.empty()) return index;
    cut = makeLevels(std::move(cut), affine, rule, cutting.singlePrecision, index.tolerances);
    job_.beginStage("chunks", 1);
    if (index.step > 0 && !chunks::moveToLattice(levels_, index.step, job_)) {
      index.step = 0;
      index.compression = GlbCompression::None;
    }
    index.surface = checksumOf(levels_);
    handOut(cut, index);
    return index;
  }

 private:
  // The uniform mesh, cut; of a large volume LOD 0, made of slabs. A scale is known at the vertices
  // of the uniform mesh only.
  chunks::CutMesh cutOrReduce(grid::Volume volume, const octree::CutRule& rule,
                              const chunks::CutOptions& cutting) {
    std::vector<grid::Slab> slabs;
    if (!rule.scale) {
      slabs = chunks::splitIntoSlabs(volume.blocks, options_.chunkSize, options_.slabVoxels,
                                     chunks::kLeastSlab, job_);
    }
    if (slabs.size() <= 1) {
      grid::load(volume, job_);
      return chunks::cutVolume(std::move(volume), cutting, kEnds, report_, job_);
    }
    // Flat faces are moved by how many vertices lie along a plane, which slabs see in part only.
    chunks::CutOptions inSlabs = cutting;
    inSlabs.flatDistance = 0;
    return chunks::reduceSlabs(volume, std::move(slabs), rule, inSlabs,
                               scaled(kEnds, 1 / kFirstLevelEnd), kFirstLevelEnd, report_, job_);
  }

  // Returns the cut mesh without its triangles and normals.
  chunks::CutMesh makeLevels(chunks::CutMesh cut, const grid::Affine& affine,
                             const octree::CutRule& rule, bool singlePrecision,
                             const std::vector<double>& tolerances) {
    chunks::ChunkChain chain(std::move(cut), affine, rule, options_.chunkSize, singlePrecision,
                             job_);
    for (std::size_t i = 0; i < tolerances.size(); ++i) {
      const double share = static_cast<double>(i + 1) / static_cast<double>(tolerances.size());
      job_.beginStage("level " + std::to_string(i),
                      kFirstLevelEnd + (kLevelsEnd - kFirstLevelEnd) * share,
                      base::Length::Unknown);
      chunks::ChainLevel level =
          chain.next(tolerances[i], levels_.empty() ? nullptr : &levels_.back());
      levels_.push_back(std::move(level));
    }
    return chain.takeCut();
  }

  void handOut(const chunks::CutMesh& cut, ChunkIndex& index) {
    const chunks::CurveNormals curves(levels_, options_.creaseAngle, job_);
    std::vector<std::vector<ChunkLevel>> levels(levels_.size());
    std::vector<std::vector<std::size_t>> pairs(levels_.size());
    chunks::CurveSides beyond;
    for (std::size_t i = levels_.size(); i-- > 0;) {  // each takes normals from the next one
      auto shaded = chunks::shade(levels_[i], curves, options_.creaseAngle, beyond, job_);
      levels[i] = chunks::splitLevel(cut, levels_[i], shaded, job_);
      pairs[i] = countPairs(cut, levels_[i], index.step > 0, job_);
      beyond = std::move(shaded.sides);
      levels_[i] = {};
    }
    std::vector<ChunkEntry> entries;
    for (std::size_t c = 0; c < cut.chunks.size(); ++c) {
      if (!isAskedFor(cut.chunks[c])) continue;
      Chunk chunk;
      ChunkEntry entry;
      chunk.index = entry.index = cut.chunks[c];
      for (std::size_t i = 0; i < levels.size(); ++i) {
        entry.levels.push_back(entryOf(levels[i][c], pairs[i][c], options_.contour.minAngle));
        report_.intersectionsLeft += pairs[i][c];
        chunk.levels.push_back(std::move(levels[i][c]));
      }
      job_.checkCancelled(c, cut.chunks.size());
      base::runIsolated([&] { sink_(index, std::move(chunk)); });
      entries.push_back(std::move(entry));
    }
    index.chunks = std::move(entries);
  }

  [[nodiscard]] bool isAskedFor(const Coord& chunk) const {
    return only_.empty() || std::binary_search(only_.begin(), only_.end(), chunk);
  }

  const grid::StoredGrid grid_;
  const ChunkOptions& options_;
  const ChunkSink& sink_;
  ContourReport& report_;
  base::Job& job_;
  std::vector<Coord> only_;  ///< sorted
  std::vector<chunks::ChainLevel> levels_;
};

ChunkIndex build(const grid::StoredGrid& grid, const ChunkOptions& options, const ChunkSink& sink,
                 ContourReport* report) {
  requireOptions(options);
  if (!sink) throw Error(ErrorCode::InvalidArgument, "there is no sink to hand the chunks to");
  grid::requireMeshable(grid.grid);
  return base::runCall(options.contour, report, [&](ContourReport& out, base::Job& job) {
    return ChunkBuilder(grid, options, sink, out, job).build();
  });
}

}  // namespace

ChunkIndex buildChunks(const openvdb::GridBase& grid, const ChunkOptions& options,
                       const ChunkSink& sink, ContourReport* report) {
  return build(grid, options, sink, report);
}

ChunkIndex buildChunks(GridFile& file, const ChunkOptions& options, const ChunkSink& sink,
                       ContourReport* report) {
  return build({*file.outline(), file.leaves()}, options, sink, report);
}

}  // namespace tufa
