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

/// A mesh while its edges are collapsed, with all that is kept of its vertices.
struct CollapseState {
  CollapseState(const Mesh& given, const std::vector<base::Quadric>& planes, const Bounds& bounds);

  const Mesh& given;
  const Bounds& bounds;
  EdgeMesh mesh;
  std::vector<base::Quadric> planes;
  std::vector<float> budget;
  Rim rim;
  std::vector<std::uint8_t> joined;     ///< vertices that others went into
  std::vector<std::uint8_t> changed;    ///< vertices that are not as in the result before
  std::vector<std::uint32_t> versions;  ///< how often a vertex has changed
  SampleLists samples;
  double budgetScale = 1;  ///< what `allowed` is multiplied by
};

/// Two neighbours.
using EdgeEnds = std::pair<VertexIndex, VertexIndex>;

/// Collapses the edges of one region. Reads and writes nothing of vertices in other regions that
/// their collapses change, so that regions may go at the same time.
class Collapser {
 public:
  Collapser(CollapseState& state, const Regions& regions) : state_(state), regions_(regions) {}

  /// Lets all edges at a vertex be collapsed, those to neighbours behind it by place alone if
  /// `behind`. An edge that is not inside the region is postponed.
  void proposeAround(VertexIndex vertex, bool behind);
  void propose(VertexIndex a, VertexIndex b);
  /// Collapses what was proposed and what comes of it, at most so many edges.
  void run(std::size_t most, base::Job& job);
  /// Collapses again what was collapsed before, in the same order, except where a new sample or
  /// less freedom forbids it, or the mesh around is no longer as it was then. `undone`: which are
  /// not to be made again; empty: none.
  void repeat(std::span<const Step> steps, std::span<const std::uint8_t> rolledBack,
              base::Job& job);

  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }
  [[nodiscard]] const std::vector<EdgeEnds>& postponed() const { return postponed_; }
  /// Whether an edge was refused for want of freedom.
  [[nodiscard]] bool tooFar() const { return tooFar_; }

 private:
  struct Edge {
    VertexIndex a, b;
    Vec3 point;         ///< that takes the place of both
    Vec3 offset;        ///< from where `sum` is seen to the point
    double error;       ///< sum of squared distances of the point to the planes
    base::Quadric sum;  ///< the planes of both
  };
  // What the samples nearest to a triangle of the ring say of the surface there.
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
  // Of the edge at hand: what it would become, where the samples go, and what they say.
  LinkCheck link_;
  Ring ring_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> attached_;
  std::vector<Sides> sheets_;
  std::uint32_t nearestSample_ = kNone;
};

}  // namespace tufa::refine
