#include <tufa/advise.h>
#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "advise/feature_size.h"
#include "advise/hidden_sheets.h"
#include "base/huge_pages.h"
#include "base/number_text.h"
#include "base/run_call.h"
#include "extract/loop_crossings.h"
#include "extract/marching_cubes.h"
#include "extract/place_crossings.h"
#include "grid/volume.h"

namespace tufa {
namespace {

using extraction::CubeCells;
using extraction::CubeTable;
using uniform::SurfaceBlock;

// Shares of the time.
constexpr double kBlocksEnd = 0.1, kCrossingsEnd = 0.5, kCreasesEnd = 0.6, kSizesEnd = 0.85,
                 kBesideEnd = 0.9;

void requireOptions(const AdviseOptions& options) {
  const auto refuse = [](const std::string& what, double value, const char* range) {
    throw Error(ErrorCode::InvalidArgument,
                what + " is " + base::numberText(value) + ", must be " + range);
  };
  constexpr double kMostVoxels = 100;
  const std::pair<const char*, double> features[] = {{"a smooth feature", options.smoothVoxels},
                                                     {"a sharp feature", options.sharpVoxels},
                                                     {"a sheet", options.sheetVoxels}};
  for (const auto& [feature, voxels] : features) {
    if (voxels > 0 && voxels <= kMostVoxels) continue;
    refuse("the number of voxels of " + std::string(feature), voxels, "above 0 and at most 100");
  }
  if (!(options.sharpAngle >= 0 && options.sharpAngle <= 180)) {
    refuse("the sharp angle", options.sharpAngle, "0 to 180 degrees");
  }
  if (!(options.spared >= 0 && options.spared <= 1)) {
    refuse("the share of cells to spare", options.spared, "0 to 1");
  }
}

/// What is known of one surface cell.
struct CellFeature {
  float size = -1;  ///< voxels; -1 for a cell at an open end
  bool sharp = false;
  bool beside = false;  ///< sharp, or next to a sharp cell
  bool unresolved = false;
};

class Adviser {
 public:
  Adviser(const grid::Volume& volume, const CubeCells& cells, const AdviseOptions& options,
          base::Job& job)
      : volume_(volume),
        cells_(cells),
        options_(options),
        leastCosine_(std::cos(options.sharpAngle * std::numbers::pi / 180)),
        reach_(std::max({options.smoothVoxels, options.sharpVoxels, options.sheetVoxels}) + 1),
        job_(job) {}

  void run(SamplingReport& report) {
    job_.beginStage("crossings", kCrossingsEnd);
    placeCrossings();
    features_.resize(cells_.topology.cellCount);
    job_.beginStage("creases", kCreasesEnd);
    findCreases();
    job_.beginStage("feature sizes", kSizesEnd);
    measureCells();
    job_.beginStage("beside creases", kBesideEnd);
    measureBesideCreases();
    report.reachVoxels = reach_;
    count(report);
  }

 private:
  /// A surface cell at hand.
  struct Place {
    const SurfaceBlock& block;
    std::array<int, 3> at;  ///< in the block
    extraction::CaseCode code;
    std::size_t cell;  ///< among all
  };

  void placeCrossings() {
    base::resizeLarge(crossings_.positions, cells_.edgeCount, job_);
    base::resizeLarge(crossings_.normals, cells_.edgeCount, job_);
    extraction::placeCrossings(volume_, cells_.topology, cells_.edges, crossings_, job_);
  }

  /// Calls body(place) for each surface cell, with newBody() for each thread.
  template <class NewBody>
  void forCells(const NewBody& newBody) {
    job_.forRanges(cells_.topology.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
      auto body = newBody();
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = cells_.topology.blocks[i];
        body.begin(block);
        std::size_t cell = block.firstVertex;
        cells_.forCells(block, [&](int x, int bit, extraction::CaseCode code) {
          body(Place{block, {x, bit >> 3, bit & 7}, code, cell++});
        });
      }
    });
  }

  /// The loops of the cells of one block.
  class Loops {
   public:
    explicit Loops(const Adviser& all) : all_(all) {}
    void begin(const SurfaceBlock& block) {
      table_.fill(all_.cells_.topology, block, all_.cells_.edges);
    }
    template <class Body>
    void forLoops(const Place& place, const Body& body) const {
      const auto& cell = extraction::caseOf(place.code);
      const int at = CubeTable::placeOf(place.at[0], place.at[1], place.at[2]);
      for (int loop = 0; loop < cell.loopCount; ++loop) {
        body(extraction::LoopCrossings(cell, loop, at, table_, all_.crossings_));
      }
    }

   private:
    const Adviser& all_;
    CubeTable table_;
  };

  void findCreases() {
    struct Body : Loops {
      explicit Body(Adviser& own) : Loops(own), all(own) {}
      void operator()(const Place& place) const {
        this->forLoops(place, [&](const extraction::LoopCrossings& loop) {
          all.findCrease(loop, place, all.features_[place.cell]);
        });
      }
      Adviser& all;
    };
    forCells([&] { return Body(*this); });
  }

  void findCrease(const extraction::LoopCrossings& loop, const Place& place,
                  CellFeature& feature) const {
    if (loop.areWithin(leastCosine_)) return;
    feature.sharp = true;
    const Coord corner =
        volume_.blocks.origin(place.block.block).offsetBy(place.at[0], place.at[1], place.at[2]);
    const uniform::Vector best = uniform::solve(loop.planes(volume_.affine, corner), kHalfCell);
    double squares = 0;
    for (int i = 0; i < loop.size(); ++i) {
      const Vec3 point = volume_.affine.latticePoint(loop.position(i), corner) - Vec3(0.5);
      const Vec3 away = Vec3(best[0], best[1], best[2]) - point;
      const double off = volume_.affine.planeInLattice(loop.normal(i)).dot(away);
      squares += off * off;
    }
    if (squares > kResolved * kResolved * loop.size()) feature.unresolved = true;
  }

  void measureCells() {
    struct Body : Loops {
      explicit Body(Adviser& own) : Loops(own), all(own), sizes(own.volume_, own.reach_) {}
      void operator()(const Place& place) {
        CellFeature& feature = all.features_[place.cell];
        feature.beside =
            all.anyAround(place, 1, [&](std::size_t other) { return all.features_[other].sharp; });
        this->forLoops(place, [&](const extraction::LoopCrossings& loop) {
          Vec3 middle(0), outward(0);
          for (int i = 0; i < loop.size(); ++i) {
            middle += Vec3(loop.position(i)) / loop.size();
            outward += Vec3(loop.normal(i)) / loop.size();
          }
          const auto size = static_cast<float>(sizes.at(middle, outward));
          feature.size = feature.size < 0 ? size : std::min(feature.size, size);
        });
      }
      Adviser& all;
      advise::FeatureSize sizes;
    };
    forCells([&] { return Body(*this); });
  }

  /// Lines that begin at a crease run along faces and leave through its rounded edge: cells there
  /// take the smallest size of the plain ones near them.
  void measureBesideCreases() {
    std::vector<float> taken(features_.size(), -1);
    struct Body {
      void begin(const SurfaceBlock&) {}
      void operator()(const Place& place) const {
        if (!all.features_[place.cell].beside) return;
        float& least = taken[place.cell];
        all.anyAround(place, kNear, [&](std::size_t other) {
          const CellFeature& feature = all.features_[other];
          if (!feature.beside && feature.size >= 0 && (least < 0 || feature.size < least)) {
            least = feature.size;
          }
          return false;
        });
      }
      const Adviser& all;
      std::vector<float>& taken;
    };
    forCells([&] { return Body{*this, taken}; });
    for (std::size_t i = 0; i < taken.size(); ++i) {
      if (taken[i] >= 0 && features_[i].size >= 0) features_[i].size = taken[i];
    }
  }

  /// Whether body(cell) holds for a surface cell at most `steps` away on each axis.
  template <class Body>
  bool anyAround(const Place& place, int steps, const Body& body) const {
    const uniform::CellTopology& topology = cells_.topology;
    for (int x = place.at[0] - steps; x <= place.at[0] + steps; ++x) {
      for (int y = place.at[1] - steps; y <= place.at[1] + steps; ++y) {
        for (int z = place.at[2] - steps; z <= place.at[2] + steps; ++z) {
          const auto index = topology.neighbour(place.block, x >> 3, y >> 3, z >> 3);
          if (index == uniform::kNoSurfaceBlock) continue;
          const SurfaceBlock& block = topology.blocks[index];
          const int cell = grid::cellIndex(x & 7, y & 7, z & 7);
          if (((block.cells.slabs[cell >> 6] >> (cell & 63)) & 1) == 0) continue;
          if (body(block.firstVertex + topology.firstVertexInBlock(block, cell))) return true;
        }
      }
    }
    return false;
  }

  void count(SamplingReport& report) const {
    // Of each cell the size of its feature, and how many times it has the voxels it should.
    std::vector<float> sizes, shares;
    for (const CellFeature& cell : features_) {
      if (cell.size < 0) continue;
      const double should = cell.sharp ? options_.sharpVoxels : options_.smoothVoxels;
      sizes.push_back(cell.size);
      shares.push_back(cell.size / static_cast<float>(should));
      report.sharpCells += cell.sharp ? 1 : 0;
      report.unresolvedKinks += cell.unresolved ? 1 : 0;
      report.thinSheets += cell.size < options_.sheetVoxels ? 1 : 0;
      if (cell.size < should) ++(cell.sharp ? report.thinSharp : report.thinSmooth);
    }
    report.surfaceCells = sizes.size();
    report.sparedCells =
        static_cast<std::size_t>(options_.spared * static_cast<double>(sizes.size()));
    report.nyquist = std::numbers::pi / report.voxelSize;
    report.voxelSizeNeeded = report.voxelSize;
    if (sizes.empty()) return;
    std::sort(sizes.begin(), sizes.end());
    std::sort(shares.begin(), shares.end());
    const auto at = [](const std::vector<float>& sorted, double share) {
      const double place = share * static_cast<double>(sorted.size() - 1);
      return static_cast<double>(sorted[static_cast<std::size_t>(place)]);
    };
    report.leastVoxels = sizes.front();
    report.sparedVoxels = at(sizes, options_.spared);
    report.middleVoxels = at(sizes, 0.5);
    report.highestFrequency = report.nyquist / report.sparedVoxels;
    report.voxelSizeNeeded = report.voxelSize * std::min(1.0, at(shares, options_.spared));
  }

  // The planes of a cell that an edge or a corner only clips meet beside it.
  static constexpr float kHalfCell = 1.5F;
  static constexpr int kNear = 3;            ///< cells
  static constexpr double kResolved = 0.25;  ///< voxels

  const grid::Volume& volume_;
  const CubeCells& cells_;
  const AdviseOptions& options_;
  double leastCosine_;
  double reach_;
  base::Job& job_;
  Mesh crossings_;                     ///< no faces
  std::vector<CellFeature> features_;  ///< of each surface cell
};

SamplingReport advised(const grid::Volume& volume, const AdviseOptions& options, base::Job& job) {
  SamplingReport report;
  report.isovalue = volume.blocks.iso().isovalue;
  report.insideIsBelow = volume.blocks.iso().insideIsBelow;
  report.distanceField = volume.scale.distance;
  report.voxelSize = volume.affine.voxelSize();
  const CubeCells cells = extraction::chooseCases(
      volume, extraction::marchingCubesRule(Ambiguity::Separate), false, job);
  Adviser(volume, cells, options, job).run(report);
  job.beginStage("hidden sheets", 1);
  if (report.distanceField) report.hiddenSheets = advise::countHiddenSheets(volume, job);
  return report;
}

}  // namespace

SamplingReport adviseSampling(const openvdb::GridBase& grid, const AdviseOptions& options) {
  requireOptions(options);
  grid::requireMeshable(grid);
  return base::runCall(options.contour, nullptr, [&](ContourReport&, base::Job& job) {
    job.beginStage("blocks", kBlocksEnd);
    return advised(grid::openVolume(grid, options.contour, job), options, job);
  });
}

}  // namespace tufa
