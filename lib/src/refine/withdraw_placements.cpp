#include "refine/withdraw_placements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "intersect/candidates.h"
#include "intersect/surface.h"
#include "refine/placement_conflict.h"
#include "refine/placement_moves.h"
#include "uniform/place_vertices.h"
#include "uniform/quads.h"

namespace tufa::refine {
namespace {

// A vertex moves a bounded number of times, so rounds end by themselves; this many are a sign of a
// fault.
constexpr int kMostRounds = 64;
// How often others may move vertices afterwards.
constexpr int kMostReturns = 3;
// Faces whose normals have a smaller cosine (140 degrees) make a fold.
constexpr double kFold = -0.766;
// An edge folded by more than 140 degrees has a face more than 70 degrees off the normal of each
// of its ends. Cosine of slightly less.
constexpr double kOffNormal = 0.36;
// Vertices nearer to each other than this, in voxels, stand for the same point of a crease.
constexpr double kSamePoint = 0.03;
// And than this if a face between them is turned over, as where the surface lies on a plane of
// samples: the cells on both sides have the same crease. One of two vertices goes so far away.
constexpr double kSameCrease = 0.15;
// Square voxels; a smaller face that is folded over, as beside vertices that stand close together
// on a crease, is let be: to move them off the crease would change the surface more.
constexpr double kLeastArea = 0.02;
// A vertex that slides along its crease keeps so many voxels from the others of the conflict.
constexpr double kApart = 0.1;
// Sheets of a smaller cosine (140 degrees apart) may have faces that are a fold.
constexpr double kSharpSheets = -0.766;
// And a fold sharper than they are by less than this, in its cosine: 3 degrees at 145.
constexpr double kAsSharp = 0.03;
// A face within this cosine (45 degrees) of a sheet lies on it.
constexpr double kOnSheet = 0.7;

// A face at an edge, the edge's ends in rising order.
struct EdgeFace {
  VertexIndex low, high;
  std::uint32_t face;  // twice the quad, plus 1 for its second triangle
  friend auto operator<=>(const EdgeFace&, const EdgeFace&) = default;
};

class PlacementGuard {
 public:
  PlacementGuard(uniform::UniformSurface& surface, double margin, base::Job& job)
      : surface_(surface),
        mesh_(surface.mesh),
        margin_(margin),
        job_(job),
        polygons_(mesh_, job),
        placementMoves_(surface) {}

  Withdrawal run(const std::function<std::vector<VertexIndex>()>& afterwards) {
    moved_.assign(mesh_.positions.size(), 0);
    beside_.assign(mesh_.positions.size(), 0);
    if (withdrawFrom(findCoincident())) lookAround();
    settle(Look::Everywhere);
    for (int i = 0; i < kMostReturns && afterwards; ++i) {
      const std::vector<VertexIndex> others = afterwards();
      if (others.empty()) break;
      std::fill(moved_.begin(), moved_.end(), 0);
      for (const VertexIndex vertex : others) moved_[vertex] = 1;
      lookAround();
      settle(Look::AtAllTouched);
    }
    return std::move(result_);
  }

 private:
  // Where a round looks for conflicts: everywhere, or at what vertices touch that have moved, for
  // pairs where candidates are or at all of it.
  enum class Look { Everywhere, AtTouched, AtAllTouched };

  void settle(Look look) {
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<Conflict> conflicts = findConflicts(round == 0 ? look : Look::AtTouched);
      std::fill(moved_.begin(), moved_.end(), 0);
      if (!withdrawFrom(conflicts)) break;
      lookAround();
    }
  }

  // After vertices have moved.
  void lookAround() {
    splitAgain();
    findTouched();
  }

  // Without normals diagonals are not chosen by the sheets, and stay.
  void splitAgain() {
    if (!mesh_.normals.empty()) uniform::splitAgain(surface_.view(), moved_, mesh_, job_);
  }
  [[nodiscard]] Triangle cornersOf(std::uint32_t face) const {
    const auto& v = mesh_.quads[face / 2].vertices;
    return face % 2 == 0 ? Triangle{v[0], v[1], v[2]} : Triangle{v[0], v[2], v[3]};
  }
  [[nodiscard]] Vec3 pointOf(VertexIndex vertex) const { return Vec3(mesh_.positions[vertex]); }
  [[nodiscard]] Vec3 normalOf(std::uint32_t face) const {
    const Triangle t = cornersOf(face);
    const Vec3 a = pointOf(t.vertices[0]);
    return (pointOf(t.vertices[1]) - a).cross(pointOf(t.vertices[2]) - a);
  }
  [[nodiscard]] bool touches(std::size_t quad, const std::vector<std::uint8_t>& marks) const {
    const auto& v = mesh_.quads[quad].vertices;
    return marks[v[0]] != 0 || marks[v[1]] != 0 || marks[v[2]] != 0 || marks[v[3]] != 0;
  }

  // The indices below `count` that `isMeant`, in rising order.
  template <class IsMeant>
  std::vector<std::uint32_t> collect(std::size_t count, const IsMeant& isMeant) {
    std::vector<std::uint32_t> all;
    std::mutex mutex;
    job_.forRanges(count, 4096, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> found;
      for (std::size_t i = begin; i < end; ++i) {
        if (isMeant(static_cast<std::uint32_t>(i))) found.push_back(static_cast<std::uint32_t>(i));
      }
      const std::scoped_lock lock(mutex);
      all.insert(all.end(), found.begin(), found.end());
    });
    base::parallelSort(all.begin(), all.end(), std::less<>());
    return all;
  }

  // Whether a triangle is more than 70 degrees off the normal of one of its vertices.
  [[nodiscard]] bool isOff(std::uint32_t face) const {
    const Vec3 normal = normalOf(face);
    const double least = kOffNormal * kOffNormal * normal.squaredLength();
    for (const VertexIndex vertex : cornersOf(face).vertices) {
      const double along = normal.dot(Vec3(mesh_.normals[vertex]));
      if (along <= 0 || along * along < least) return true;
    }
    return false;
  }

  [[nodiscard]] bool isWithin(double voxels, VertexIndex a, VertexIndex b) const {
    const double distance = voxels * surface_.affine().voxelSize();
    return (pointOf(a) - pointOf(b)).squaredLength() < distance * distance;
  }

  // Whether one of a quad's triangles is turned over.
  [[nodiscard]] bool isTurnedOver(std::uint32_t quad) const {
    return !mesh_.normals.empty() && (isOff(2 * quad) || isOff(2 * quad + 1));
  }

  // Vertices of one quad that were placed at the same point of a crease, at least one of them out
  // of its cell.
  std::vector<Conflict> findCoincident() {
    const uniform::VertexSheets& sheets = surface_.sheets;
    const auto coincide = [&](std::uint32_t quad, VertexIndex a, VertexIndex b) {
      return (sheets.isOutOfCell(a) || sheets.isOutOfCell(b)) && sheets.isSharp(a) &&
             sheets.isSharp(b) && isWithin(kSameCrease, a, b) &&
             (isWithin(kSamePoint, a, b) || isTurnedOver(quad));
    };
    std::vector<Conflict> conflicts;
    const auto visit = [&](std::uint32_t quad, const auto& found) {
      const auto& v = mesh_.quads[quad].vertices;
      for (int i = 0; i < 4; ++i) {
        for (int j = i + 1; j < 4; ++j) {
          if (coincide(quad, v[i], v[j])) found(v[i], v[j]);
        }
      }
    };
    for (const std::uint32_t quad : collect(mesh_.quads.size(), [&](std::uint32_t at) {
           bool any = false;
           visit(at, [&](VertexIndex, VertexIndex) { any = true; });
           return any;
         })) {
      visit(quad, [&](VertexIndex a, VertexIndex b) {
        conflicts.push_back({Conflict::Kind::SamePoint, {quad, quad}, {a, b}});
      });
    }
    return conflicts;
  }

  std::vector<Conflict> findConflicts(Look look) {
    std::vector<Conflict> conflicts;
    if (!mesh_.normals.empty()) findFolds(look, conflicts);
    const std::size_t folds = conflicts.size();
    findPairs(look, conflicts);
    if (look == Look::Everywhere) result_.pairsFound = conflicts.size() - folds;
    return conflicts;
  }

  // Edges between a triangle that is off and any other one. After the first time only those of
  // quads that were touched can be new; the triangle that is off may be the one beside such a quad.
  void findFolds(Look look, std::vector<Conflict>& conflicts) {
    const std::vector<std::uint32_t> off = collect(2 * mesh_.quads.size(), [&](std::uint32_t face) {
      return (look == Look::Everywhere || touches(face / 2, beside_)) && isOff(face);
    });
    if (off.empty()) return;
    std::vector<std::uint8_t> marks(mesh_.positions.size());
    for (const std::uint32_t face : off) {
      for (const VertexIndex vertex : cornersOf(face).vertices) marks[vertex] = 1;
    }
    std::vector<EdgeFace> edges;
    for (const std::uint32_t face : collect(2 * mesh_.quads.size(), [&](std::uint32_t at) {
           const auto& v = cornersOf(at).vertices;
           return marks[v[0]] + marks[v[1]] + marks[v[2]] >= 2;
         })) {
      const auto& v = cornersOf(face).vertices;
      for (int i = 0; i < 3; ++i) {
        const VertexIndex a = v[i], b = v[(i + 1) % 3];
        if (marks[a] != 0 && marks[b] != 0) edges.push_back({std::min(a, b), std::max(a, b), face});
      }
    }
    base::parallelSort(edges.begin(), edges.end(), std::less<>());
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const EdgeFace& a = edges[i];
      const EdgeFace& b = edges[i + 1];
      if (a.low != b.low || a.high != b.high || !isFold(a, b)) continue;
      conflicts.push_back({Conflict::Kind::Fold, {a.face, b.face}, {a.low, a.high}});
    }
  }

  [[nodiscard]] bool isFold(const EdgeFace& a, const EdgeFace& b) const {
    const Vec3 na = normalOf(a.face), nb = normalOf(b.face);
    const double least = 2 * kLeastArea * std::pow(surface_.affine().voxelSize(), 2);
    if (std::min(na.squaredLength(), nb.squaredLength()) < least * least) return false;
    const double cosine = na.dot(nb);
    if (cosine >= 0 || cosine * cosine < kFold * kFold * na.squaredLength() * nb.squaredLength())
      return false;
    return !isSharpAt(a.low, na, nb) || !isSharpAt(a.high, na, nb);
  }

  // Whether the two faces lie on two of the sheets known at a vertex, and fold no more than these.
  [[nodiscard]] bool isSharpAt(VertexIndex vertex, const Vec3& na, const Vec3& nb) const {
    const uniform::MeetingSheets sheets = surface_.sheets.sheets(mesh_, vertex);
    if (sheets.count < 2) return false;
    const auto sheetOf = [&](const Vec3& normal) {
      int best = -1;
      double most = kOnSheet * normal.length();
      for (int i = 0; i < sheets.count; ++i) {
        const double along = normal.dot(Vec3(sheets.normals[i]));
        if (along < most) continue;
        most = along;
        best = i;
      }
      return best;
    };
    const int first = sheetOf(na), second = sheetOf(nb);
    if (first < 0 || second < 0 || first == second) return false;
    const double sharp = Vec3(sheets.normals[first]).dot(Vec3(sheets.normals[second]));
    return sharp < kSharpSheets && na.dot(nb) > (sharp - kAsSharp) * na.length() * nb.length();
  }

  void findPairs(Look look, std::vector<Conflict>& conflicts) {
    std::vector<std::uint32_t> fresh =
        look == Look::AtAllTouched
            ? touched_
            : intersect::findCandidates(surface_.view(), mesh_, margin_, job_,
                                        look == Look::Everywhere ? nullptr : &moved_);
    std::vector<intersect::PolygonPair> pairs;
    if (look == Look::Everywhere) {
      result_.candidates = std::move(fresh);
      pairs = intersect::findPairs(polygons_, result_.candidates, job_);
    } else {
      std::vector<std::uint32_t> all;
      std::erase_if(result_.candidates, [&](std::uint32_t quad) { return touches(quad, moved_); });
      std::set_union(result_.candidates.begin(), result_.candidates.end(), fresh.begin(),
                     fresh.end(), std::back_inserter(all));
      result_.candidates = std::move(all);
      // Pairs of which neither quad was moved were there before, and were left.
      const auto isCandidate = [&](std::uint32_t quad) {
        return std::binary_search(result_.candidates.begin(), result_.candidates.end(), quad);
      };
      pairs = intersect::findPairs(
          polygons_, touched_, job_,
          [&](std::uint32_t a, std::uint32_t b) { return isCandidate(a) || isCandidate(b); });
    }
    conflicts.reserve(conflicts.size() + pairs.size());
    for (const intersect::PolygonPair& pair : pairs) {
      conflicts.push_back({Conflict::Kind::Pair, {pair.a, pair.b}, {}});
    }
  }

  [[nodiscard]] Involved involvedIn(const Conflict& conflict) const {
    Involved out;
    for (const std::uint32_t part : conflict.parts) {
      if (conflict.kind == Conflict::Kind::Fold) {
        for (const VertexIndex vertex : cornersOf(part).vertices) out.add(vertex);
      } else if (conflict.kind == Conflict::Kind::Pair) {
        for (const VertexIndex vertex : mesh_.quads[part].vertices) out.add(vertex);
      }
    }
    if (conflict.kind == Conflict::Kind::SamePoint) {
      for (const VertexIndex vertex : conflict.edge) out.add(vertex);
    }
    return out;
  }

  using Move = PlacementMove;

  // Makes the smallest move that settles each conflict. Whether there was any. In a crowd of more
  // conflicts than quads, as where every other sample is inside, all vertices go to their mass
  // points at once: what the smallest moves would come to, after many rounds.
  bool withdrawFrom(const std::vector<Conflict>& conflicts) {
    const std::vector<VertexIndex> vertices = verticesOf(conflicts);
    const auto [plain, mass] =
        uniform::fallbackPoints(surface_.volume.blocks, surface_.volume.scale, surface_.topology,
                                surface_.affine(), vertices, job_);
    const auto slotOf = [&](VertexIndex vertex) {
      return static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), vertex) -
                                      vertices.begin());
    };
    std::vector<std::optional<Move>> chosen(vertices.size());
    if (conflicts.size() > mesh_.quads.size()) {
      for (std::size_t slot = 0; slot < vertices.size(); ++slot) {
        if (placementMoves_.isAtMassPoint(vertices[slot])) continue;
        chosen[slot] = PlacementMoves::toMassPoint(vertices[slot], mass[slot]);
      }
      return apply(chosen);
    }
    std::vector<Move> moves;
    for (const Conflict& conflict : conflicts) {
      moves.clear();
      const Involved involved = involvedIn(conflict);
      for (int i = 0; i < involved.count; ++i) {
        const std::size_t slot = slotOf(involved.vertices[i]);
        placementMoves_.add(involved.vertices[i], plain[slot], mass[slot], moves);
        if (conflict.kind == Conflict::Kind::Fold) {
          placementMoves_.addSlidesOnSheet(involved.vertices[i], moves);
        }
      }
      std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
        return std::pair(a.cost, a.vertex) < std::pair(b.cost, b.vertex);
      });
      if (const Move* move = settling(conflict, moves)) {
        std::optional<Move>& best = chosen[slotOf(move->vertex)];
        if (!best || leavesFewer(*move, *best)) best = *move;
      } else {
        ++result_.left;
      }
    }
    return apply(chosen);
  }

  // The vertices of all conflicts, sorted.
  [[nodiscard]] std::vector<VertexIndex> verticesOf(const std::vector<Conflict>& conflicts) const {
    std::vector<VertexIndex> vertices;
    if (conflicts.empty()) return vertices;
    std::vector<bool> isIn(mesh_.positions.size());
    for (const Conflict& conflict : conflicts) {
      const Involved involved = involvedIn(conflict);
      for (int i = 0; i < involved.count; ++i) isIn[involved.vertices[i]] = true;
    }
    for (VertexIndex vertex = 0; vertex < isIn.size(); ++vertex) {
      if (isIn[vertex]) vertices.push_back(vertex);
    }
    return vertices;
  }

  // The smallest move that settles a conflict, or else the smallest to a place of
  // its own.
  const Move* settling(const Conflict& conflict, const std::vector<Move>& moves) {
    for (const Move& move : moves) {
      const Position was = mesh_.positions[move.vertex];
      mesh_.positions[move.vertex] = move.to;
      const bool settles =
          !isConflict(conflict) && (!move.isSlide || maySlide(move.vertex, conflict));
      mesh_.positions[move.vertex] = was;
      if (settles) return &move;
    }
    const auto first = std::find_if(moves.begin(), moves.end(), PlacementMoves::isWhole);
    return first == moves.end() ? nullptr : &*first;
  }

  // Whether a vertex may stay where it has slid. Two at the same point of a crease may be in any
  // order along it: in the wrong one a triangle is turned over.
  [[nodiscard]] bool maySlide(VertexIndex vertex, const Conflict& conflict) const {
    if (conflict.kind == Conflict::Kind::SamePoint && isTurnedOver(conflict.parts[0])) return false;
    const Involved involved = involvedIn(conflict);
    return std::none_of(
        involved.vertices.begin(), involved.vertices.begin() + involved.count,
        [&](VertexIndex other) { return other != vertex && isWithin(kApart, vertex, other); });
  }

  [[nodiscard]] bool isConflict(const Conflict& conflict) const {
    switch (conflict.kind) {
      case Conflict::Kind::SamePoint:
        return isWithin(kSameCrease, conflict.edge[0], conflict.edge[1]);
      case Conflict::Kind::Fold:
        return isFold({conflict.edge[0], conflict.edge[1], conflict.parts[0]},
                      {conflict.edge[0], conflict.edge[1], conflict.parts[1]});
      case Conflict::Kind::Pair:
        break;
    }
    const auto [a, b] = conflict.parts;
    return intersect::intersectElsewhere(mesh_.positions, mesh_.quads[a].vertices,
                                         mesh_.quads[b].vertices, a == b);
  }

  // Of several moves of a vertex the one that leaves it the fewest places is made.
  static bool leavesFewer(const Move& a, const Move& b) {
    return std::tuple(b.step, b.cost) < std::tuple(a.step, a.cost);
  }

  // Whether there was any.
  bool apply(const std::vector<std::optional<Move>>& moves) {
    bool any = false;
    for (const std::optional<Move>& chosen : moves) {
      if (!chosen) continue;
      any = true;
      const Move& move = *chosen;
      if (placementMoves_.note(move)) ++result_.vertices;
      mesh_.positions[move.vertex] = move.to;
      if (PlacementMoves::leavesCrease(move)) surface_.sheets.withdraw(move.vertex);
      if (move.isSlide) surface_.sheets.setOutOfCell(move.vertex);
      moved_[move.vertex] = 1;
    }
    return any;
  }

  void findTouched() {
    touched_ =
        collect(mesh_.quads.size(), [&](std::uint32_t quad) { return touches(quad, moved_); });
    std::fill(beside_.begin(), beside_.end(), 0);
    for (const std::uint32_t quad : touched_) {
      polygons_.update(quad);
      for (const VertexIndex vertex : mesh_.quads[quad].vertices) beside_[vertex] = 1;
    }
  }

  uniform::UniformSurface& surface_;
  Mesh& mesh_;
  double margin_;
  base::Job& job_;
  intersect::Surface polygons_;
  PlacementMoves placementMoves_;
  std::vector<std::uint8_t> moved_;     // vertices moved in the last round
  std::vector<std::uint32_t> touched_;  // quads of these
  std::vector<std::uint8_t> beside_;    // vertices of those
  Withdrawal result_;
};

}  // namespace

Withdrawal withdrawPlacements(uniform::UniformSurface& surface, double margin, base::Job& job,
                              const std::function<std::vector<VertexIndex>()>& afterwards) {
  return PlacementGuard(surface, margin, job).run(afterwards);
}

}  // namespace tufa::refine
