#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/vec3.h"
#include "refine/collapse/collapse.h"
#include "refine/collapse/edge_mesh.h"
#include "refine/collapse/edge_queue.h"
#include "refine/collapse/partition.h"
#include "refine/collapse/ring.h"
#include "refine/collapse/sample_lists.h"

namespace tufa::refine {

/// A mesh while its edges are collapsed, with the data of its vertices.
struct CollapseState {
  CollapseState(const Mesh& given, const std::vector<base::Quadric>& planes, const Bounds& bounds);

  const Mesh& given;
  const Bounds& bounds;
  EdgeMesh mesh;
  std::vector<base::Quadric> planes;
  std::vector<float> budget;
  Rim rim;
  std::vector<std::uint8_t> joined;   ///< vertices that others were joined to
  std::vector<std::uint8_t> changed;  ///< vertices that differ from the result before
  std::vector<std::uint32_t>
      versions;  ///< how often a vertex has changed; tells outdated edges in the queue
  SampleLists samples;
  double budgetScale = 1;  ///< multiplies all budgets
};

/// Two neighbours.
using EdgeEnds = std::pair<VertexIndex, VertexIndex>;

/// Collapses the edges of one part of a partition. An edge is collapsed only if all neighbours of
/// its ends are in the part, so it neither reads nor writes what collapses in other parts change:
/// parts may run at the same time.
class Collapser {
 public:
  Collapser(CollapseState& state, const Regions& regions) : state_(state), regions_(regions) {}

  /// Queues all edges at a vertex; if `behind`, only those to neighbours behind it by place. An
  /// edge that is not inside the part is postponed.
  void proposeAround(VertexIndex vertex, bool behind);
  void propose(VertexIndex a, VertexIndex b);
  /// Collapses what was queued and what follows from it, `most` edges at most.
  void run(std::size_t most, base::Job& job);
  /// Repeats collapses in the same order, except where a new sample or a smaller budget forbids it,
  /// or the mesh around differs from then. `rolledBack`: those not to be repeated; empty: none.
  void repeat(std::span<const Step> steps, std::span<const std::uint8_t> rolledBack,
              base::Job& job);

  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }
  [[nodiscard]] const std::vector<EdgeEnds>& postponed() const { return postponed_; }
  /// Whether an edge was refused for want of budget.
  [[nodiscard]] bool tooFar() const { return tooFar_; }

 private:
  struct Edge {
    VertexIndex a, b;
    Vec3 point;         ///< that takes the place of both
    Vec3 offset;        ///< from the origin of `sum`, the edge's middle, to the point
    double error;       ///< sum of squared distances of the point to the planes
    base::Quadric sum;  ///< the planes of both
  };
  // On how many smooth sheets the samples nearest to a triangle of the ring lie.
  enum class Sides : std::uint8_t { None, One, Several };

  [[nodiscard]] double budgetAt(VertexIndex a, VertexIndex b) const;
  [[nodiscard]] bool isLocked(VertexIndex vertex) const;
  [[nodiscard]] base::Quadric joined(VertexIndex a, VertexIndex b, const Vec3& point) const;
  [[nodiscard]] Edge solve(VertexIndex a, VertexIndex b) const;
  [[nodiscard]] bool canCollapse(const Edge& edge, double& reach);
  [[nodiscard]] bool samplesStayNear(const Edge& edge, double& reach);
  [[nodiscard]] bool ringStaysNear(const Edge& edge, double& reach) const;
  [[nodiscard]] bool repeatStep(const Step& step);
  void join(const Edge& edge, double reach, bool moved);

  CollapseState& state_;
  const Regions& regions_;
  EdgeQueue queue_;
  std::vector<Step> steps_;
  std::vector<EdgeEnds> postponed_;
  bool tooFar_ = false;
  std::vector<VertexIndex> around_;
  // Of the edge at hand: its ring, where the samples would go, and on which sheets they lie.
  LinkCheck link_;
  Ring ring_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> attached_;
  std::vector<Sides> sheets_;
  std::uint32_t nearestSample_ = kNone;
};

}  // namespace tufa::refine
