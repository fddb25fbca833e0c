#include "refine/simplify_cut.h"

#include <algorithm>
#include <limits>
#include <span>

#include "base/huge_pages.h"
#include "base/polygons.h"
#include "refine/collapse/collapse.h"
#include "topology/dilate.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

using uniform::VertexSheets;

// The level of vertices that stand for several clusters: above all others, so that they are found
// at fault first.
constexpr std::uint8_t kJoined = std::numeric_limits<std::uint8_t>::max();
// Share of the tolerance that is the error budget. It is tested at points only; the rest is for
// what lies between them.
constexpr double kFirstShare = 0.9;
// A faulty vertex keeps this share of its error budget, at its next failure the square of that, and
// so on. From round kSoftRounds on, its last collapse is rolled back, at its next failure the last
// two, and so on; after kRollBackRounds such rounds nothing new is collapsed.
constexpr float kLess = 0.6F;
constexpr int kSoftRounds = 5;
constexpr int kRollBackRounds = 6;
constexpr int kMostFailures = 30;
// After so many further rounds, collapses of its neighbours are rolled back too, then those of
// theirs; at most so many rings at once.
constexpr int kRoundsPerRing = 4;
constexpr int kMostRings = 8;
// Beside fixed vertices a fault may have no remedy: after so many rounds it is left.
constexpr int kRoundsBesideFixed = 8;
// Within so many rings of a fault, repair starts from scratch.
constexpr int kRingsAnew = 2;
constexpr std::size_t kGrain = 4096;

// The planes of the uniform vertices that each vertex stands for, in coordinates counted from it.
std::vector<base::Quadric> gatherPlanes(const uniform::SurfaceView& base, const Measured& mesh,
                                        base::Job& job) {
  std::vector<base::Quadric> planes(mesh.cut.clusters.size());
  const auto add = [&](VertexIndex to, const Vec3& offset, const Normal& n) {
    const Vec3 normal(n.x, n.y, n.z);
    if (normal.squaredLength() > 0) planes[to].addPlane(offset, normal);
  };
  // Vertices behind those of the cells are on seams, and fixed.
  for (std::size_t i = 0; i < base.topology.vertexCount; ++i) {
    job.pollCancelled(i);
    const auto vertex = static_cast<VertexIndex>(i);
    const VertexIndex to = mesh.cut.vertexOf[i];
    const Vec3 offset = Vec3(base.mesh.positions[i]) - Vec3(mesh.made.mesh.positions[to]);
    const VertexSheets::Kind kind = base.sheets.kind(vertex);
    const uniform::MeetingSheets sheets = kind == VertexSheets::Kind::Meeting
                                              ? base.sheets.sheets(base.mesh, vertex)
                                              : uniform::MeetingSheets();
    for (int side = 0; side < sheets.count; ++side) add(to, offset, sheets.normals[side]);
    if (sheets.count > 0) continue;
    add(to, offset, base.mesh.normals[i]);
    if (kind < VertexSheets::Kind::Meeting) continue;
    // Several sheets that could not be told apart: three planes hold the vertex itself.
    for (const Normal& axis : {Normal(1, 0, 0), Normal(0, 1, 0), Normal(0, 0, 1)}) {
      add(to, offset, axis);
    }
  }
  return planes;
}

// Points of the uniform mesh that bound a collapse: the middle of each polygon's uniform quad, and
// of the uniform vertices of each vertex the nearest one; later also those found too far.
class Samples {
 public:
  Samples(const uniform::SurfaceView& base, const Measured& mesh, base::Job& job)
      : base_(base), mesh_(mesh) {
    const Mesh& own = mesh.made.mesh;
    polygonOf_.assign(own.positions.size(), octree::kNone);
    base::forPolygons(own, [&](base::PolygonIndex polygon, base::Corners v) {
      for (const VertexIndex vertex : v) polygonOf_[vertex] = polygon;
      addMiddle(mesh.made.sourceOf(polygon), polygon);
    });
    addNearest(job);
  }

  /// Adds a point by its number in distance::Deviation::farPoints.
  void addFar(std::uint64_t number) {
    const std::size_t vertices = base_.mesh.positions.size();
    if (number < vertices) {
      addVertex(static_cast<VertexIndex>(number));
      return;
    }
    // At a boundary of the mesh, some of the corners have no polygons.
    const auto quad = static_cast<std::uint32_t>(number - vertices);
    for (const VertexIndex corner : base_.mesh.quads[quad].vertices) {
      const std::uint32_t polygon = polygonOf_[mesh_.cut.vertexOf[corner]];
      if (polygon == octree::kNone) continue;
      addMiddle(quad, polygon);
      return;
    }
  }
  [[nodiscard]] const std::vector<Sample>& all() const { return samples_; }

 private:
  void addMiddle(std::uint32_t quad, std::uint32_t polygon) {
    const auto& v = base_.mesh.quads[quad].vertices;
    const Vec3 middle = (Vec3(base_.mesh.positions[v[0]]) + Vec3(base_.mesh.positions[v[2]])) * 0.5;
    samples_.push_back({{middle[0], middle[1], middle[2]}, base_.mesh.normals[v[0]], polygon});
  }
  void addVertex(VertexIndex vertex) {
    samples_.push_back({base_.mesh.positions[vertex], base_.mesh.normals[vertex],
                        polygonOf_[mesh_.cut.vertexOf[vertex]]});
  }
  void addNearest(base::Job& job) {
    const Mesh& own = mesh_.made.mesh;
    std::vector<VertexIndex> nearest(own.positions.size());
    std::vector<double> least(own.positions.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < base_.mesh.positions.size(); ++i) {
      job.pollCancelled(i);
      const VertexIndex to = mesh_.cut.vertexOf[i];
      const double squared =
          (Vec3(base_.mesh.positions[i]) - Vec3(own.positions[to])).squaredLength();
      if (squared >= least[to]) continue;
      least[to] = squared;
      nearest[to] = static_cast<VertexIndex>(i);
    }
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      if (polygonOf_[i] != octree::kNone) addVertex(nearest[i]);
    }
  }

  const uniform::SurfaceView base_;
  const Measured& mesh_;
  std::vector<std::uint32_t> polygonOf_;  // one around each vertex
  std::vector<Sample> samples_;
};

// The uniform vertices of a point, by its number in distance::Deviation::farPoints.
std::span<const VertexIndex> verticesOfPoint(const uniform::SurfaceView& base, std::uint64_t point,
                                             VertexIndex& own) {
  const std::size_t vertices = base.mesh.positions.size();
  if (point >= vertices) return base.mesh.quads[point - vertices].vertices;
  own = static_cast<VertexIndex>(point);
  return {&own, 1};
}

// Marks the vertices around uniform points.
void markAround(const uniform::SurfaceView& base, const Measured& mesh,
                const std::vector<std::uint64_t>& points, std::vector<std::uint8_t>& marks) {
  for (const std::uint64_t point : points) {
    VertexIndex vertex = 0;
    for (const VertexIndex corner : verticesOfPoint(base, point, vertex)) {
      marks[mesh.cut.vertexOf[corner]] = 1;
    }
  }
}

// Marks vertices of polygons that protrude or intersect, and those around uniform points that are
// too far. While `soft`, the latter are left to samples; a mesh of a given number of triangles has
// no tolerance, so afterwards nothing is too far.
std::vector<std::uint8_t> findFaulty(const uniform::SurfaceView& base, const Measured& mesh,
                                     bool soft, bool counted) {
  std::vector<std::uint8_t> faulty(mesh.cut.clusters.size(), 0);
  for (const VertexIndex vertex : mesh.meeting) faulty[vertex] = 1;
  if (!soft && counted) return faulty;
  for (const VertexIndex vertex : mesh.deviation.protruding) faulty[vertex] = 1;
  if (!soft) markAround(base, mesh, mesh.deviation.farPoints, faulty);
  return faulty;
}

// Forgives faults that are not beside anything collapsed or flipped: the mesh had them before.
void forgiveOthers(const uniform::SurfaceView& base, const Collapsed& collapsed, Measured& mesh) {
  std::vector<std::uint8_t> own(collapsed.members.size(), 0);
  for (std::size_t i = 0; i < own.size(); ++i) own[i] = collapsed.members[i] > 1 ? 1 : 0;
  for (const VertexIndex vertex : collapsed.turned) own[vertex] = 1;
  own = topology::dilate(mesh.made.mesh, std::move(own), 1);
  const auto isOther = [&](VertexIndex vertex) { return own[vertex] == 0; };
  std::erase_if(mesh.meeting, isOther);
  std::erase_if(mesh.deviation.protruding, isOther);
  std::erase_if(mesh.deviation.farPoints, [&](std::uint64_t point) {
    VertexIndex vertex = 0;
    const auto vertices = verticesOfPoint(base, point, vertex);
    return std::all_of(vertices.begin(), vertices.end(),
                       [&](VertexIndex i) { return isOther(mesh.cut.vertexOf[i]); });
  });
}

// Marks the last collapses behind each faulty vertex and its neighbours within `rings`, or within
// as many more rings as it takes to find any. Their number doubles with each failure of a vertex
// before the collapse. False if there are none.
bool rollBack(const Collapsed& collapsed, const Mesh& mesh, std::vector<std::uint8_t> faulty,
              int rings, std::vector<std::uint8_t>& failures,
              std::vector<std::uint8_t>& rolledBack) {
  rolledBack.assign(collapsed.steps.size(), 0);
  faulty = topology::dilate(mesh, std::move(faulty), rings);
  for (int wider = 0; wider < kMostRings;
       ++wider, faulty = topology::dilate(mesh, std::move(faulty), 1)) {
    std::vector<std::uint64_t> left(collapsed.members.size());
    for (std::size_t i = 0; i < failures.size(); ++i) {
      const VertexIndex vertex = collapsed.vertexOf[i];
      if (faulty[vertex] == 0) continue;
      left[vertex] = std::max(left[vertex], std::uint64_t{1} << failures[i]);
      failures[i] = static_cast<std::uint8_t>(std::min(failures[i] + 1, kMostFailures));
    }
    bool any = false;
    for (std::size_t i = collapsed.steps.size(); i-- > 0;) {
      std::uint64_t& count = left[collapsed.vertexOf[collapsed.steps[i].keep]];
      if (count == 0) continue;
      --count;
      rolledBack[i] = 1;
      any = true;
    }
    if (any) return true;
  }
  return false;
}

// Locks the vertices of rolled-back collapses, so that they are not collapsed in another way.
void keepRolledBack(const Collapsed& collapsed, Bounds& bounds) {
  bounds.locked.resize(bounds.budget.size(), 0);
  for (std::size_t i = 0; i < bounds.rolledBack.size(); ++i) {
    if (bounds.rolledBack[i] == 0) continue;
    bounds.locked[collapsed.steps[i].keep] = 1;
    bounds.locked[collapsed.steps[i].drop] = 1;
  }
}

// Multiplies the error budgets of all that went into faulty vertices by their shares, and squares
// the shares. False if no budget was left.
bool takeBudget(const Collapsed& collapsed, const std::vector<std::uint8_t>& faulty,
                std::vector<float>& shares, std::vector<float>& budget) {
  bool any = false;
  for (std::size_t i = 0; i < budget.size(); ++i) {
    if (faulty[collapsed.vertexOf[i]] == 0 || !(budget[i] > 0)) continue;
    any = true;
    budget[i] *= shares[i];
    shares[i] *= shares[i];
  }
  return any;
}

// Forbids edge flips at all that went into faulty vertices. Whether there had been one.
bool lockAround(const Collapsed& collapsed, const std::vector<std::uint8_t>& faulty,
                std::vector<float>& turning) {
  std::vector<std::uint8_t> turned(faulty.size(), 0);
  for (const VertexIndex vertex : collapsed.turned) turned[vertex] = faulty[vertex];
  bool any = false;
  for (std::size_t i = 0; i < turning.size(); ++i) {
    if (turned[collapsed.vertexOf[i]] == 0 || !(turning[i] > 0)) continue;
    turning[i] = 0;
    any = true;
  }
  return any;
}

// Makes `mesh` what becomes of `from` by a collapse, in terms of the uniform mesh.
void compose(const Measured& from, const Collapsed& collapsed, bool keepAltered, Measured& mesh,
             base::Job& job) {
  // The largest array is reused.
  std::vector<VertexIndex> baseVertices = std::move(mesh.cut.vertexOf);
  mesh = {};
  mesh.cut.vertexOf = std::move(baseVertices);
  const std::vector<VertexIndex>& vertexOf = collapsed.vertexOf;
  if (mesh.cut.vertexOf.empty()) {
    base::resizeLarge(mesh.cut.vertexOf, from.cut.vertexOf.size(), job);
  }
  job.forRanges(from.cut.vertexOf.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      mesh.cut.vertexOf[i] = vertexOf[from.cut.vertexOf[i]];
    }
  });
  mesh.cut.clusters.resize(collapsed.mesh.positions.size());
  for (std::size_t i = 0; i < vertexOf.size(); ++i) {
    mesh.cut.clusters[vertexOf[i]] = from.cut.clusters[i];
  }
  for (std::size_t i = 0; i < mesh.cut.clusters.size(); ++i) {
    if (collapsed.members[i] > 1) mesh.cut.clusters[i].level = kJoined;
  }
  for (const VertexIndex vertex : collapsed.turned) mesh.cut.clusters[vertex].level = kJoined;
  mesh.altered = collapsed.turned;
  if (keepAltered) {
    for (const VertexIndex vertex : from.altered) mesh.altered.push_back(vertexOf[vertex]);
  }
  const std::size_t quads = collapsed.mesh.quads.size();
  for (std::size_t i = 0; i < collapsed.sources.size(); ++i) {
    (i < quads ? mesh.made.quadSources : mesh.made.triangleSources)
        .push_back(from.made.sourceOf(collapsed.sources[i]));
  }
  mesh.made.mesh = collapsed.mesh;
}

// Marks the vertices around which something differs from the repaired result of the collapse
// before: other clusters, edges flipped then or now, quads that repair flipped, polygons that still
// intersected, and all near what was `tooFar`, which repair may have caused.
std::vector<std::uint8_t> findFresh(const Collapsed& before, const Measured& was,
                                    const std::vector<std::uint8_t>& tooFar, const Collapsed& now) {
  std::vector<std::uint8_t> other = topology::dilate(was.made.mesh, tooFar, kRingsAnew);
  for (const VertexIndex vertex : was.meeting) other[vertex] = 1;
  std::vector<std::uint8_t> fresh(now.members.size(), 0);
  for (const VertexIndex vertex : before.turned) other[vertex] = 1;
  for (std::size_t i = 0; i < before.mesh.quads.size(); ++i) {
    const Quad& quad = before.mesh.quads[i];
    if (quad == was.made.mesh.quads[i]) continue;
    for (const VertexIndex vertex : quad.vertices) other[vertex] = 1;
  }
  for (const VertexIndex vertex : now.turned) fresh[vertex] = 1;
  for (std::size_t i = 0; i < now.vertexOf.size(); ++i) {
    const VertexIndex from = before.vertexOf[i], to = now.vertexOf[i];
    if (other[from] != 0 || before.members[from] != now.members[to] ||
        !(before.mesh.positions[from] == now.mesh.positions[to])) {
      fresh[to] = 1;
    }
  }
  return fresh;
}

// Moves the vertices that are not fresh to where repair had moved them. Whether there are any.
bool moveAsRepaired(const Collapsed& before, const Mesh& repaired, const Collapsed& now,
                    const std::vector<std::uint8_t>& fresh, Measured& mesh) {
  bool any = false;
  for (std::size_t i = 0; i < now.vertexOf.size(); ++i) {
    const VertexIndex from = before.vertexOf[i], to = now.vertexOf[i];
    Position& position = mesh.made.mesh.positions[to];
    if (fresh[to] != 0 || position == repaired.positions[from]) continue;
    position = repaired.positions[from];
    mesh.altered.push_back(to);
    any = true;
  }
  return any;
}

}  // namespace

Measured simplifyCut(const uniform::SurfaceView& base, const Measured& mesh, octree::CutRule& rule,
                     const Goal& goal, const Repair* repair, distance::Certifier& certifier,
                     base::Job& job) {
  const std::vector<base::Quadric> planes = gatherPlanes(base, mesh, job);
  Samples samples(base, mesh, job);
  Bounds bounds;
  bounds.distance = [&certifier](const Vec3& point, const Vec3& normal, double enough) {
    return certifier.distanceToBase(point, normal, enough);
  };
  bounds.triangles = goal.triangles;
  bounds.rim = goal.rim;
  bounds.mayLie = goal.mayLie;
  const double tolerance = rule.tolerance;
  for (const Position& p : mesh.made.mesh.positions) {
    const double least = std::max(0.0, distance::toleranceAt(rule, base.affine, Vec3(p)));
    bounds.budget.push_back(static_cast<float>(kFirstShare * least * base.affine.voxelSize()));
  }
  for (const VertexIndex vertex : goal.fixed) bounds.budget[vertex] = 0;
  bounds.turning = bounds.budget;
  std::vector<float> shares(bounds.budget.size(), kLess);
  std::vector<std::uint8_t> failures(bounds.budget.size(), 0);
  std::vector<std::uint64_t> farBefore;
  Collapsed collapsed;
  Measured result;
  int rollBackRounds = 0;
  bool keepRepaired = true;
  std::vector<std::uint8_t> tooFar;  // vertices, in the round before
  for (int round = 1;; ++round) {
    bounds.samples = samples.all();
    Collapsed next = collapse(mesh.made.mesh, planes, bounds, job);
    const bool anew = round == 1 || !keepRepaired;
    const std::vector<std::uint8_t> fresh =
        anew ? std::vector<std::uint8_t>() : findFresh(collapsed, result, tooFar, next);
    const Mesh repaired = std::move(result.made.mesh);
    rule.tolerance = tolerance * next.budgetScale;
    certifier.setRule(rule);
    compose(mesh, next, !goal.fixed.empty(), result, job);
    const bool kept = !anew && moveAsRepaired(collapsed, repaired, next, fresh, result);
    collapsed = std::move(next);
    const std::size_t count = result.made.mesh.triangleCount();
    if (goal.giveUp > 0 && count >= goal.giveUp) return result;
    repairAndMeasure(certifier, repair, result, job, fresh);
    if (!goal.fixed.empty()) forgiveOthers(base, collapsed, result);
    for (const std::uint64_t point : result.deviation.farPoints) samples.addFar(point);
    // More rounds do not help points that stay too far although they are samples.
    const std::vector<std::uint64_t>& far = result.deviation.farPoints;
    const bool same = !far.empty() && far == farBefore && result.deviation.protruding.empty();
    const bool soft = round < kSoftRounds && !same;
    farBefore = far;
    std::vector<std::uint8_t> faulty = findFaulty(base, result, soft, goal.triangles > 0);
    tooFar.assign(faulty.size(), 0);
    for (const VertexIndex vertex : result.deviation.protruding) tooFar[vertex] = 1;
    markAround(base, result, far, tooFar);
    bool any = soft && !result.deviation.farPoints.empty();
    if (soft) {
      any |= takeBudget(collapsed, faulty, shares, bounds.budget);
    }
    bounds.rolledBack.clear();
    const auto rollBackFaulty = [&] {
      const int rings = std::max(0, rollBackRounds - kRollBackRounds) / kRoundsPerRing;
      any = rollBack(collapsed, result.made.mesh, faulty, rings, failures, bounds.rolledBack);
      keepRolledBack(collapsed, bounds);
      bounds.onlyRepeat = ++rollBackRounds > kRollBackRounds;
    };
    if (!any) rollBackFaulty();
    // Beside fixed vertices the mesh may be open, and directions are not defined.
    const bool closed = goal.fixed.empty() && base.topology.openEdges == 0;
    if (!any && repair != nullptr && closed) {
      for (const VertexIndex vertex : topology::findMisplaced(result.made.mesh, job))
        faulty[vertex] = 1;
      rollBackFaulty();
    }
    any |= lockAround(collapsed, faulty, bounds.turning);
    bounds.before = &collapsed;
    if (!any && kept && std::find(faulty.begin(), faulty.end(), 1) != faulty.end()) {
      // No collapse is left to roll back there: the fault is in what repair moved and was kept.
      keepRepaired = false;
      continue;
    }
    if (!any || (!goal.fixed.empty() && round >= kRoundsBesideFixed)) return result;
  }
}

}  // namespace tufa::refine
