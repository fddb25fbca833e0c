#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/job.h"
#include "reduce/box_list.h"
#include "reduce/lines.h"
#include "reduce/local_quadric.h"
#include "reduce/operations.h"
#include "reduce/partition.h"
#include "reduce/reference_mesh.h"
#include "reduce/star.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// One part of a partition: a compact copy of its vertices and triangles, and what is done to them.
///
/// An operation is tried on the copy, passes all guards or is refused, and is then made for good.
/// The guards, in the order in which they are asked (see Outcome): topology, place, shape of the
/// triangles, folds, stars, distance, intersections. One object serves many parts in turn, and
/// keeps its memory. Long work asks `job` now and then whether it is cancelled: a part of a coarse
/// surface has many samples.
class Part {
 public:
  explicit Part(base::Job& job) : job_(&job) {}
  void load(const Surface& surface, const ReferenceMesh& reference, const Partition& partition,
            Index number, const PhaseLimits& limits);
  /// Contracts clusters, connected vertices of one cube, each to one vertex. For meshes as fine as
  /// voxels.
  void contractClusters();
  /// Collapses edges, the cheapest first, until none is left, and knots where that ends.
  void collapseAll();
  /// Flips edges of slivers.
  void flipAll();
  /// Writes back what changed, but for stored(). Parts write to places of their own. `dead`: for
  /// each triangle of the surface whether it has vanished.
  void store(Surface& surface, std::vector<std::uint8_t>& dead);
  /// Positions and triangles that changed in all parts so far.
  [[nodiscard]] SurfaceChanges& stored() { return stored_; }

  /// What was tried in all parts so far.
  [[nodiscard]] const OperationCounts& counts() const { return counts_; }
  void clearCounts() { counts_ = {}; }
  /// Changes of LineVertex::change in all parts so far: vertices of the surface and planes.
  [[nodiscard]] std::vector<std::array<Index, 2>>& changes() { return changes_; }
  /// Vertices of the reference at which ways are required from now on, of all parts since the list
  /// was last cleared.
  [[nodiscard]] std::vector<Index>& withWays() { return withWays_; }
  /// Triangles that have changed for the first time, as they were, in all parts so far.
  [[nodiscard]] std::vector<Form>& forms() { return newForms_; }

 private:
  /// What changes in a region for the sake of a plane, as forms of different regions do not meet.
  struct FormsOfRegion {
    std::vector<Form> old, foreign;
    std::vector<Index> changed;  ///< triangles
  };
  static constexpr Index kBuckets = 512;
  static constexpr int kSmallComponent = 16;  ///< triangles
  struct Candidate {
    Index a, b, versionA, versionB;
  };
  /// A reference vertex, in the list of its owner.
  struct Sample {
    Vec3f p;
    Index next;
  };
  /// Who would own a sample in the attempt `stamp`.
  struct Taker {
    Index triangle, stamp;
  };
  struct Taken {
    Index sample, triangle;
  };
  struct NewAxis {
    Index vertex;
    Vec3f axis;
  };
  /// The neighbours of a vertex as seen from it, counter-clockwise; none if there are too many.
  struct Link {
    Vec3f to[kMostRing + 1];
    int count = 0;
    int changed = 0;  ///< one that is new or has moved
    void add(Vec3f neighbour) { to[count++] = neighbour; }
  };
  /// A turn at an edge of a star, or over needles at one. `next` is not of length 1.
  struct Turn {
    Vec3f normal, next;  ///< of the faces on both sides
    float cosine = 1;
    float height = 0;  ///< of the next face's apex over the first, times a positive number
  };
  /// The least cosines of turns from a face of a star to the next, or 1: at edges where the next
  /// one falls away, and where it rises.
  struct Sharpest {
    float ridge = 1, valley = 1;
    void see(const Turn& turn) {
      float& least = turn.height > 0 ? valley : ridge;
      least = std::min(least, turn.cosine);
    }
    [[nodiscard]] float least() const { return std::min(ridge, valley); }
  };
  /// Triangles that an attempt would make. Vertices are kNone where they are new.
  struct NewTriangles {
    Vec3f corners[kMostRing][3];
    Index vertices[kMostRing][3];
    int count = 0;
  };
  struct Changed;  ///< the mesh as it would be

  // part.cpp: tables and queue.
  void loadTables(const Surface& surface);
  void matchOpposites();
  void loadQuadrics();
  void loadSamples(const Surface& surface);
  void findOwnersAtVertices(const Surface& surface);
  void pollAttempt() {
    constexpr std::size_t kBetween = 256;
    if (++attempts_ % kBetween == 0) job_->checkCancelled(0, 1);
  }
  void push(float cost, const Candidate& candidate);
  bool pop(Candidate& candidate);
  void giveSamples();
  void emptySamples(Index t) { firstSample_[t] = kNone, wasFar_[t] = 0; }
  [[nodiscard]] Index around(Index c) const { return nextCorner(opposite_[nextCorner(c)]); }
  [[nodiscard]] bool isDead(Index t) const { return vertex_[3 * t] == kNone; }
  /// Whether the attempt at hand makes one vertex of v and others.
  [[nodiscard]] bool isMerged(Index v) const { return merged_[v] == mergedNow_; }
  [[nodiscard]] bool hasAxis(Index v) const { return squaredLength(axis_[v]) != 0; }
  /// Whether a guard is to be obeyed; tests switch single ones off.
  [[nodiscard]] bool isOn(Outcome guard) const { return limits_.switchedOff != guard; }
  void triangleAt(Index t, Vec3f* p) const;

  // part_collapse.cpp.
  void countSlivers();
  void proposeAll();
  void collapseProposed();
  float solve(Index a, Index b, Vec3f& place, LocalQuadric& sum) const;
  void propose(Index a, Index b);
  Outcome tryCollapse(Index a, Index b);
  Outcome tryPlace(Index a, Index b, Vec3f place);
  bool gatherRing(Index a, Index b);
  bool addToRing(Index corner);
  void apply(Index a, Index b);

  // part_cluster.cpp.
  void sortByCubes();
  void contractRange(Index begin, Index end, int halvings);
  bool contractCube(Index begin, Index end);
  void gatherCluster(Index first, Index open);
  Outcome tryContraction();
  bool solveCluster(Vec3f& place);
  [[nodiscard]] Index nearestMember() const;
  bool gatherClusterRing();
  [[nodiscard]] bool isNarrowRing() const;
  bool fillNotches();
  /// Whether a vertex may go into a cluster.
  [[nodiscard]] bool isFree(Index v) const {
    return inner_[v] != 0 && clusterOf_[v] != kNone && (flags_[v] & (kNarrow | kBorder)) == 0 &&
           !isOnLine(v);
  }
  Outcome clusterShapeGuard();
  Outcome clusterDistanceGuard(Index nearest);
  bool clusterSamplesNear(Index t);
  void applyContraction();

  // part_knot.cpp.
  bool contractKnots();
  bool contractKnot(Index v);
  void gatherKnot(Index v, float radius);
  Outcome tryKnot();
  Outcome knotShapeGuard();
  void applyKnot();

  // part_line.cpp.
  void loadLines(const Surface& surface);
  void storeLines(Surface& surface) const;
  [[nodiscard]] bool isOnLine(Index v) const { return hasLines_ && line_[v].kind != LineKind::Off; }
  [[nodiscard]] bool isNearLine(Index v) const {
    return line_[v].kind != LineKind::Off || line_[v].isBeside;
  }
  [[nodiscard]] bool isAlone() const { return hasLines_ && limits_.lines == LineMode::Alone; }
  [[nodiscard]] bool isLineEdge(Index corner) const;
  [[nodiscard]] std::array<Index, 2> keptAtLine(Index a, Index b) const;
  [[nodiscard]] float errorAtLine(Index a, Index b, Vec3f place, const LocalQuadric& sum) const;
  Outcome tryCollapseAtLine(Index a, Index b);
  [[nodiscard]] Index movingAtLine(Index a, Index b) const;
  [[nodiscard]] Vec3f bestInPlane(Index kept, Index gone, Vec3f place,
                                  const LocalQuadric& sum) const;
  Outcome tryInto(Index kept, Index gone, Vec3f place);
  [[nodiscard]] bool mayHold(Index a, Index b) const;
  [[nodiscard]] bool makesChord() const;
  [[nodiscard]] Index planeBeside(Index v) const;
  [[nodiscard]] bool mayGoAlone(Index gone, Index kept) const;
  [[nodiscard]] Index planeOfGoing(Index gone) const {
    return isOnLine(gone) ? line_[gone].planes[0] : planeBeside(gone);
  }
  /// Whether the vertex that stays in the collapse at hand gets another place.
  [[nodiscard]] bool isMovingKept() const { return !(place_ == position_[kept_]); }
  void noteGone(Index kept, Index gone);
  [[nodiscard]] bool mayFlipAtLine(const Index* v) const;

  // part_forms.cpp.
  void loadForms(const Surface& surface);
  [[nodiscard]] Form formOf(Index t, Index plane) const;
  [[nodiscard]] static bool meetsOldForm(const Form& form, const FormsOfRegion& forms);
  [[nodiscard]] bool meetsNewForm(const Form& form, const FormsOfRegion& forms) const;
  [[nodiscard]] bool formsMeet(Index kept, Index gone) const;
  void noteForms(Index plane);

  // part_star.cpp.
  [[nodiscard]] static bool normalsOf(const Vec3f* spokes, int count, Vec3f* normals);
  bool makeStar();
  Outcome shapeGuard(Index a, Index b);
  bool windsInFrame();
  bool isSimpleStar(std::span<const Index> merged) const;
  Outcome trianglesGuard(Vec3f a, Vec3f b);
  [[nodiscard]] bool isStarBent() const;
  template <class Visit>
  void forTurnsAfter(Visit&& visit) const;
  [[nodiscard]] Sharpest sharpestAfter() const;
  [[nodiscard]] bool foldGuard(std::span<const Index> merged) const;
  [[nodiscard]] bool foldsWereThere(std::span<const Index> merged) const;
  template <class Visit>
  void forTurnsBefore(std::span<const Index> merged, int between, Visit&& visit) const;
  template <class Visit>
  void forTurnsAcross(Vec3f normal, Vec3f p, Index edge, int between, Visit& visit) const;
  [[nodiscard]] Sharpest sharpestBefore(std::span<const Index> merged, int between) const;
  [[nodiscard]] float longestEdge2(Index t) const;
  [[nodiscard]] Vec3f outerNormal(Index corner) const;
  bool ringGuard();
  [[nodiscard]] Link linkAfterMerging(Index v) const;
  bool starGuard(Index v, const Link& link);
  [[nodiscard]] std::span<const Index> smallComponent(Index triangle, std::span<Index> room) const;
  [[nodiscard]] bool sideGuard() const;

  // part_distance.cpp.
  Outcome distanceGuard(Index a, Index b);
  void setDistance(float distance) {
    distance_ = distance;
    squaredDistance_ = distance * distance;
  }
  bool scaleTolerance(std::span<const Index> triangles, Index vertex);
  bool scaleStarTolerance(Index a);
  bool farSamplesNear();
  bool samplesNear(Index t, int wedge);
  bool samplesNearGraph(Index t, int wedge);
  void putFirst(Index t, Index before, Index s);
  [[nodiscard]] Vec3f inFrame(Vec3f p) const {
    return {dot(p, frame_.x), dot(p, frame_.y), dot(p, n_)};
  }
  bool sampleNearGraph(Index s, Vec3f q, int wedge);
  bool sampleNearStar(Index s, Vec3f p);
  [[nodiscard]] int wedgeOf(Vec3f s, int likely) const;
  bool apexNear(Index a, Index b);
  bool crossingsNear();
  bool edgeNear(Index face, const ReferenceMesh::Section& section, Index end);
  void noteFacesBetween(Index face, Index vertex);
  [[nodiscard]] bool isBelow(Index face, Index vertex, Vec3f axis) const;
  bool facesNear();
  bool allFacesNear();
  void clearTaken();
  [[nodiscard]] Index localSample(Index referenceVertex) const;
  [[nodiscard]] bool requiresWays(Index face) const;
  [[nodiscard]] bool faceNear(Index face) const;
  [[nodiscard]] Index ownerAfter(Index referenceVertex) const;

  // part_intersect.cpp.
  bool intersects(const NewTriangles& made, bool isMerging);
  bool starIntersects(std::span<const Index> merged);
  bool passesOver(std::span<const Index> merged, std::span<const Index> vanishing);
  template <class Winding>
  bool hasComponentIn(const Box3f& whole, const Winding& winding);
  void makeBoxList();
  void renewBox(Index t);
  [[nodiscard]] bool isNarrow(Index t) const;
  [[nodiscard]] Index cornerVertex(Index t, std::size_t i) const;

  // part_flip.cpp.
  Outcome tryFlip(Index corner);
  bool flipStars(const Index* v, const Vec3f* n);
  [[nodiscard]] Link linkAfterFlip(const Index* v, int k) const;
  bool flipDistance(const Index* v, bool isNeedle);
  bool flippedEdgeNear(Index from, Index to);
  bool flipIntersects(const Index* v);
  [[nodiscard]] bool flipKeepsSide(const Index* v) const;
  bool flipPassesOver(const Index* v);
  void applyFlip(const Index* v);

  base::Job* job_;
  std::size_t attempts_ = 0;
  const Surface* surface_ = nullptr;
  const ReferenceMesh* reference_ = nullptr;
  const Partition* partition_ = nullptr;
  PhaseLimits limits_;
  OperationCounts counts_;
  SurfaceChanges stored_;
  Index number_ = 0, vertexCount_ = 0, triangleCount_ = 0;
  float distance_ = 0, squaredDistance_ = 0;  ///< allowed at the attempt at hand
  Box3f box_;

  // For each vertex.
  std::vector<Vec3f> position_, axis_;
  std::vector<LocalQuadric> quadric_;  ///< seen from the position
  std::vector<std::uint8_t> flags_, inner_, moved_;
  std::vector<Index> face_, corner_, version_, stamp_, merged_;
  bool hasLines_ = false;
  std::vector<LineVertex> line_;
  std::vector<Index> region_;                   ///< of each triangle
  std::vector<std::array<Index, 3>> wentInto_;  ///< names, from and to, and the plane
  std::vector<std::array<Index, 2>> changes_;
  std::vector<Index> changeOf_;  ///< in a step of LineMode::Alone: of each triangle, as in Surface
  std::vector<Form> newForms_;
  std::unordered_map<Index, FormsOfRegion> formsOf_;
  std::vector<Index> triangleIds_;  ///< in the surface
  // For each corner; for each triangle its first sample; for each sample.
  std::vector<Index> vertex_, opposite_, firstSample_;
  std::vector<std::uint8_t> wasFar_;  ///< the first sample of a triangle, in an attempt before
  std::vector<Sample> samples_;
  std::vector<Index> owners_;
  std::vector<Taker> takers_;  ///< empty until one is asked for
  static constexpr std::uint8_t kRough = 1, kWays = 2;
  std::vector<std::uint8_t> isRough_;  ///< kRough, or kWays where ways are required from now on
  std::vector<Index> withWays_;
  bool hasRough_ = false;  ///< any of the samples
  bool isBent_ = false;    ///< three quarters of them, see VertexFlag
  std::span<const Index> sampleIds_;

  // The queue: buckets by the leading bits of the cost, first in first out.
  std::array<std::vector<Candidate>, kBuckets> buckets_;
  std::array<Index, kBuckets> heads_{};
  Index lowest_ = kBuckets;

  // Clusters: the vertices by their cubes, and for each vertex its cluster, kNone once that is
  // contracted.
  std::vector<std::pair<std::uint64_t, Index>> cubes_;
  std::vector<Index> clusterOf_;
  Index nextCluster_ = 0;
  std::vector<Index> cluster_;    ///< at hand
  std::vector<Index> vanishing_;  ///< its triangles that are not at the ring
  float turns_[kMostRing] = {};   ///< of the spokes, rising
  int first_ = 0;                 ///< the spoke with the least turn

  bool isContraction_ = false;           ///< the attempt at hand
  std::vector<std::uint8_t> wasInKnot_;  ///< vertices of knots that were tried

  Index done_ = 0;                   ///< vertices that are gone
  Index now_ = 0, mergedNow_ = 0;    ///< the last stamps
  int alive_ = 0, sliverCount_ = 0;  ///< triangles
  bool hasBoxList_ = false;
  BoxList boxList_;
  BoxList::Slots boxSlots_;
  std::vector<std::array<Index, 2>> edgeScratch_;
  std::vector<Index> firstScratch_;

  // The attempt at hand. A collapse takes b into a. The ring of neighbours runs counter-clockwise;
  // its edge from i to i + 1 belongs to a while i < split_, then to b.
  int size_ = 0, split_ = 0;
  Index kept_ = 0, gone_ = 0;
  Index left_ = 0, right_ = 0;      ///< corners at a in the two triangles that vanish
  Index flip_[2] = {kNone, kNone};  ///< or the corners opposite the edge to be flipped
  Index ring_[kMostRing + 1] = {};
  Index at_[kMostRing] = {};  ///< the corner of each ring edge's triangle at a or b
  Index ringStamp_ = 0;       ///< of the vertices in the ring
  Vec3f place_, n_;
  base::Frame frame_;
  bool isGraph_ = true;         ///< the new star is a graph over n_
  float tilt_[kMostRing];       ///< if it is none: how far rounding may tilt each normal, radians
  int nearestWedge_ = 0;        ///< if it is none: the triangle nearest to the sample before
  Vec3f spoke_[kMostRing + 1];  ///< from the place to the ring
  Vec3f normal_[kMostRing];     ///< of the new triangles
  Vec3f z_[kMostRing + 1];      ///< spokes in the frame, with the height last
  Vec3f slope_[kMostRing];      ///< normals in the frame, scaled to height 1
  int newSlivers_ = 0;
  LocalQuadric sum_;
  std::vector<Taken> taken_;
  std::vector<Index> roughFaces_;  ///< of the reference, to be tested
  bool asksWays_ = false;          ///< of all faces at taken samples
  Index walkedTo_ = kNone;         ///< the face at which the last walk along an edge ended
  NewAxis newAxis_[kMostRing];
  int newAxes_ = 0;
  Index apexFace_ = kNone;
};

// Whether a component lies in the space that an operation moves the surface over: inside of a box,
// where the triangles that are made and those that go, turned, wind around it. All triangles of
// such a component are inside, so one point of each triangle whose box is will do. `winding`: the
// solid angle of these triangles, seen from a point. Cost: few triangles are inside.
template <class Winding>
bool Part::hasComponentIn(const Box3f& whole, const Winding& winding) {
  if (!hasBoxList_) makeBoxList();
  return boxList_.any(whole, [&](Index t, const Box3f& box) {
    if (!whole.hasInside(box.lower) || !whole.hasInside(box.upper)) return false;
    for (std::size_t j = 0; j < 3; ++j) {
      const Index v = cornerVertex(t, j);
      const bool isOwn =
          v != kNone && ((flip_[0] == kNone && isMerged(v)) || stamp_[v] == ringStamp_);
      if (isOwn) return false;
    }
    Vec3f p[3];
    triangleAt(t, p);
    constexpr float kHalfSphere = 6.2831853f;  // 0 outside, 4 pi inside
    return std::abs(winding(p[0])) > kHalfSphere;
  });
}

}  // namespace tufa::reduce
