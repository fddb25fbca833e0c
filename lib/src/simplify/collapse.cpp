#include "simplify/collapse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "simplify/edge_mesh.h"
#include "simplify/edge_queue.h"
#include "simplify/ring.h"
#include "simplify/sample_lists.h"
#include "simplify/turn_needles.h"

namespace tufa::simplify {
namespace {

using base::FlatTriangle;
using openvdb::Vec3d;

// Weight of an edge's squared length beside its error, so that flat places are thinned evenly.
constexpr double kLengthShare = 1e-4;
// Cosine of the angle up to which a sample's normal and a triangle's belong to one side.
constexpr double kOneSide = 0.9;
// What lies above the triangle it was on, no farther than this share of the freedom, squared,
// stays.
constexpr double kSurelyNear = 0.25;
// Edges are collapsed with this share of the freedom first: what would cost more waits. Then with
// so many times more, up to all of it. Meshes of so few triangles go in smaller steps.
constexpr double kFirstFreedom = 0.4, kMoreFreedom = 2.5;
constexpr std::size_t kFewTriangles = 30000;
constexpr double kFirstFreedomOfFew = 0.3, kMoreFreedomOfFew = 1.5;
// Freedom for a number of triangles grows by this factor at a time, by the larger one where that
// gave less than this share of the triangles, up to so much.
constexpr double kLooser = 1.25;
constexpr double kMuchLooser = 2;
constexpr double kLittle = 0.01;
constexpr double kLoosest = 1e9;

Vec3d vectorOf(const Position& p) { return {p.x, p.y, p.z}; }

class Collapser {
 public:
  Collapser(const Mesh& mesh, const std::vector<PlaneSum>& planes, const Bounds& bounds)
      : given_(mesh),
        bounds_(bounds),
        mesh_(mesh),
        planes_(planes),
        allowed_(bounds.allowed),
        rim_(bounds.rim),
        joined_(mesh.positions.size(), 0),
        version_(mesh.positions.size(), 0),
        samples_(mesh_.cornerCount() / 3, bounds.samples.size()) {
    for (std::uint32_t i = 0; i < mesh_.vertexCount(); ++i) {
      if (mesh_.isOnBoundary(i)) allowed_[i] = 0;
    }
  }

  void run(base::Job& job) {
    const std::size_t all = mesh_.triangleCount();
    const bool few = all < kFewTriangles;
    if (bounds_.before != nullptr) {
      repeat(*bounds_.before, job);
    } else {
      attachFrom(0, job);
    }
    if (bounds_.onlyRepeat) return;
    if (bounds_.before == nullptr && bounds_.triangles == 0)
      looseness_ = few ? kFirstFreedomOfFew : kFirstFreedom;
    for (bool anew = bounds_.before == nullptr;; anew = true) {
      const std::size_t start = mesh_.triangleCount();
      tooFar_ = false;
      proposeAll(anew, job);
      constexpr std::size_t kBetweenLooks = 512;
      EdgeQueue::Entry best{};
      for (std::size_t steps = 0; mesh_.triangleCount() > bounds_.triangles && queue_.pop(best);
           ++steps) {
        if (steps % kBetweenLooks == 0) job.look(all - mesh_.triangleCount(), all);
        if (best.versionA != version_[best.a] || best.versionB != version_[best.b]) continue;
        const Edge edge = solve(best.a, best.b);
        double reach = 0;
        if (canCollapse(edge, reach)) apply(edge, reach);
      }
      const std::size_t left = mesh_.triangleCount();
      if (bounds_.triangles == 0) {
        if (looseness_ >= 1) return;
        looseness_ = std::min(1.0, looseness_ * (few ? kMoreFreedomOfFew : kMoreFreedom));
        continue;
      }
      if (left <= bounds_.triangles) return;
      if (anew && !tooFar_) return;  // more freedom is of no use
      const bool little = static_cast<double>(start - left) < kLittle * static_cast<double>(start);
      looseness_ *= anew && little ? kMuchLooser : kLooser;
      if (looseness_ > kLoosest) return;
    }
  }

  [[nodiscard]] Collapsed result() {
    Collapsed out;
    out.looseness = looseness_;
    const std::vector<std::uint8_t> turned = turnThin();
    out.sampleTriangles = samples_.triangles();
    out.steps = std::move(steps_);
    const auto vertices = static_cast<std::uint32_t>(mesh_.vertexCount());
    std::vector<VertexIndex> numbers(vertices, kNone);
    for (std::uint32_t i = 0; i < vertices; ++i) {
      if (!mesh_.isRoot(i)) continue;
      numbers[i] = static_cast<VertexIndex>(out.mesh.positions.size());
      const Vec3d& p = mesh_.point(i);
      out.mesh.positions.emplace_back(p[0], p[1], p[2]);
      out.mesh.normals.push_back(normalOf(i));
    }
    out.members.resize(out.mesh.positions.size());
    out.vertexOf.resize(vertices);
    for (std::uint32_t i = 0; i < vertices; ++i) {
      out.vertexOf[i] = numbers[mesh_.rootOf(i)];
      ++out.members[out.vertexOf[i]];
    }
    const auto corner = [&](std::size_t i) { return numbers[mesh_.corner(i)]; };
    std::vector<std::uint32_t> sources;
    const auto addTriangle = [&](std::size_t t, std::uint32_t polygon) {
      out.mesh.triangles.emplace_back(corner(t), corner(t + 1), corner(t + 2));
      sources.push_back(polygon);
      if (turned[t / 3] == 0) return;
      const auto& v = out.mesh.triangles.back().vertices;
      out.turned.insert(out.turned.end(), v.begin(), v.end());
    };
    for (std::uint32_t polygon = 0; polygon < given_.quads.size(); ++polygon) {
      const std::size_t t = std::size_t{6} * polygon;
      const bool first = mesh_.isAlive(t), second = mesh_.isAlive(t + 3);
      if (first && second && turned[t / 3] == 0 && turned[t / 3 + 1] == 0 && !isOfFour(t)) {
        out.mesh.quads.emplace_back(corner(t), corner(t + 1), corner(t + 2), corner(t + 5));
        out.sources.push_back(polygon);
        continue;
      }
      if (first) addTriangle(t, polygon);
      if (second) addTriangle(t + 3, polygon);
    }
    for (std::size_t i = 0; i < given_.triangles.size(); ++i) {
      const std::size_t t = 6 * given_.quads.size() + 3 * i;
      if (mesh_.isAlive(t)) {
        addTriangle(t, static_cast<std::uint32_t>(given_.quads.size() + i));
      }
    }
    out.sources.insert(out.sources.end(), sources.begin(), sources.end());
    return out;
  }

 private:
  struct Edge {
    VertexIndex a, b;
    Vec3d point;   ///< that takes the place of both
    Vec3d offset;  ///< from where `sum` is seen to the point
    double error;  ///< sum of squared distances of the point to the planes
    PlaneSum sum;  ///< the planes of both
  };

  // Turns edges of the result, and marks triangles that were turned. What is kept for a next
  // collapse is of the mesh before.
  std::vector<std::uint8_t> turnThin() {
    if (bounds_.turning.empty()) return std::vector<std::uint8_t>(mesh_.cornerCount() / 3, 0);
    std::vector<double> allowed(mesh_.vertexCount(), std::numeric_limits<double>::infinity());
    for (std::uint32_t i = 0; i < allowed.size(); ++i) {
      double& own = allowed[mesh_.rootOf(i)];
      own = std::min(own, looseness_ * static_cast<double>(bounds_.turning[i]));
      if (mesh_.isRoot(i) && mesh_.isOnBoundary(i)) own = 0;
    }
    return turnNeedles(mesh_, bounds_, allowed, samples_);
  }

  // Whether the quad of two triangles is half of four that are a closed surface. Two quads would
  // have the same corners.
  [[nodiscard]] bool isOfFour(std::size_t t) const {
    return mesh_.degree(mesh_.corner(t)) == 3 && mesh_.degree(mesh_.corner(t + 1)) == 3 &&
           mesh_.degree(mesh_.corner(t + 2)) == 3;
  }

  [[nodiscard]] double allowedAt(VertexIndex a, VertexIndex b) const {
    return looseness_ * static_cast<double>(std::min(allowed_[a], allowed_[b]));
  }

  [[nodiscard]] bool isFirm(VertexIndex vertex) const {
    return !bounds_.firm.empty() && bounds_.firm[vertex] != 0;
  }

  [[nodiscard]] Normal normalOf(VertexIndex vertex) const {
    Vec3d sum = planes_[vertex].normals;
    if (joined_[vertex] == 0 || !sum.normalize()) return given_.normals[vertex];
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
  }

  // Collapses again what was collapsed before, in the same order, except where a new sample or less
  // freedom forbids it, or the mesh around is no longer as it was then. What is around may then be
  // collapsed in another way.
  void repeat(const Collapsed& before, base::Job& job) {
    looseness_ = before.looseness;
    changed_.assign(mesh_.vertexCount(), 0);
    const std::size_t known = before.sampleTriangles.size();
    attachFrom(known, job);
    steps_.reserve(before.steps.size());
    for (std::size_t i = 0; i < before.steps.size(); ++i) {
      job.lookAtTimes(i);
      const Step& step = before.steps[i];
      const bool undone = !bounds_.undone.empty() && bounds_.undone[i] != 0;
      if (!undone && repeatStep(step)) continue;
      changed_[step.keep] = 1;
      changed_[step.drop] = 1;
    }
    for (std::uint32_t i = 0; i < known; ++i) {
      const std::uint32_t t = before.sampleTriangles[i];
      const bool same = mesh_.isAlive(t) && changed_[mesh_.corner(t)] == 0 &&
                        changed_[mesh_.corner(t + 1)] == 0 && changed_[mesh_.corner(t + 2)] == 0;
      samples_.attach(i, same ? t : locate(i));
    }
  }

  bool repeatStep(const Step& step) {
    if (changed_[step.keep] != 0 || changed_[step.drop] != 0) return false;
    if (static_cast<double>(step.reach) > allowedAt(step.keep, step.drop)) return false;
    if (allowed_[step.keep] <= 0 || allowed_[step.drop] <= 0) return false;
    bool same = true, sampled = false;
    for (const VertexIndex own : {step.keep, step.drop}) {
      mesh_.forTriangles(own, [&](std::uint32_t t, VertexIndex x, VertexIndex) {
        same &= changed_[x] == 0;
        sampled |= samples_.front(t) != kNone;
      });
    }
    if (!same) return false;
    Edge edge{step.keep, step.drop, step.point, Vec3d(0.0), 0, {}};
    edge.sum = joined(edge.a, edge.b, edge.point);
    auto reach = static_cast<double>(step.reach);
    if (sampled) {
      if (!ring_.collect(mesh_, edge.a, edge.b, edge.point, edge.sum.normals)) return false;
      if (!samplesStayNear(edge, reach)) return false;
    }
    join(edge, reach, sampled);
    return true;
  }

  // Puts the samples from `first` on onto their triangles.
  void attachFrom(std::size_t first, base::Job& job) {
    for (std::size_t i = first; i < bounds_.samples.size(); ++i) {
      job.lookAtTimes(i);
      const auto sample = static_cast<std::uint32_t>(i);
      samples_.attach(sample, locate(sample));
    }
  }
  [[nodiscard]] std::uint32_t locate(std::uint32_t sample) const {
    return locateSample(mesh_, given_, bounds_.samples[sample]);
  }

  // Proposes all edges, or those where something is not as in the result before.
  void proposeAll(bool anew, base::Job& job) {
    std::vector<std::uint8_t> near;
    if (!anew) near = mesh_.widened(changed_);
    std::size_t count = 0;
    for (const VertexIndex a : mesh_.byPlace()) {
      job.lookAtTimes(count++);
      if (!mesh_.isRoot(a)) continue;
      mesh_.collectNeighbours(a, around_);
      for (const VertexIndex b : around_) {
        if (mesh_.isBefore(a, b) && (anew || near[a] != 0 || near[b] != 0)) propose(a, b);
      }
    }
  }

  // The planes of both, seen from `point`.
  [[nodiscard]] PlaneSum joined(VertexIndex a, VertexIndex b, const Vec3d& point) const {
    PlaneSum planes = planes_[a].seenFrom(point - mesh_.point(a));
    planes += planes_[b].seenFrom(point - mesh_.point(b));
    return planes;
  }

  // What would become of an edge; its sum is seen from the middle of the edge still.
  [[nodiscard]] Edge solve(VertexIndex a, VertexIndex b) const {
    const Vec3d &pa = mesh_.point(a), &pb = mesh_.point(b);
    const Vec3d middle = (pa + pb) * 0.5;
    const PlaneSum planes = joined(a, b, middle);
    Vec3d offset = planes.least();
    const bool near = offset.lengthSqr() <= (pa - pb).lengthSqr();
    if (!near || (bounds_.mayLie && !bounds_.mayLie(a, middle + offset))) offset = Vec3d(0.0);
    return {a, b, middle + offset, offset, planes.at(offset), planes};
  }

  void propose(VertexIndex a, VertexIndex b) {
    if (mesh_.isBefore(b, a)) std::swap(a, b);
    const double allowed = allowedAt(a, b);
    if (!(allowed > 0) || isFirm(a) || isFirm(b)) return;
    const Edge edge = solve(a, b);
    if (edge.error > allowed * allowed * edge.sum.count) {
      tooFar_ = true;
      return;
    }
    const double squaredLength = (mesh_.point(a) - mesh_.point(b)).lengthSqr();
    queue_.push(edge.error + kLengthShare * squaredLength, {a, b, version_[a], version_[b]});
  }

  bool canCollapse(const Edge& edge, double& reach) {
    reach = edge.sum.count > 0 ? std::sqrt(edge.error / edge.sum.count) : 0;
    if (!rim_.mayJoin(edge.a, edge.b) || !mesh_.mayCollapse(edge.a, edge.b) ||
        !ring_.collect(mesh_, edge.a, edge.b, edge.point, edge.sum.normals)) {
      return false;
    }
    bool near = samplesStayNear(edge, reach);
    if (near && !ring_.staysUnfolded(mesh_)) return false;
    near = near && ringStaysNear(edge, reach);
    tooFar_ |= !near;
    return near;
  }

  // Whether all samples of the triangles around the edge are near the ring; notes which triangle of
  // it each is nearest to, and where they are of several sides.
  bool samplesStayNear(const Edge& edge, double& reach) {
    const double allowed = allowedAt(edge.a, edge.b), enough = allowed * allowed;
    // What failed once lies at the front and mostly fails again.
    for (const std::uint32_t t : ring_.star()) {
      const std::uint32_t i = samples_.front(t);
      if (i != kNone && !ring_.isNear(vectorOf(bounds_.samples[i].point), enough)) return false;
    }
    attached_.clear();
    sides_.assign(ring_.shapes().size(), Sides::None);
    nearestSample_ = kNone;
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    std::size_t next = 0;
    for (const std::uint32_t t : ring_.star()) {
      const bool stays = next < ring_.triangles().size() && ring_.triangles()[next] == t;
      const std::size_t first = stays ? next++ : 0;
      std::uint32_t before = kNone;
      for (std::uint32_t i = samples_.front(t); i != kNone; before = i, i = samples_.after(i)) {
        const Vec3d at = vectorOf(bounds_.samples[i].point);
        const auto [triangle, squared] = ring_.nearest(at, first, kSurelyNear * enough);
        if (squared > enough) {
          if (before != kNone) samples_.moveToFront(i, before, t);
          return false;
        }
        farthest = std::max(farthest, squared);
        attached_.emplace_back(i, ring_.triangles()[triangle]);
        const Normal& n = bounds_.samples[i].normal;
        const bool own = Vec3d(n.x, n.y, n.z).dot(ring_.shapes()[triangle].normal()) > kOneSide;
        Sides& sides = sides_[triangle];
        sides = own && sides != Sides::Several ? Sides::One : Sides::Several;
        const double apart = (at - edge.point).lengthSqr();
        if (apart >= nearest) continue;
        nearest = apart;
        nearestSample_ = i;
      }
    }
    reach = std::max(reach, std::sqrt(farthest));
    return true;
  }

  // The way back, from the ring to the surface. Where all samples are of one side, the planes of
  // samples tell; beside a crease, the surface is asked.
  [[nodiscard]] bool ringStaysNear(const Edge& edge, double& reach) const {
    const double allowed = allowedAt(edge.a, edge.b);
    const bool smooth = std::none_of(sides_.begin(), sides_.end(),
                                     [](Sides sides) { return sides == Sides::Several; });
    if (smooth) {
      if (nearestSample_ == kNone) return true;
      const Sample& sample = bounds_.samples[nearestSample_];
      const double height = std::abs(Vec3d(sample.normal.x, sample.normal.y, sample.normal.z)
                                         .dot(edge.point - vectorOf(sample.point)));
      reach = std::max(reach, height);
      return height <= allowed;
    }
    const auto isNear = [&](const Vec3d& point, const Vec3d& normal) {
      const double distance = bounds_.distance(point, normal, allowed);
      reach = std::max(reach, distance);
      return distance <= allowed;
    };
    Vec3d sum(0.0);
    for (const FlatTriangle& triangle : ring_.shapes()) sum += triangle.normal();
    sum.normalize();
    if (!isNear(edge.point, sum)) return false;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      if (sides_[i] == Sides::One) continue;
      const FlatTriangle& triangle = ring_.shapes()[i];
      const Vec3d& p = triangle.corner(0);
      const Vec3d& x = triangle.corner(1);
      const Vec3d& y = triangle.corner(2);
      if (!isNear((p + x + y) / 3.0, triangle.normal())) return false;
      if (!isNear((p + x) * 0.5, triangle.normal())) return false;
      if (!isNear((p + y) * 0.5, triangle.normal())) return false;
    }
    return true;
  }

  void apply(const Edge& edge, double reach) {
    join(edge, reach, true);
    mesh_.collectNeighbours(edge.a, around_);
    for (const VertexIndex vertex : around_) propose(edge.a, vertex);
  }

  // Collapses the edge; `moved`: the samples go where samplesStayNear() said.
  void join(const Edge& edge, double reach, bool moved) {
    steps_.push_back({edge.a, edge.b, edge.point, static_cast<float>(reach)});
    planes_[edge.a] = edge.sum.seenFrom(edge.offset);
    allowed_[edge.a] = std::min(allowed_[edge.a], allowed_[edge.b]);
    mesh_.collapse(edge.a, edge.b, edge.point);
    rim_.join(edge.a, edge.b);
    if (moved) {
      for (const std::uint32_t t : ring_.star()) samples_.clear(t);
      for (const auto& [sample, t] : attached_) samples_.attach(sample, t);
    }
    joined_[edge.a] = 1;
    ++version_[edge.a];
    ++version_[edge.b];
  }

  // What the samples nearest to a triangle of the ring say of the surface there.
  enum class Sides : std::uint8_t { None, One, Several };

  const Mesh& given_;
  const Bounds& bounds_;
  EdgeMesh mesh_;
  std::vector<PlaneSum> planes_;
  std::vector<float> allowed_;
  Rim rim_;
  double looseness_ = 1;
  bool tooFar_ = false;                // an edge was refused for want of freedom
  std::vector<std::uint8_t> joined_;   // vertices that others went into
  std::vector<std::uint8_t> changed_;  // vertices that are not as in the result before
  std::vector<std::uint32_t> version_;
  EdgeQueue queue_;
  std::vector<Step> steps_;
  std::vector<VertexIndex> around_;
  SampleLists samples_;
  // Of the edge at hand: what it would become, where the samples go, and what they say.
  Ring ring_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> attached_;
  std::vector<Sides> sides_;
  std::uint32_t nearestSample_ = kNone;
};

}  // namespace

Collapsed collapse(const Mesh& mesh, const std::vector<PlaneSum>& planes, const Bounds& bounds,
                   base::Job& job) {
  Collapser collapser(mesh, planes, bounds);
  collapser.run(job);
  return collapser.result();
}

}  // namespace tufa::simplify
