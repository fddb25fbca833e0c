#include "refine/repair/repair.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "base/bvh.h"
#include "base/single_precision.h"
#include "base/sort_unique.h"
#include "refine/repair/pair_group.h"

namespace tufa::refine {
namespace {

using base::Box;

// Rounds of small changes at most, and again of last resorts.
constexpr int kMostRepairRounds = 40;
// Where more than one in so many polygons intersects another, as in white noise, there is no fine
// shape to preserve: all vertices involved go to their mass points at once.
constexpr std::size_t kCrowded = 20;
constexpr int kCrowdedRounds = 2;
// The box of a pair's surroundings reaches beyond it by this share of its size, and by no less than
// this in voxels.
constexpr double kSight = 0.75;
constexpr double kLeastSight = 1.0;

class Repairer {
 public:
  Repairer(Mesh& mesh, const Source& source, base::Job& job)
      : surface_(mesh, job),
        source_(source),
        job_(job),
        ownVertices_(static_cast<VertexIndex>(mesh.positions.size())) {
    fallbacks_.voxelSize = source.voxelSize;
    fallbacks_.singlePrecision = source.singlePrecision;
  }

  // Crowded meshes first retreat to their fallback positions. Then rounds of small changes until no
  // pair is left that anything helps, and rounds with last resorts if they are wanted. Each round
  // searches only what it changed.
  RepairReport run(const std::vector<intersect::PolygonIndex>& candidates) {
    pairs_ = intersect::findPairs(surface_, candidates, job_);
    report_.pairsFound = pairs_.size();
    const std::size_t crowd = std::max(surface_.size(), source_.wholeSize) / kCrowded;
    for (int round = 0; round < kCrowdedRounds && pairs_.size() > crowd; ++round) {
      readFallbacks();
      report_.changed = retreatAll();
      lookAgain(report_.changed);
    }
    repairInRounds(false);
    if (source_.lastResort) repairInRounds(true);
    surface_.finish();
    base::sortUnique(report_.changed);
    for (const auto& [vertex, from] : before_) {
      if (!(surface_.mesh().positions[vertex] == from)) report_.moved.push_back({vertex, from});
    }
    std::sort(report_.moved.begin(), report_.moved.end(),
              [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
    report_.left = std::move(pairs_);
    return std::move(report_);
  }

 private:
  void repairInRounds(bool lastResort) {
    stuck_.clear();
    for (int round = 0; round < kMostRepairRounds && stuck_.size() < pairs_.size(); ++round) {
      readFallbacks();
      lookAgain(repairGroups(lastResort));
    }
  }

  // Mass points and crossings for the polygons of all pairs, as far as they are not known yet.
  void readFallbacks() {
    std::vector<intersect::PolygonIndex> quads;
    std::vector<VertexIndex> vertices;
    for (const intersect::PolygonPair& pair : pairs_) {
      for (const intersect::PolygonIndex polygon : {pair.a, pair.b}) {
        if (surface_.isQuad(polygon) && fallbacks_.crossings.count(polygon) == 0) {
          quads.push_back(polygon);
        }
        for (const VertexIndex vertex : surface_.corners(polygon)) {
          if (vertex >= ownVertices_ || fallbacks_.massPoints.count(vertex) != 0) continue;
          if (!source_.isFixed || !source_.isFixed(vertex)) vertices.push_back(vertex);
        }
      }
    }
    base::sortUnique(quads);
    base::sortUnique(vertices);
    if (!vertices.empty()) {
      const std::vector<Position> points = source_.massPoints(vertices);
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        fallbacks_.massPoints.emplace(vertices[i], rounded(points[i]));
      }
    }
    if (quads.empty() || !source_.crossings) return;
    const std::vector<Position> points = source_.crossings(quads);
    for (std::size_t i = 0; i < quads.size(); ++i) {
      fallbacks_.crossings.emplace(quads[i], rounded(points[i]));
    }
  }

  [[nodiscard]] Position rounded(const Position& p) const {
    return source_.singlePrecision ? base::toSingle(p) : p;
  }

  std::vector<intersect::PolygonIndex> retreatAll() {
    for (const auto& [vertex, to] : fallbacks_.massPoints) {
      if (surface_.mesh().positions[vertex] == to) continue;
      move(vertex, to);
    }
    std::vector<intersect::PolygonIndex> all(surface_.size());
    std::iota(all.begin(), all.end(), intersect::PolygonIndex{0});
    for (const intersect::PolygonIndex polygon : all) surface_.update(polygon);
    return all;
  }

  void move(VertexIndex vertex, const Position& to) {
    if (vertex < ownVertices_) before_.try_emplace(vertex, surface_.mesh().positions[vertex]);
    surface_.move(vertex, to);
    ++report_.movedVertices;
  }

  // Each group is repaired in a copy of its surroundings, in parallel; changes are applied in the
  // order of the groups.
  std::vector<intersect::PolygonIndex> repairGroups(bool lastResort) {
    const std::vector<std::vector<intersect::PolygonPair>> groups = findGroups();
    const std::vector<std::vector<intersect::PolygonIndex>> polygons = findPolygons(groups.size());
    std::vector<Changes> changes(groups.size());
    job_.forRanges(groups.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        PairGroup group(LocalMesh(surface_, polygons[i]), groups[i], fallbacks_);
        changes[i] = group.repairIntersections(lastResort);
      }
    });
    std::vector<intersect::PolygonIndex> changed;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      // A pair that nothing helped is not tried again unless something changes around it.
      if (changes[i].polygons.empty() && changes[i].fans.empty()) {
        stuck_.insert(groups[i].begin(), groups[i].end());
      }
      apply(changes[i], changed);
    }
    base::sortUnique(changed);
    report_.changed.insert(report_.changed.end(), changed.begin(), changed.end());
    return changed;
  }

  // The surroundings of a pair: what its changes may touch, fallback positions included.
  [[nodiscard]] Box sightOf(const intersect::PolygonPair& pair) const {
    Box box = surface_.box(pair.a);
    box.add(surface_.box(pair.b));
    for (const intersect::PolygonIndex polygon : {pair.a, pair.b}) {
      for (const VertexIndex vertex : surface_.corners(polygon)) {
        const auto fallback = fallbacks_.massPoints.find(vertex);
        if (fallback == fallbacks_.massPoints.end()) continue;
        box.add(Vec3(fallback->second.x, fallback->second.y, fallback->second.z));
      }
    }
    const Vec3 size = box.upper - box.lower;
    const Vec3 margin(
        std::max(kSight * std::max({size[0], size[1], size[2]}), kLeastSight * source_.voxelSize));
    return {box.lower - margin, box.upper + margin};
  }

  [[nodiscard]] Vec3 sumOf(intersect::PolygonIndex polygon) const {
    Vec3 sum(0);
    for (const VertexIndex vertex : surface_.corners(polygon)) {
      const Position& p = surface_.mesh().positions[vertex];
      sum += Vec3(p);
    }
    return sum;
  }

  // Chooses pairs whose surroundings do not overlap, each with all pairs inside its own: they are
  // repaired at the same time, and the others wait for a later round. Greedy by place, so the
  // choice does not depend on threads or on the order of polygons. A polygon may reach into two
  // surroundings; what its two changes make together is found by the search after the round.
  std::vector<std::vector<intersect::PolygonPair>> findGroups() {
    std::vector<Box> all;
    for (const intersect::PolygonPair& pair : pairs_) all.push_back(sightOf(pair));
    const base::Bvh tree(all, job_);
    // By place: a grid that is translated has its polygons in another order.
    std::vector<Vec3> places;
    for (const intersect::PolygonPair& pair : pairs_)
      places.push_back(sumOf(pair.a) + sumOf(pair.b));
    const auto before = [&places](std::uint32_t i, std::uint32_t j) {
      return places[i] != places[j] ? places[i] < places[j] : i < j;
    };
    std::vector<std::uint32_t> order(pairs_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), before);
    std::vector<std::vector<intersect::PolygonPair>> groups;
    sights_.clear();
    std::vector<bool> taken(pairs_.size());
    // Of one pair at a time: where a surface touches itself everywhere, each sees thousands.
    std::vector<std::uint32_t> seen;
    for (const std::uint32_t i : order) {
      if (taken[i] || stuck_.count(pairs_[i]) != 0) continue;
      groups.push_back({pairs_[i]});
      sights_.push_back(all[i]);
      seen.clear();
      tree.itemsMeeting(all[i], [&](std::uint32_t other, const Box&) {
        if (other != i) seen.push_back(other);
      });
      std::sort(seen.begin(), seen.end(), before);
      for (const std::uint32_t other : seen) {
        taken[other] = true;
        if (contains(all[i], pairs_[other])) groups.back().push_back(pairs_[other]);
      }
    }
    return groups;
  }

  [[nodiscard]] bool contains(const Box& sight, const intersect::PolygonPair& pair) const {
    Box own = surface_.box(pair.a);
    own.add(surface_.box(pair.b));
    own.add(sight);
    return own.lower == sight.lower && own.upper == sight.upper;
  }

  // The polygons in the surroundings of each group, sorted.
  std::vector<std::vector<intersect::PolygonIndex>> findPolygons(std::size_t groups) {
    using Entry = std::pair<std::uint32_t, intersect::PolygonIndex>;  // a group and a polygon
    const base::Bvh tree(sights_, job_);
    std::vector<std::vector<Entry>> ofRun(surface_.runCount());
    job_.forRanges(surface_.runCount(), 64, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> near;
      for (std::size_t run = begin; run < end; ++run) {
        near.clear();
        tree.itemsMeeting(surface_.runBox(run),
                          [&](std::uint32_t i, const Box&) { near.push_back(i); });
        for (intersect::PolygonIndex p = surface_.runBegin(run);
             !near.empty() && p < surface_.runEnd(run); ++p) {
          const Box box = surface_.box(p);
          for (const std::uint32_t i : near) {
            if (box.meets(sights_[i])) ofRun[run].emplace_back(i, p);
          }
        }
      }
    });
    std::vector<std::vector<intersect::PolygonIndex>> polygons(groups);
    for (const std::vector<Entry>& entries : ofRun) {
      for (const auto& [group, polygon] : entries) polygons[group].push_back(polygon);
    }
    return polygons;
  }

  void apply(const Changes& changes, std::vector<intersect::PolygonIndex>& changed) {
    for (const auto& [vertex, to] : changes.moves) move(vertex, to);
    for (const intersect::PolygonIndex quad : changes.turns) surface_.turn(quad);
    for (const auto& [quad, centre] : changes.fans) {
      const auto first = static_cast<intersect::PolygonIndex>(surface_.size());
      surface_.fan(quad, centre);
      for (intersect::PolygonIndex i = 0; i < 4; ++i) changed.push_back(first + i);
    }
    for (const intersect::PolygonIndex polygon : changes.polygons) surface_.update(polygon);
    changed.insert(changed.end(), changes.polygons.begin(), changes.polygons.end());
    report_.flippedDiagonals += changes.turns.size();
    report_.fannedQuads += changes.fans.size();
  }

  // Searches for the pairs of changed polygons again; all others are as before.
  void lookAgain(const std::vector<intersect::PolygonIndex>& changed) {
    std::erase_if(pairs_, [&](const intersect::PolygonPair& pair) {
      return surface_.corners(pair.a).empty() || surface_.corners(pair.b).empty() ||
             std::binary_search(changed.begin(), changed.end(), pair.a) ||
             std::binary_search(changed.begin(), changed.end(), pair.b);
    });
    const std::vector<intersect::PolygonPair> found = intersect::findPairs(surface_, changed, job_);
    for (const intersect::PolygonPair& pair : found) stuck_.erase(pair);
    pairs_.insert(pairs_.end(), found.begin(), found.end());
    std::sort(pairs_.begin(), pairs_.end());
    std::erase_if(stuck_, [&](const intersect::PolygonPair& pair) {
      return !std::binary_search(pairs_.begin(), pairs_.end(), pair);
    });
  }

  intersect::Surface surface_;
  const Source& source_;
  base::Job& job_;
  VertexIndex ownVertices_;  // those behind are centres of fans
  std::vector<intersect::PolygonPair> pairs_;
  FallbackPositions fallbacks_;
  std::unordered_map<VertexIndex, Position> before_;  // where vertices were that have moved
  std::set<intersect::PolygonPair> stuck_;            // pairs that nothing in this phase helps
  std::vector<Box> sights_;                           // surroundings of the groups
  RepairReport report_;
};

}  // namespace

RepairReport repairIntersections(Mesh& mesh, const std::vector<intersect::PolygonIndex>& candidates,
                                 const Source& source, base::Job& job) {
  return Repairer(mesh, source, job).run(candidates);
}

}  // namespace tufa::refine
