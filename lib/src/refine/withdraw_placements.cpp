#include "refine/withdraw_placements.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "refine/conflict_finder.h"
#include "refine/placement_moves.h"
#include "uniform/place_vertices.h"

namespace tufa::refine {
namespace {

// A vertex moves a bounded number of times, so rounds end by themselves; this many are a sign of a
// fault.
constexpr int kMostWithdrawalRounds = 64;
// How often others may move vertices afterwards.
constexpr int kMostReturns = 3;
// A vertex that slides along its crease keeps so many voxels from the others of the conflict.
constexpr double kApart = 0.1;

class PlacementGuard {
 public:
  PlacementGuard(uniform::UniformSurface& surface, double margin, base::Job& job)
      : surface_(surface),
        mesh_(surface.mesh),
        job_(job),
        finder_(surface, margin, job),
        placementMoves_(surface),
        isIn_(mesh_.positions.size(), 0) {}

  Withdrawal run(const std::function<std::vector<VertexIndex>()>& afterwards) {
    const std::vector<VertexIndex> moved = withdrawFrom(finder_.findCoincident());
    if (!moved.empty()) finder_.noteMoved(moved);
    const std::vector<Conflict> conflicts = finder_.findEverywhere();
    result_.pairsFound = static_cast<std::size_t>(std::count_if(
        conflicts.begin(), conflicts.end(),
        [](const Conflict& conflict) { return conflict.kind == Conflict::Kind::Pair; }));
    settle(conflicts);
    for (int i = 0; i < kMostReturns && afterwards; ++i) {
      const std::vector<VertexIndex> others = afterwards();
      if (others.empty()) break;
      finder_.noteMoved(others);
      settle(finder_.findAroundMoved(ConflictFinder::Pairs::All));
    }
    result_.pairs = finder_.pairs();
    return std::move(result_);
  }

 private:
  using Move = PlacementMove;

  void settle(std::vector<Conflict> conflicts) {
    for (int round = 1;; ++round) {
      const std::vector<VertexIndex> moved = withdrawFrom(conflicts);
      if (moved.empty()) return;
      finder_.noteMoved(moved);
      conflicts = finder_.findAroundMoved(ConflictFinder::Pairs::WithCandidate);
      if (round == kMostWithdrawalRounds) return;
    }
  }

  // Makes the smallest move that settles each conflict. Returns what moved, rising. In a crowd of
  // more conflicts than quads, as where every other sample is inside, all vertices go to their mass
  // points at once: what the smallest moves would come to, after many rounds.
  std::vector<VertexIndex> withdrawFrom(const std::vector<Conflict>& conflicts) {
    const std::vector<VertexIndex> vertices = verticesOf(conflicts);
    const uniform::FallbackPoints points =
        uniform::fallbackPoints(surface_.volume.blocks, surface_.volume.scale, surface_.topology,
                                surface_.affine(), vertices, job_);
    std::vector<std::optional<Move>> chosen(vertices.size());
    if (conflicts.size() > mesh_.quads.size()) {
      for (std::size_t slot = 0; slot < vertices.size(); ++slot) {
        if (placementMoves_.wasAtMassPoint(vertices[slot])) continue;
        chosen[slot] = PlacementMoves::toMassPoint(vertices[slot], points.mass[slot]);
      }
      return apply(chosen);
    }
    for (const std::optional<Move>& move : settlingMoves(conflicts, vertices, points)) {
      if (!move) {
        ++result_.left;
        continue;
      }
      std::optional<Move>& best = chosen[slotOf(vertices, move->vertex)];
      if (!best || leavesFewer(*move, *best)) best = move;
    }
    return apply(chosen);
  }

  // The place of a vertex among others, which rise.
  static std::size_t slotOf(const std::vector<VertexIndex>& vertices, VertexIndex vertex) {
    return static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), vertex) -
                                    vertices.begin());
  }

  // For each conflict the smallest move that settles it, if there is one; `points` are those of the
  // vertices of all conflicts. Nothing is moved, so conflicts do not see each other's moves.
  [[nodiscard]] std::vector<std::optional<Move>> settlingMoves(
      const std::vector<Conflict>& conflicts, const std::vector<VertexIndex>& vertices,
      const uniform::FallbackPoints& points) {
    std::vector<std::optional<Move>> settling(conflicts.size());
    job_.forRanges(conflicts.size(), 64, [&](std::size_t begin, std::size_t end) {
      std::vector<Move> moves;
      for (std::size_t c = begin; c < end; ++c) {
        moves.clear();
        addMoves(conflicts[c], vertices, points, moves);
        settling[c] = moveSettling(conflicts[c], moves);
      }
    });
    return settling;
  }

  // The moves of a conflict's vertices; of a fold between such as have all come to their mass
  // points those inside their cells, too.
  void addMoves(const Conflict& conflict, const std::vector<VertexIndex>& vertices,
                const uniform::FallbackPoints& points, std::vector<Move>& moves) const {
    const Involved involved = finder_.involvedIn(conflict);
    const auto end = involved.vertices.begin() + involved.count;
    const bool isFold = conflict.kind == Conflict::Kind::Fold;
    const bool isStuck = isFold && std::all_of(involved.vertices.begin(), end, [&](VertexIndex v) {
                           return placementMoves_.wasAtMassPoint(v);
                         });
    std::for_each(involved.vertices.begin(), end, [&](VertexIndex vertex) {
      const std::size_t slot = slotOf(vertices, vertex);
      placementMoves_.add(vertex, points.plain[slot], points.mass[slot], moves);
      if (isFold) placementMoves_.addSlidesOnSheet(vertex, moves);
      if (isStuck) placementMoves_.addMovesInCell(vertex, points.mass[slot], moves);
    });
  }

  // The vertices of all conflicts, rising. Marked as they are found: where a surface touches itself
  // everywhere, each is in a hundred conflicts.
  std::vector<VertexIndex> verticesOf(const std::vector<Conflict>& conflicts) {
    std::vector<VertexIndex> vertices;
    for (const Conflict& conflict : conflicts) {
      const Involved involved = finder_.involvedIn(conflict);
      for (int i = 0; i < involved.count; ++i) {
        if (std::exchange(isIn_[involved.vertices[i]], true)) continue;
        vertices.push_back(involved.vertices[i]);
      }
    }
    for (const VertexIndex vertex : vertices) isIn_[vertex] = false;
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }

  // The smallest move that settles a conflict, or else the smallest that may be made nevertheless.
  // Sorts the moves from the back, only as far as they are tried.
  [[nodiscard]] std::optional<Move> moveSettling(const Conflict& conflict,
                                                 std::vector<Move>& moves) const {
    const auto isDearer = [](const Move& a, const Move& b) {
      return std::pair(a.cost, a.vertex) > std::pair(b.cost, b.vertex);
    };
    std::make_heap(moves.begin(), moves.end(), isDearer);
    for (auto end = moves.end(); end != moves.begin(); --end) {
      std::pop_heap(moves.begin(), end, isDearer);
      const Move& move = end[-1];
      const Trial trial{move.vertex, move.to};
      if (!finder_.isConflict(conflict, trial) && (!move.isSlide || maySlide(trial, conflict))) {
        return move;
      }
    }
    const auto first = std::find_if(moves.rbegin(), moves.rend(),
                                    [](const Move& move) { return move.isFallback; });
    return first == moves.rend() ? std::optional<Move>() : *first;
  }

  // Whether a vertex may stay where it has slid. Two at the same point of a crease may be in any
  // order along it: in the wrong one a triangle is turned over.
  [[nodiscard]] bool maySlide(const Trial& trial, const Conflict& conflict) const {
    if (conflict.kind == Conflict::Kind::SamePoint &&
        finder_.isTurnedOver(conflict.parts[0], trial)) {
      return false;
    }
    const Involved involved = finder_.involvedIn(conflict);
    return std::none_of(involved.vertices.begin(), involved.vertices.begin() + involved.count,
                        [&](VertexIndex other) {
                          return other != trial.vertex &&
                                 finder_.isWithin(kApart, trial.vertex, other, trial);
                        });
  }

  // Of several moves of a vertex the one that leaves it the fewest places is made.
  static bool leavesFewer(const Move& a, const Move& b) {
    return std::tuple(b.step, b.cost) < std::tuple(a.step, a.cost);
  }

  // Returns what moved, rising.
  std::vector<VertexIndex> apply(const std::vector<std::optional<Move>>& moves) {
    std::vector<VertexIndex> moved;
    for (const std::optional<Move>& chosen : moves) {
      if (!chosen) continue;
      const Move& move = *chosen;
      if (placementMoves_.note(move)) ++result_.vertices;
      mesh_.positions[move.vertex] = move.to;
      if (PlacementMoves::leavesCrease(move)) {
        surface_.sheets.withdraw(move.vertex);
      } else if (move.isSlide) {
        surface_.sheets.setOutOfCell(move.vertex);
      }
      moved.push_back(move.vertex);
    }
    return moved;
  }

  uniform::UniformSurface& surface_;
  Mesh& mesh_;
  base::Job& job_;
  ConflictFinder finder_;
  PlacementMoves placementMoves_;
  std::vector<std::uint8_t> isIn_;  // of vertices, all false between searches
  Withdrawal result_;
};

}  // namespace

Withdrawal withdrawPlacements(uniform::UniformSurface& surface, double margin, base::Job& job,
                              const std::function<std::vector<VertexIndex>()>& afterwards) {
  return PlacementGuard(surface, margin, job).run(afterwards);
}

}  // namespace tufa::refine
