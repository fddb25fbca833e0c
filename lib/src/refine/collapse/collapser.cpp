#include "refine/collapse/collapser.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tufa::refine {

using base::FlatTriangle;

namespace {

// Weight of an edge's squared length beside its error, so that flat places, where all errors are 0,
// are thinned evenly.
constexpr double kLengthShare = 1e-4;
// An edge whose root mean square error is above this share of its budget is mostly refused by a
// sample. It waits for a larger budget.
constexpr double kHopeful = 0.6;
// Cosine of the angle up to which a sample's normal and a triangle's belong to one sheet.
constexpr double kOneSide = 0.9;
// A sample above the triangle it was on, no farther than this share of the squared budget, stays on
// it without a search.
constexpr double kSurelyNear = 0.25;

}  // namespace

CollapseState::CollapseState(const Mesh& mesh_, const std::vector<base::Quadric>& planes_,
                             const Bounds& bounds_)
    : given(mesh_),
      bounds(bounds_),
      mesh(mesh_),
      planes(planes_),
      budget(bounds_.budget),
      rim(bounds_.rim),
      joined(mesh_.positions.size(), 0),
      changed(mesh_.positions.size(), 0),
      versions(mesh_.positions.size(), 0),
      samples(mesh.cornerCount() / 3, bounds_.samples.size()) {
  for (std::uint32_t i = 0; i < mesh.vertexCount(); ++i) {
    if (mesh.isOnBoundary(i)) budget[i] = 0;
  }
}

void Collapser::proposeAround(VertexIndex vertex, bool behind) {
  state_.mesh.collectNeighbours(vertex, around_);
  for (const VertexIndex other : around_) {
    if (!behind || state_.mesh.isBefore(vertex, other)) propose(vertex, other);
  }
}

// An edge whose root mean square error exceeds the budget is not queued. All other tests wait until
// it comes out of the queue.
void Collapser::propose(VertexIndex a, VertexIndex b) {
  if (state_.mesh.isBefore(b, a)) std::swap(a, b);
  const double budget = budgetAt(a, b);
  if (!(budget > 0) || isLocked(a) || isLocked(b)) return;
  if (regions_.inner[a] == 0 || regions_.inner[b] == 0) {
    postponed_.emplace_back(a, b);
    return;
  }
  const Edge edge = solve(a, b);
  // Without a number of triangles to reach, a larger budget follows.
  const bool mayWait = state_.budgetScale < 1 && state_.bounds.triangles == 0;
  const double most = mayWait ? kHopeful * budget : budget;
  if (edge.error > most * most * edge.sum.count) {
    tooFar_ = true;
    return;
  }
  const double squaredLength = (state_.mesh.point(a) - state_.mesh.point(b)).squaredLength();
  queue_.push(edge.error + kLengthShare * squaredLength,
              {a, b, state_.versions[a], state_.versions[b]});
}

void Collapser::run(std::size_t most, base::Job& job) {
  // Entries whose ends have changed are outdated: the edges around a new vertex are queued again.
  constexpr std::size_t kBetweenLooks = 512;
  const std::size_t before = steps_.size();
  EdgeQueue::Entry best{};
  for (std::size_t i = 0; steps_.size() - before < most && queue_.pop(best); ++i) {
    if (i % kBetweenLooks == 0) job.checkCancelled(0, 1);
    if (best.versionA != state_.versions[best.a] || best.versionB != state_.versions[best.b]) {
      continue;
    }
    const Edge edge = solve(best.a, best.b);
    double reach = 0;
    if (!canCollapse(edge, reach)) continue;
    join(edge, reach, true);
    proposeAround(edge.a, false);
  }
}

void Collapser::repeat(std::span<const Step> steps, std::span<const std::uint8_t> rolledBack,
                       base::Job& job) {
  steps_.reserve(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    job.pollCancelled(i);
    const bool isRolledBack = !rolledBack.empty() && rolledBack[i] != 0;
    if (!isRolledBack && repeatStep(steps[i])) continue;
    state_.changed[steps[i].keep] = 1;
    state_.changed[steps[i].drop] = 1;
  }
}

// Repeats one collapse, if its ends and all around them are as they were, and its distances are
// within the budget. Only where samples are attached, which may be new, are distances tested again.
bool Collapser::repeatStep(const Step& step) {
  const std::vector<std::uint8_t>& changed = state_.changed;
  if (changed[step.keep] != 0 || changed[step.drop] != 0) return false;
  if (static_cast<double>(step.reach) > budgetAt(step.keep, step.drop)) return false;
  if (state_.budget[step.keep] <= 0 || state_.budget[step.drop] <= 0) return false;
  bool same = true, sampled = false;
  for (const VertexIndex own : {step.keep, step.drop}) {
    state_.mesh.forTriangles(own, [&](std::uint32_t t, VertexIndex x, VertexIndex) {
      same &= changed[x] == 0;
      sampled |= state_.samples.front(t) != kNone;
    });
  }
  if (!same) return false;
  Edge edge{step.keep, step.drop, step.point, Vec3(0.0), 0, {}};
  edge.sum = joined(edge.a, edge.b, edge.point);
  auto reach = static_cast<double>(step.reach);
  if (sampled) {
    if (!ring_.collect(state_.mesh, edge.a, edge.b, edge.point, edge.sum.normals)) return false;
    if (!samplesStayNear(edge, reach)) return false;
  }
  join(edge, reach, sampled);
  return true;
}

double Collapser::budgetAt(VertexIndex a, VertexIndex b) const {
  return state_.budgetScale * static_cast<double>(std::min(state_.budget[a], state_.budget[b]));
}

bool Collapser::isLocked(VertexIndex vertex) const {
  return !state_.bounds.locked.empty() && state_.bounds.locked[vertex] != 0;
}

// The planes of both ends, in coordinates counted from `point`.
base::Quadric Collapser::joined(VertexIndex a, VertexIndex b, const Vec3& point) const {
  base::Quadric planes = state_.planes[a].translatedTo(point - state_.mesh.point(a));
  planes += state_.planes[b].translatedTo(point - state_.mesh.point(b));
  return planes;
}

// What an edge would become. The least point is rejected if it lies farther from the middle than
// the edge is long, as for nearly parallel planes; the sum keeps the middle as its origin.
Collapser::Edge Collapser::solve(VertexIndex a, VertexIndex b) const {
  const Vec3 &pa = state_.mesh.point(a), &pb = state_.mesh.point(b);
  const Vec3 middle = (pa + pb) * 0.5;
  const base::Quadric planes = joined(a, b, middle);
  Vec3 offset = leastPoint(planes);
  const bool near = offset.squaredLength() <= (pa - pb).squaredLength();
  if (!near || (state_.bounds.mayLie && !state_.bounds.mayLie(a, middle + offset)))
    offset = Vec3(0.0);
  return {a, b, middle + offset, offset, planes.at(offset), planes};
}

// All guards, the cheapest and most often failing first. `reach` receives the largest distance
// found.
bool Collapser::canCollapse(const Edge& edge, double& reach) {
  reach = edge.sum.count > 0 ? std::sqrt(edge.error / edge.sum.count) : 0;
  if (!state_.rim.mayJoin(edge.a, edge.b) || !link_.mayCollapse(state_.mesh, edge.a, edge.b) ||
      !ring_.collect(state_.mesh, edge.a, edge.b, edge.point, edge.sum.normals)) {
    return false;
  }
  bool near = samplesStayNear(edge, reach);
  if (near && !ring_.staysUnfolded(state_.mesh)) return false;
  near = near && ringStaysNear(edge, reach);
  tooFar_ |= !near;
  return near;
}

// Whether all samples of the triangles around the edge are within budget of the ring. Notes for
// each the nearest triangle of the ring, and which triangles have samples of several sheets.
bool Collapser::samplesStayNear(const Edge& edge, double& reach) {
  const double budget = budgetAt(edge.a, edge.b), enough = budget * budget;
  // A sample that failed is moved to the front, as it mostly fails again.
  for (const std::uint32_t t : ring_.star()) {
    const std::uint32_t i = state_.samples.front(t);
    if (i != kNone && !ring_.isNear(Vec3(state_.bounds.samples[i].point), enough)) return false;
  }
  attached_.clear();
  sheets_.assign(ring_.shapes().size(), Sides::None);
  nearestSample_ = kNone;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  std::size_t next = 0;
  for (const std::uint32_t t : ring_.star()) {
    const bool stays = next < ring_.triangles().size() && ring_.triangles()[next] == t;
    const std::size_t first = stays ? next++ : 0;
    std::uint32_t before = kNone;
    for (std::uint32_t i = state_.samples.front(t); i != kNone;
         before = i, i = state_.samples.after(i)) {
      const Vec3 at = Vec3(state_.bounds.samples[i].point);
      const auto [triangle, squared] = ring_.nearest(at, first, kSurelyNear * enough);
      if (squared > enough) {
        if (before != kNone) state_.samples.moveToFront(i, before, t);
        return false;
      }
      farthest = std::max(farthest, squared);
      attached_.emplace_back(i, ring_.triangles()[triangle]);
      const Normal& n = state_.bounds.samples[i].normal;
      const bool own = Vec3(n).dot(ring_.shapes()[triangle].normal()) > kOneSide;
      Sides& sheets = sheets_[triangle];
      sheets = own && sheets != Sides::Several ? Sides::One : Sides::Several;
      const double apart = (at - edge.point).squaredLength();
      if (apart >= nearest) continue;
      nearest = apart;
      nearestSample_ = i;
    }
  }
  reach = std::max(reach, std::sqrt(farthest));
  return true;
}

// The other direction, from the ring to the surface. Where all samples are of one sheet, the plane
// of the nearest one tells the distance of the new vertex; beside a crease, where that plane ends,
// the uniform mesh is measured at the new vertex and at the middles of triangles and edges.
bool Collapser::ringStaysNear(const Edge& edge, double& reach) const {
  const double budget = budgetAt(edge.a, edge.b);
  const bool smooth = std::none_of(sheets_.begin(), sheets_.end(),
                                   [](Sides sheets) { return sheets == Sides::Several; });
  if (smooth) {
    if (nearestSample_ == kNone) return true;
    const Sample& sample = state_.bounds.samples[nearestSample_];
    const double height = std::abs(Vec3(sample.normal.x, sample.normal.y, sample.normal.z)
                                       .dot(edge.point - Vec3(sample.point)));
    reach = std::max(reach, height);
    return height <= budget;
  }
  const auto isNear = [&](const Vec3& point, const Vec3& normal) {
    const double distance = state_.bounds.distance(point, normal, budget);
    reach = std::max(reach, distance);
    return distance <= budget;
  };
  Vec3 sum(0.0);
  for (const FlatTriangle& triangle : ring_.shapes()) sum += triangle.normal();
  sum.normalize();
  if (!isNear(edge.point, sum)) return false;
  for (std::size_t i = 0; i < sheets_.size(); ++i) {
    if (sheets_[i] == Sides::One) continue;
    const FlatTriangle& triangle = ring_.shapes()[i];
    const Vec3& p = triangle.corner(0);
    const Vec3& x = triangle.corner(1);
    const Vec3& y = triangle.corner(2);
    if (!isNear((p + x + y) / 3.0, triangle.normal())) return false;
    if (!isNear((p + x) * 0.5, triangle.normal())) return false;
    if (!isNear((p + y) * 0.5, triangle.normal())) return false;
  }
  return true;
}

// Collapses the edge. `moved`: samples go where samplesStayNear() found.
void Collapser::join(const Edge& edge, double reach, bool moved) {
  steps_.push_back({edge.a, edge.b, edge.point, static_cast<float>(reach)});
  state_.planes[edge.a] = edge.sum.translatedTo(edge.offset);
  state_.budget[edge.a] = std::min(state_.budget[edge.a], state_.budget[edge.b]);
  state_.mesh.collapse(edge.a, edge.b, edge.point);
  state_.rim.join(edge.a, edge.b);
  if (moved) {
    for (const std::uint32_t t : ring_.star()) state_.samples.clear(t);
    for (const auto& [sample, t] : attached_) state_.samples.attach(sample, t);
  }
  state_.joined[edge.a] = 1;
  ++state_.versions[edge.a];
  ++state_.versions[edge.b];
}

}  // namespace tufa::refine
