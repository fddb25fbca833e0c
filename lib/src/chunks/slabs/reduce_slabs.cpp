#include "chunks/slabs/reduce_slabs.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "chunks/chain/chunk_chain.h"
#include "chunks/cut/separate_rounded.h"
#include "chunks/slabs/join_slabs.h"
#include "chunks/slabs/split_into_slabs.h"
#include "chunks/slabs/sub_mesh.h"

namespace tufa::chunks {
namespace {

// Voxels on both sides of a plane between slabs that are reduced first.
constexpr int kBand = 16;
static_assert(kLeastSlab > 2 * kBand, "bands do not touch");
// Voxels beyond a slab that its uniform mesh is made of: a band, and what that depends on. A place
// at a crease depends on cells a few voxels around, a repair on what lies near a pair.
constexpr int kMargin = kBand + 24;
static_assert(kMargin % grid::kBlockSize == 0);
// Voxels by which a cut may move vertices apart: a band must not depend on how far it did
// elsewhere.
constexpr double kMostMoved = 1e-3;

class SlabReducer {
 public:
  SlabReducer(const grid::Volume& volume, std::vector<grid::Slab> slabs,
              const octree::CutRule& rule, const CutOptions& options, const CutEnds& ends,
              base::Job& job)
      : volume_(volume),
        slabs_(std::move(slabs)),
        rule_(rule),
        options_(options),
        ends_(ends),
        job_(job) {}

  CutMesh run(double end, ContourReport& report) {
    const double first = slabs_.front().first;
    const double rows = double(slabs_.back().last) - first + 1;
    for (grid::Slab slab : slabs_) {
      job_.beginStage("slab " + std::to_string(done_.size() + 1),
                      end * (double(slab.last) + 1 - first) / rows);
      job_.forParts(1, [&](base::Job& part, std::size_t) {
        CutSlab made = reduce(slab, part);
        while (!done_.empty() && !fit(done_.back().made.upper, made.lower)) {
          slab.first = done_.back().slab.first;
          done_.pop_back();
          made = reduce(slab, part);
        }
        done_.push_back({slab, std::move(made), std::move(report_)});
      });
    }
    return join(report);
  }

 private:
  struct Done {
    grid::Slab slab;
    CutSlab made;
    ContourReport report;
  };

  CutSlab reduce(const grid::Slab& slab, base::Job& job) {
    job.beginStage("blocks", ends_.uniform.blocks);
    const grid::Slab own = samplesOf(slab, slabs_, options_.chunkSize, 0);
    const grid::Slab samples = samplesOf(slab, slabs_, options_.chunkSize, kMargin);
    CutMesh cut =
        cutVolume(grid::partOf(volume_, samples, own, job), options_, ends_, report_, job);
    std::vector<Marks> inBands;
    for (const Band& band : bandsOf(slab)) inBands.push_back(trianglesOf(cut, band, job));
    SubMesh window = subMesh(cut, trianglesOf(cut, slab, inBands, job), job);
    cut = {};
    job.beginStage("level 0", 1, base::Length::Unknown);
    std::vector<ReducedBand> reduced;
    for (const Marks& inBand : inBands) {
      Marks marks;
      for (const std::uint32_t t : window.triangles) marks.push_back(inBand[t]);
      SubMesh band = subMesh(window.cut, marks, job);
      if (band.triangles.empty()) continue;
      band.cut.moved = std::max(band.cut.moved, kMostMoved + latticeMove(options_, volume_.affine));
      reduced.push_back(chainOf(std::move(band.cut), job).reduceBand(rule_.tolerance));
      reduced.back().vertices = std::move(band.vertices);
      reduced.back().triangles = std::move(band.triangles);
    }
    if (window.triangles.empty()) return {};
    std::vector<std::uint8_t> isBeyond;  // the slab, of each chunk
    for (const Coord& chunk : window.cut.chunks) isBeyond.push_back(slab.contains(chunk) ? 0 : 1);
    ChunkChain chain = chainOf(std::move(window.cut), job);
    if (!reduced.empty()) chain.replace(std::move(reduced), isBeyond);
    return takeSlab(chain.reduceAlone(rule_.tolerance), slab, job);
  }

  using Marks = std::vector<std::uint8_t>;  ///< of triangles

  // Lattice coordinates across the slabs.
  struct Band {
    double lower, upper;
  };

  // Around the planes where a slab ends.
  [[nodiscard]] std::vector<Band> bandsOf(const grid::Slab& slab) const {
    std::vector<Band> bands;
    const auto add = [&](std::int32_t row) {
      const double at = double(row) * options_.chunkSize;
      bands.push_back({at - kBand, at + kBand});
    };
    if (slab.first > slabs_.front().first) add(slab.first);
    if (slab.last < slabs_.back().last) add(slab.last + 1);
    return bands;
  }

  // Marks the triangles that lie in a band as a whole, but for some at its borders.
  [[nodiscard]] Marks trianglesOf(const CutMesh& cut, const Band& band, base::Job& job) const {
    std::vector<std::uint8_t> isInside(cut.mesh.positions.size());
    job.forRanges(isInside.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const double at =
            volume_.affine.latticePoint(cut.mesh.positions[v], Coord(0))[slabs_.front().axis];
        isInside[v] = band.lower <= at && at <= band.upper ? 1 : 0;
      }
    });
    Marks marks(cut.mesh.triangles.size());
    job.forRanges(marks.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const auto& v = cut.mesh.triangles[t].vertices;
        marks[t] = isInside[v[0]] & isInside[v[1]] & isInside[v[2]];
      }
    });
    keepManifold(cut, marks, job);
    return marks;
  }

  // Marks the triangles of a slab, and those of bands.
  [[nodiscard]] static Marks trianglesOf(const CutMesh& cut, const grid::Slab& slab,
                                         const std::vector<Marks>& inBands, base::Job& job) {
    Marks marks(cut.mesh.triangles.size());
    for (std::size_t t = 0; t < marks.size(); ++t) {
      job.pollCancelled(t);
      marks[t] = slab.contains(cut.chunks[cut.chunkOf[t]]) ? 1 : 0;
    }
    for (const Marks& inBand : inBands) {
      for (std::size_t t = 0; t < marks.size(); ++t) marks[t] |= inBand[t];
    }
    return marks;
  }

  [[nodiscard]] ChunkChain chainOf(CutMesh cut, base::Job& job) const {
    return {std::move(cut),     volume_.affine,           rule_,
            options_.chunkSize, options_.singlePrecision, job};
  }

  CutMesh join(ContourReport& report) {
    std::vector<CutSlab> slabs;
    report = done_.front().report;
    for (const Done& done : std::span(done_).subspan(1)) {
      report.surfaceCells += done.report.surfaceCells;
      report.faceFlips += done.report.faceFlips;
      report.openEdges += done.report.openEdges;
      report.creaseCells += done.report.creaseCells;
      report.intersectionsFound += done.report.intersectionsFound;
      report.movedVertices += done.report.movedVertices;
      report.flippedDiagonals += done.report.flippedDiagonals;
      report.fannedQuads += done.report.fannedQuads;
    }
    for (Done& done : done_) slabs.push_back(std::move(done.made));
    CutMesh joined = joinSlabs(std::move(slabs), job_);
    const double moved = joined.moved;
    keepApart(joined, volume_.affine, options_.singlePrecision, job_);
    for (double& error : joined.errors) error += joined.moved - moved;
    return joined;
  }

  const grid::Volume& volume_;
  std::vector<grid::Slab> slabs_;
  const octree::CutRule& rule_;
  const CutOptions& options_;
  const CutEnds& ends_;
  base::Job& job_;
  std::vector<Done> done_;
  ContourReport report_;  ///< of the last slab
};

}  // namespace

CutMesh reduceSlabs(const grid::Volume& volume, std::vector<grid::Slab> slabs,
                    const octree::CutRule& rule, const CutOptions& options, const CutEnds& ends,
                    double end, ContourReport& report, base::Job& job) {
  return SlabReducer(volume, std::move(slabs), rule, options, ends, job).run(end, report);
}

}  // namespace tufa::chunks
