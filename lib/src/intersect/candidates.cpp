#include "intersect/candidates.h"

#include <algorithm>
#include <bitset>

#include "base/collect.h"
#include "intersect/envelope.h"
#include "uniform/quad_places.h"

namespace tufa::intersect {

using uniform::kAround;
using uniform::QuadPlace;
using uniform::SurfaceBlock;

namespace {

// Which cells of a block, and of the layer of cells below it on each axis, have several vertices.
class SharedCells {
 public:
  void fill(const uniform::CellTopology& topology, const SurfaceBlock& block) {
    if (any_) cells_.reset();
    any_ = false;
    for (int corner = 0; corner < uniform::kCorners; ++corner) {
      const int dx = corner >> 2, dy = (corner >> 1) & 1, dz = corner & 1;
      const uniform::SurfaceBlockIndex index = topology.neighbour(block, -dx, -dy, -dz);
      if (index == uniform::kNoSurfaceBlock || topology.blocks[index].special < 0) continue;
      for (const auto& [cell, count, extra] :
           topology.specials[topology.blocks[index].special].exceptions) {
        const int x = (cell >> 6) - 8 * dx, y = ((cell >> 3) & 7) - 8 * dy, z = (cell & 7) - 8 * dz;
        if (count < 2 || x < -1 || y < -1 || z < -1) continue;
        cells_.set(slotOf(x, y, z));
        any_ = true;
      }
    }
  }

  [[nodiscard]] bool touch(const QuadPlace& place) const {
    if (!any_) return false;
    for (const auto& [du, dv] : kAround) {
      std::array<int, 3> cell = place.start;
      cell[(place.axis + 1) % 3] -= du;
      cell[(place.axis + 2) % 3] -= dv;
      if (cells_.test(slotOf(cell[0], cell[1], cell[2]))) return true;
    }
    return false;
  }

 private:
  static constexpr int kSize = grid::kBlockSize + 1;
  static std::size_t slotOf(int x, int y, int z) {
    return static_cast<std::size_t>(((x + 1) * kSize + y + 1) * kSize + z + 1);
  }

  bool any_ = false;
  std::bitset<kSize * kSize * kSize> cells_;
};

bool hasVertexOutOfCell(const uniform::VertexSheets& sheets, const Quad& quad) {
  return std::any_of(quad.vertices.begin(), quad.vertices.end(),
                     [&](VertexIndex vertex) { return sheets.isOutOfCell(vertex); });
}

// The sufficient condition of findCandidates() for both triangles of a quad.
bool staysInEnvelope(const Mesh& mesh, const Quad& quad, const Vec3& inner, const Vec3& outer,
                     double margin) {
  const auto at = [&](int i) { return Vec3(mesh.positions[quad.vertices[i]]); };
  const Vec3 corner = at(0), diagonal = at(2) - corner;
  const Between between(corner, inner, outer, margin);
  return between.areSeparated(at(1) - corner, diagonal) &&
         between.areSeparated(diagonal, at(3) - corner);
}

// Tells the candidates of one block after another.
class CandidateTest {
 public:
  CandidateTest(const uniform::SurfaceView& context, const Mesh& mesh, double margin)
      : context_(context), mesh_(mesh), margin_(margin) {}

  void enter(const SurfaceBlock& block) {
    shared_.fill(context_.topology, block);
    origin_ = context_.blocks.origin(block.block);
  }

  [[nodiscard]] bool isCandidate(const QuadPlace& place) const {
    const Quad& quad = mesh_.quads[place.quad];
    if (hasVertexOutOfCell(context_.sheets, quad) || shared_.touch(place)) return true;
    const auto [x, y, z] = place.start;
    const Position start = context_.affine.position(origin_, x, y, z);
    const Vec3 lower(start.x, start.y, start.z);
    const Vec3 upper = lower + context_.affine.axis(place.axis);
    return !staysInEnvelope(mesh_, quad, place.upward ? lower : upper, place.upward ? upper : lower,
                            margin_);
  }

 private:
  const uniform::SurfaceView& context_;
  const Mesh& mesh_;
  double margin_;
  SharedCells shared_;
  Coord origin_;
};

}  // namespace

std::vector<std::uint32_t> findCandidates(const uniform::SurfaceView& context, const Mesh& mesh,
                                          double margin, base::Job& job) {
  const auto add = [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& found) {
    CandidateTest test(context, mesh, margin);
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = context.topology.blocks[i];
      test.enter(block);
      forQuads(context, block, [&](const QuadPlace& place) {
        if (test.isCandidate(place)) found.push_back(static_cast<std::uint32_t>(place.quad));
      });
    }
  };
  return base::collectSorted(job, context.topology.blocks.size(), add, 32);
}

std::vector<std::uint32_t> findCandidatesAmong(const std::vector<std::uint32_t>& quads,
                                               const uniform::SurfaceView& context,
                                               const Mesh& mesh, double margin, base::Job& job) {
  const std::vector<uniform::BlockRange> ranges = uniform::blocksOfQuads(context.topology, quads);
  const auto add = [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& found) {
    CandidateTest test(context, mesh, margin);
    for (std::size_t i = begin; i < end; ++i) {
      test.enter(context.topology.blocks[ranges[i].block]);
      forQuadsAmong(context, quads, ranges[i], [&](const QuadPlace& place, std::size_t) {
        if (test.isCandidate(place)) found.push_back(static_cast<std::uint32_t>(place.quad));
      });
    }
  };
  return base::collectSorted(job, ranges.size(), add, 32);
}

}  // namespace tufa::intersect
