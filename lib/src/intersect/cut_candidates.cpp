#include "intersect/cut_candidates.h"

#include <cmath>
#include <cstddef>

#include "base/huge_pages.h"
#include "base/polygons.h"
#include "intersect/envelope.h"
#include "uniform/block_ranges.h"
#include "uniform/quad_places.h"

namespace tufa::intersect {
namespace {

using uniform::QuadPlace;
using uniform::SurfaceBlock;

// Voxels from the rim of a face at which a segment must pass it: more than any rounding.
constexpr double kOffRim = 1e-3;

// The cell of a vertex, in lattice coordinates counted from the origin of the grid's transform.
struct Cell {
  Vec3 vertex;
  Coord lower;
  int size = 0;  // 0: the vertex is out of it, or there are several
};

class CutEnvelopes {
 public:
  CutEnvelopes(const octree::ClusterForest& forest, const octree::Cut& cut,
               const octree::CutMesh& made, const uniform::SurfaceView& base, double margin,
               base::Job& job)
      : forest_(forest),
        cut_(cut),
        made_(made),
        mesh_(made.mesh),
        base_(base),
        margin_(margin),
        job_(job) {}

  std::vector<std::uint8_t> run() {
    findCells();
    leaveOutSharedCells();
    base::resizeLarge(isCandidate_, mesh_.quads.size() + mesh_.triangles.size(), job_);
    test(made_.quadSources, 0);
    test(made_.triangleSources, mesh_.quads.size());
    return std::move(isCandidate_);
  }

 private:
  void findCells() {
    base::resizeLarge(cells_, cut_.clusters.size(), job_);
    job_.forRanges(cells_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const octree::ClusterRef& ref = cut_.clusters[i];
        cells_[i] = ref.level == 0 ? unitCell(ref.cluster) : largerCell(ref);
      }
    });
  }

  // A vertex of the uniform mesh in its cell is off the cell's faces.
  [[nodiscard]] Cell unitCell(VertexIndex vertex) const {
    Cell cell;
    if (base_.sheets.isOutOfCell(vertex)) return cell;
    cell.vertex = base_.affine.latticePoint(base_.mesh.positions[vertex], Coord(0));
    for (int i = 0; i < 3; ++i) cell.lower[i] = static_cast<int>(std::floor(cell.vertex[i]));
    cell.size = 1;
    return cell;
  }

  [[nodiscard]] Cell largerCell(const octree::ClusterRef& ref) const {
    const octree::ClusterLevel& level = forest_.at(ref.level);
    const octree::Cluster& cluster = level.clusters[ref.cluster];
    Cell cell;
    if (level.first[cluster.cell + 1] - level.first[cluster.cell] != 1) return cell;
    const int size = 1 << ref.level;
    const double half = 0.5 * size;
    cell.lower = level.corner(cluster.cell);
    for (int i = 0; i < 3; ++i) {
      const double fromMiddle = cluster.point[i];
      if (!(std::abs(fromMiddle) < half)) return cell;
      cell.vertex[i] = cell.lower[i] + half + fromMiddle;
    }
    cell.size = size;
    return cell;
  }

  // Of the uniform mesh.
  void leaveOutSharedCells() {
    for (const SurfaceBlock& block : base_.topology.blocks) {
      if (block.special < 0) continue;
      for (const uniform::CellException& exception :
           base_.topology.specials[block.special].exceptions) {
        if (exception.count < 2) continue;
        const std::uint64_t first =
            block.firstVertex + base_.topology.firstVertexInBlock(block, exception.cell);
        for (std::uint64_t v = first; v < first + exception.count; ++v) {
          const VertexIndex vertex = cut_.vertexOf[v];
          if (cut_.clusters[vertex].level == 0) cells_[vertex].size = 0;
        }
      }
    }
  }

  // Polygons `first` and on, given by their uniform quads.
  void test(const std::vector<std::uint32_t>& sources, std::size_t first) {
    const std::vector<uniform::BlockRange> ranges = blocksOfQuads(base_.topology, sources);
    job_.forRanges(ranges.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Coord& origin = base_.origin(ranges[i].block);
        forQuadsAmong(base_, sources, ranges[i], [&](const QuadPlace& place, std::size_t slot) {
          isCandidate_[first + slot] = isInEnvelope(first + slot, origin, place) ? 0 : 1;
        });
      }
    });
  }

  [[nodiscard]] bool isInEnvelope(std::size_t polygon, const Coord& origin,
                                  const QuadPlace& place) const {
    const base::Corners v = base::cornersOf(mesh_, static_cast<base::PolygonIndex>(polygon));
    for (const VertexIndex vertex : v) {
      if (cells_[vertex].size == 0) return false;
    }
    const auto [x, y, z] = place.start;
    const Coord start = origin.offsetBy(x, y, z);
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Cell& a = cells_[v[i]];
      const Cell& b = cells_[v[(i + 1) % v.size()]];
      if (a.size != b.size && !passesFace(a, b, start, place.axis)) return false;
    }
    const auto at = [&](std::size_t i) { return Vec3(mesh_.positions[v[i]]); };
    const Vec3 corner = at(0), diagonal = at(2) - corner;
    const Vec3 lower(base_.affine.position(origin, x, y, z));
    const Vec3 upper = lower + base_.affine.axis(place.axis);
    const Vec3& inner = place.upward ? lower : upper;
    const Vec3& outer = place.upward ? upper : lower;
    const Between between(corner, inner, outer, margin_);
    return between.areSeparated(at(1) - corner, diagonal) &&
           (v.size() == 3 || between.areSeparated(diagonal, at(3) - corner));
  }

  // Whether the segment between the vertices of two neighbouring cells around a lattice edge passes
  // the face that they share: all of the smaller one's.
  [[nodiscard]] static bool passesFace(const Cell& a, const Cell& b, const Coord& start, int axis) {
    const Cell& small = a.size < b.size ? a : b;
    for (int step = 1; step < 3; ++step) {
      const int across = (axis + step) % 3, plane = start[across];
      const bool isBetween = (a.lower[across] + a.size == plane && b.lower[across] == plane) ||
                             (b.lower[across] + b.size == plane && a.lower[across] == plane);
      if (!isBetween) continue;
      const double share = (plane - a.vertex[across]) / (b.vertex[across] - a.vertex[across]);
      for (int other = 0; other < 3; ++other) {
        if (other == across) continue;
        const double at = a.vertex[other] + share * (b.vertex[other] - a.vertex[other]);
        const double lower = small.lower[other];
        if (!(at > lower + kOffRim && at < lower + small.size - kOffRim)) return false;
      }
      return true;
    }
    return false;
  }

  const octree::ClusterForest& forest_;
  const octree::Cut& cut_;
  const octree::CutMesh& made_;
  const Mesh& mesh_;
  const uniform::SurfaceView& base_;
  double margin_;
  base::Job& job_;
  std::vector<Cell> cells_;
  std::vector<std::uint8_t> isCandidate_;
};

}  // namespace

std::vector<std::uint8_t> findCutCandidates(const octree::ClusterForest& forest,
                                            const octree::Cut& cut, const octree::CutMesh& made,
                                            const uniform::SurfaceView& base, double margin,
                                            base::Job& job) {
  return CutEnvelopes(forest, cut, made, base, margin, job).run();
}

}  // namespace tufa::intersect
