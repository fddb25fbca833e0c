#include "refine/cut_distance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/bits.h"
#include "base/box.h"
#include "base/huge_pages.h"
#include "base/polygons.h"
#include "reduce/box3f.h"
#include "reduce/certificate.h"
#include "reduce/corners.h"
#include "reduce/map_degree.h"
#include "reduce/overlay_path.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"
#include "refine/cut_folds.h"
#include "refine/cut_triangles.h"
#include "refine/tolerance_scales.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

using base::Vec3f;
using reduce::Index;

constexpr std::size_t kGrain = 4096;
constexpr std::uint32_t kNone = octree::kNone;
// Voxels; faces need no tighter bound, as rounding may take as much.
constexpr float kRounding = 1e-4f;
constexpr float kFar = std::numeric_limits<float>::max();
// Where more than one in so many vertices is of a cell that must be split, faces are not measured:
// most would have to be again.
constexpr std::size_t kOften = 100;

// Marks from several threads at a time.
void mark(std::vector<std::uint8_t>& marks, std::size_t at) {
  std::atomic_ref<std::uint8_t>(marks[at]).store(1, std::memory_order_relaxed);
}

// Marks what shares a polygon with something marked.
std::vector<std::uint8_t> grown(const Mesh& mesh, const std::vector<std::uint8_t>& marks,
                                base::Job& job) {
  std::vector<std::uint8_t> more = marks;
  const std::size_t count = mesh.quads.size() + mesh.triangles.size();
  job.forRanges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const base::Corners v = base::cornersOf(mesh, static_cast<base::PolygonIndex>(i));
      if (std::none_of(v.begin(), v.end(), [&](VertexIndex c) { return marks[c] != 0; })) continue;
      for (const VertexIndex c : v) mark(more, c);
    }
  });
  return more;
}

}  // namespace

// One mesh.
class CutDistance::Measure {
 public:
  Measure(CutDistance& all, const octree::Cut& cut, const octree::CutMesh& made)
      : all_(all), cut_(cut), made_(made), mesh_(made.mesh) {}

  std::vector<VertexIndex> run(const std::vector<std::uint8_t>& changed) {
    findPolygons();
    findDirty(changed);
    collectTriangles();
    splitFolds();
    findOwners();
    if (coarse_.size() * kOften > mesh_.positions.size()) {
      leaveFaces();
    } else {
      measureFaces();
    }
    return takeCoarse();
  }

  // Also tells whether the degree of some component is not known to be one.
  std::vector<VertexIndex> findUncovered(bool& any) {
    findPolygons();
    const std::vector<VertexIndex> componentOf = topology::connectedComponentsOf(mesh_);
    const std::vector<VertexIndex> seedOf = findSeeds(componentOf);
    findFacesNear(componentOf, seedOf);
    collectTriangles();
    std::vector<std::pair<VertexIndex, std::uint32_t>> faces;  // of components
    for (std::uint32_t face = 0; face < isDirty_.size(); ++face) {
      if (isDirty_[face] == 0) continue;
      faces.emplace_back(componentOf[cut_.vertexOf[faceOf(face).vertices[0]]], face);
    }
    std::sort(faces.begin(), faces.end());
    std::vector<std::uint8_t> levelOf(seedOf.size(), 0);  // of each component the largest
    std::vector<std::uint8_t> isUncovered(seedOf.size(), 0);
    any = false;
    auto next = faces.begin();
    for (VertexIndex component = 0; component < seedOf.size(); ++component) {
      const auto first = next;
      while (next != faces.end() && next->first == component) ++next;
      if (seedOf[component] == kNone) continue;
      const std::optional<int> degree = degreeAt(seedOf[component], {first, next});
      if (degree == 1) continue;
      any = true;
      isUncovered[component] = degree.has_value() ? 1 : 0;
    }
    for (VertexIndex v = 0; v < componentOf.size(); ++v) {
      std::uint8_t& level = levelOf[componentOf[v]];
      level = std::max(level, cut_.clusters[v].level);
    }
    for (VertexIndex v = 0; v < componentOf.size(); ++v) {
      const VertexIndex component = componentOf[v];
      if (isUncovered[component] != 0 && cut_.clusters[v].level == levelOf[component]) {
        coarse_.push_back(v);
      }
    }
    return takeCoarse();
  }

 private:
  [[nodiscard]] const Mesh& base() const { return all_.base_.mesh; }

  std::vector<VertexIndex> takeCoarse() {
    std::sort(coarse_.begin(), coarse_.end());
    coarse_.erase(std::unique(coarse_.begin(), coarse_.end()), coarse_.end());
    return std::move(coarse_);
  }

  template <class Body>
  void forRanges(std::size_t count, const Body& body) {
    all_.job_.forRanges(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  // Calls body(i, list) for all i, and adds the lists up to coarse_ in their order.
  template <class Body>
  void collectCoarse(std::size_t count, const Body& body) {
    std::vector<std::vector<VertexIndex>> lists((count + kGrain - 1) / kGrain);
    all_.job_.forRanges(lists.size(), 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t list = first; list < last; ++list) {
        const std::size_t end = std::min((list + 1) * kGrain, count);
        for (std::size_t i = list * kGrain; i < end; ++i) body(i, lists[list]);
      }
    });
    for (const auto& list : lists) coarse_.insert(coarse_.end(), list.begin(), list.end());
  }

  void findPolygons() {
    polygonOf_.assign(base().quads.size(), kNone);
    forRanges(mesh_.quads.size() + mesh_.triangles.size(), [&](std::size_t i) {
      const auto polygon = static_cast<base::PolygonIndex>(i);
      polygonOf_[made_.sourceOf(polygon)] = polygon;
    });
  }

  // The corners of a triangle of the mesh; none if it is not there any more.
  [[nodiscard]] base::Corners cornersOf(std::uint32_t id, Triangle& storage) const {
    const base::PolygonIndex polygon = polygonOf_[id / 2];
    if (polygon == kNone) return {};
    const base::Corners v = base::cornersOf(mesh_, polygon);
    if (id % 2 == 0) {
      storage = {v[0], v[1], v[2]};
    } else if (v.size() == 4) {
      storage = {v[0], v[2], v[3]};
    } else {
      return {};
    }
    return storage.vertices;
  }

  [[nodiscard]] Triangle faceOf(std::size_t face) const {
    const auto& v = base().quads[face / 2].vertices;
    return face % 2 == 0 ? Triangle{v[0], v[1], v[2]} : Triangle{v[0], v[2], v[3]};
  }

  // Which uniform vertices need a new owner, which faces must be measured, and of which owners
  // these are. An owner is one no more if it was too far, or a vertex of its polygon has changed. A
  // way leads over
  // triangles that have a vertex in common with one of its owners, so it stays as it is if no
  // vertex is a polygon from these that has changed. A face without owners lies in the mesh, and
  // does so until one of its polygon's vertices changes.
  void findDirty(const std::vector<std::uint8_t>& changed) {
    const std::vector<std::uint8_t> touched = grown(mesh_, changed, all_.job_);
    const std::size_t count = base().positions.size();
    std::vector<std::uint8_t> isNear(count, 0);
    forRanges(count, [&](std::size_t r) {
      std::uint32_t& owner = all_.owner_[r];
      if (owner == kNone) {
        isNear[r] = touched[cut_.vertexOf[r]];
        return;
      }
      const base::PolygonIndex polygon = polygonOf_[owner / 2];
      bool isGone = polygon == kNone || all_.distance_[r] > all_.toleranceAt(r);
      if (!isGone) {
        Triangle storage;
        for (const VertexIndex v : base::cornersOf(mesh_, polygon)) isGone |= changed[v] != 0;
        for (const VertexIndex v : cornersOf(owner, storage)) isNear[r] |= touched[v];
      }
      if (!isGone) return;
      isNear[r] = 1;
      owner = kNone;
    });
    isDirty_.assign(2 * base().quads.size(), 0);
    wanted_.assign(count, 0);
    forRanges(isDirty_.size(), [&](std::size_t face) {
      const Triangle v = faceOf(face);
      if (all_.faceBound_[face] != kFar &&
          std::none_of(v.vertices.begin(), v.vertices.end(),
                       [&](VertexIndex r) { return isNear[r] != 0; })) {
        return;
      }
      isDirty_[face] = 1;
      for (const VertexIndex r : v.vertices) mark(wanted_, r);
    });
  }

  // The triangles that ways may lead over: around the owners, found or to be found up to two
  // polygons from a cluster, and one polygon more for what is pulled over a vertex there.
  void collectTriangles() {
    std::vector<std::uint8_t> marks(mesh_.positions.size());
    forRanges(wanted_.size(), [&](std::size_t r) {
      if (wanted_[r] == 0) return;
      mark(marks, cut_.vertexOf[r]);
      if (all_.owner_[r] == kNone) return;
      Triangle storage;
      for (const VertexIndex v : cornersOf(all_.owner_[r], storage)) mark(marks, v);
    });
    for (int i = 0; i < 3; ++i) marks = grown(mesh_, marks, all_.job_);
    localOf_.resize(2 * base().quads.size());
    const auto count = static_cast<base::PolygonIndex>(mesh_.quads.size() + mesh_.triangles.size());
    for (base::PolygonIndex polygon = 0; polygon < count; ++polygon) {
      const base::Corners v = base::cornersOf(mesh_, polygon);
      if (std::none_of(v.begin(), v.end(), [&](VertexIndex c) { return marks[c] != 0; })) continue;
      const std::uint32_t id = 2 * made_.sourceOf(polygon);
      add({v[0], v[1], v[2]}, id);
      if (v.size() == 4) add({v[0], v[2], v[3]}, id + 1);
    }
    triangles_.positions.resize(mesh_.positions.size());
    forRanges(mesh_.positions.size(),
              [&](std::size_t i) { triangles_.positions[i] = all_.toVoxels(mesh_.positions[i]); });
    cornersOf_.emplace(mesh_.positions.size(), triangles_.corners);
    triangles_.opposite = reduce::oppositeCorners(triangles_.corners, *cornersOf_, all_.job_);
  }

  void add(const Triangle& corners, std::uint32_t id) {
    localOf_[id] = static_cast<Index>(triangles_.corners.size());
    triangles_.corners.push_back(corners);
    triangles_.ids.push_back(id);
  }

  // Of a quad with one vertex in a larger cell, a triangle may have none.
  void splitFolds() {
    for (const auto& [a, b] : findFolds(triangles_, cut_, all_.base_)) {
      std::vector<VertexIndex> corners;
      for (const Index t : {a, b}) {
        const base::Corners v = base::cornersOf(mesh_, polygonOf_[triangles_.ids[t] / 2]);
        corners.insert(corners.end(), v.begin(), v.end());
      }
      addLargest(corners, coarse_);
    }
  }

  // The nearest triangle around a vertex's cluster, or where that is too far, one that lies nearer
  // around the corners of that.
  void findOwners() {
    const reduce::CornersOfVertices& corners = *cornersOf_;
    collectCoarse(wanted_.size(), [&](std::size_t r, std::vector<VertexIndex>& coarse) {
      if (wanted_[r] == 0 || all_.owner_[r] != kNone) return;
      const Vec3f p = all_.points_[r];
      const float tolerance = all_.toleranceAt(r);
      Index nearest = reduce::kNone;
      float least = kFar;
      const auto lookAround = [&](VertexIndex v) {
        for (const Index c : corners.of(v)) {
          const float d = triangles_.distance(c / 3, p);
          if (d < least) least = d, nearest = c / 3;
        }
      };
      lookAround(cut_.vertexOf[r]);
      if (nearest == reduce::kNone) return;  // its cluster has no polygons left
      if (least > tolerance) {
        const Triangle first = triangles_.corners[nearest];
        for (const VertexIndex v : first.vertices) lookAround(v);
      }
      all_.owner_[r] = triangles_.ids[nearest];
      all_.distance_[r] = least;
      if (least <= tolerance) return;
      addLargest(triangles_.corners[nearest].vertices, coarse);
      coarse.push_back(cut_.vertexOf[r]);
    });
  }

  // What is not measured, counts as too far, and is dirty in the next mesh.
  void leaveFaces() {
    forRanges(isDirty_.size(), [&](std::size_t face) {
      if (isDirty_[face] != 0) all_.faceBound_[face] = kFar;
    });
  }

  void measureFaces() {
    collectCoarse(isDirty_.size(), [&](std::size_t face, std::vector<VertexIndex>& coarse) {
      if (isDirty_[face] == 0) return;
      float& bound = all_.faceBound_[face];
      const Triangle r = faceOf(face);
      if (isInMesh(static_cast<std::uint32_t>(face), r)) {
        bound = 0;
        return;
      }
      bound = kFar;
      bool isFar = false;
      for (const VertexIndex v : r.vertices) {
        if (all_.owner_[v] == kNone) {
          for (const VertexIndex c : r.vertices) coarse.push_back(cut_.vertexOf[c]);
          return;
        }
        isFar |= all_.distance_[v] > all_.toleranceAt(v);
      }
      if (isFar) return;
      const reduce::OwnedFace owned = ownedFace(r);
      if (owned.hasOneOwner()) {
        bound = 0;
        return;
      }
      const float limit = limitOf(r);
      float squared = acrossOneEdge2(owned);
      if (!(squared <= limit * limit))
        squared = overlayBound2(owned, limit, [](const reduce::OverlayTurn&) {});
      if (squared <= limit * limit) {
        bound = std::sqrt(squared);
        return;
      }
      addOwners(owned.owners, coarse);
    });
  }

  [[nodiscard]] reduce::OwnedFace ownedFace(const Triangle& r) const {
    reduce::OwnedFace owned;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = r.vertices[i];
      owned.corners[i] = all_.points_[v];
      owned.vertices[i] = v;
      owned.owners[i] = localOf_[all_.owner_[v]];
    }
    return owned;
  }

  // The bound for a face of two owners that share an edge, which most faces are that have more than
  // one: two of its edges pass that one. kFar2 for any other.
  [[nodiscard]] float acrossOneEdge2(const reduce::OwnedFace& face) const {
    const auto& owners = face.owners;
    const std::size_t one = owners[1] == owners[2] ? 0 : owners[0] == owners[2] ? 1 : 2;
    const std::size_t b = (one + 1) % 3, c = (one + 2) % 3;
    if (owners[b] != owners[c] || isFine(face.vertices[one])) return reduce::kFar2;
    for (int i = 0; i < 3; ++i) {
      if (triangles_.across(owners[one], i) != owners[b]) continue;
      const Vec3f from = triangles_(owners[one], (i + 1) % 3);
      const Vec3f to = triangles_(owners[one], (i + 2) % 3);
      return std::max(
          reduce::squaredDistanceOfSegments(face.corners[one], face.corners[b], from, to),
          reduce::squaredDistanceOfSegments(face.corners[one], face.corners[c], from, to));
    }
    return reduce::kFar2;
  }

  // How far a uniform face may be.
  [[nodiscard]] float limitOf(const Triangle& r) const {
    float tolerance = kFar;
    for (const VertexIndex v : r.vertices) tolerance = std::min(tolerance, all_.toleranceAt(v));
    return std::max(tolerance, kRounding);
  }

  template <class OnTurn>
  float overlayBound2(const reduce::OwnedFace& owned, float limit, const OnTurn& onTurn) const {
    const auto way = [&](std::size_t a, std::size_t b, reduce::OverlayPath& path) {
      return findWay(owned, a, b, limit * limit, path);
    };
    return reduce::overlayBound2(triangles_, owned, limit * limit, way, onTurn);
  }

  // Of each closed component a vertex of a larger cell, none where all is as in the uniform mesh.
  [[nodiscard]] std::vector<VertexIndex> findSeeds(
      const std::vector<VertexIndex>& componentOf) const {
    std::vector<VertexIndex> seedOf(componentOf.size(), kNone);
    base::forPolygons(mesh_, [&](base::PolygonIndex, base::Corners v) {
      VertexIndex& seed = seedOf[componentOf[v[0]]];
      if (seed != kNone) return;
      const auto large = std::find_if(v.begin(), v.end(),
                                      [&](VertexIndex k) { return cut_.clusters[k].level > 0; });
      if (large != v.end()) seed = *large;
    });
    if (all_.base_.topology.openEdges == 0) return seedOf;
    const std::vector<std::uint64_t> oddEdges = oddEdgesOf(componentOf);
    for (std::size_t i = 0; i < seedOf.size(); ++i) {
      if (oddEdges[i] != 0) seedOf[i] = kNone;
    }
    return seedOf;
  }

  // For each component the exclusive or of its polygons' edges, as mixed keys: 0 if every edge has
  // two polygons, as in a closed component.
  [[nodiscard]] std::vector<std::uint64_t> oddEdgesOf(
      const std::vector<VertexIndex>& componentOf) const {
    std::vector<std::uint64_t> odd(componentOf.size(), 0);
    base::forPolygons(mesh_, [&](base::PolygonIndex, base::Corners v) {
      for (std::size_t i = 0; i < v.size(); ++i) {
        const std::uint64_t a = v[i], b = v[(i + 1) % v.size()];
        odd[componentOf[v[0]]] ^= base::mixBits(std::min(a, b) << 32 | std::max(a, b));
      }
    });
    return odd;
  }

  // The faces that may be pulled over the seed of their component.
  void findFacesNear(const std::vector<VertexIndex>& componentOf,
                     const std::vector<VertexIndex>& seedOf) {
    isDirty_.assign(2 * base().quads.size(), 0);
    wanted_.assign(base().positions.size(), 0);
    forRanges(isDirty_.size(), [&](std::size_t face) {
      const Triangle r = faceOf(face);
      const VertexIndex seed = seedOf[componentOf[cut_.vertexOf[r.vertices[0]]]];
      if (seed == kNone) return;
      const auto& [a, b, c] = r.vertices;
      const std::array<Vec3f, 3> p{all_.points_[a], all_.points_[b], all_.points_[c]};
      const Vec3f at = all_.toVoxels(mesh_.positions[seed]);
      const float limit = limitOf(r);
      reduce::Box3f box = reduce::boxOf(p.data());
      box.growBy(2 * limit);
      if (!box.meets({at, at})) return;
      if (reduce::squaredDistanceToTriangle(at, p[0], p[1], p[2]) > limit * limit) return;
      if (isInMesh(static_cast<std::uint32_t>(face), r)) return;
      if (std::any_of(r.vertices.begin(), r.vertices.end(),
                      [&](VertexIndex v) { return all_.owner_[v] == kNone; }))
        return;
      isDirty_[face] = 1;
      for (const VertexIndex v : r.vertices) mark(wanted_, v);
    });
  }

  // How often some uniform faces cover a vertex; unknown if one of them has no way, as where cells
  // may not be split.
  [[nodiscard]] std::optional<int> degreeAt(
      VertexIndex v, std::span<const std::pair<VertexIndex, std::uint32_t>> faces) const {
    const std::span<const Index> corners = cornersOf_->of(v);
    if (corners.empty()) return 0;  // no face is near
    reduce::MapDegree degree(triangles_, v, corners.front() / 3);
    for (const auto& [component, face] : faces) {
      const Triangle r = faceOf(face);
      const float limit = limitOf(r);
      const float found = overlayBound2(ownedFace(r), limit,
                                        [&](const reduce::OverlayTurn& turn) { degree(turn); });
      if (!(found <= limit * limit)) return {};
    }
    return degree.degree();
  }

  [[nodiscard]] bool isFine(VertexIndex r) const {
    return cut_.clusters[cut_.vertexOf[r]].level == 0;
  }

  // Whether a uniform face is a triangle of the mesh.
  [[nodiscard]] bool isInMesh(std::uint32_t face, const Triangle& r) const {
    Triangle own;
    if (!std::all_of(r.vertices.begin(), r.vertices.end(),
                     [&](VertexIndex v) { return isFine(v); }))
      return false;
    for (const std::uint32_t id : {face, face ^ 1}) {
      const base::Corners corners = cornersOf(id, own);
      if (!corners.empty() && std::all_of(r.vertices.begin(), r.vertices.end(), [&](VertexIndex v) {
            return std::find(corners.begin(), corners.end(), cut_.vertexOf[v]) != corners.end();
          })) {
        return true;
      }
    }
    return false;
  }

  // The way of an edge from corner a to corner b. One that is an edge of the mesh stays where it
  // is, so that the faces do of which all edges are.
  bool findWay(const reduce::OwnedFace& face, std::size_t a, std::size_t b, float limit2,
               reduce::OverlayPath& way) const {
    if (isFine(face.vertices[a]) && isFine(face.vertices[b])) {
      const VertexIndex from = cut_.vertexOf[face.vertices[a]],
                        to = cut_.vertexOf[face.vertices[b]];
      const auto around = cornersOf_->of(from);
      const auto isAtEdge = [&](Index t) { return reduce::hasVertex(triangles_, t, to); };
      if (std::any_of(around.begin(), around.end(), [&](Index c) { return isAtEdge(c / 3); })) {
        way.count = 1;
        way.largest2 = 0;
        way.triangles[0] = face.owners[a];
        return triangles_.walkAround(from, isAtEdge, way) &&
               triangles_.walkAround(
                   to, [&](Index t) { return t == face.owners[b]; }, way);
      }
    }
    return reduce::findOverlayPath(triangles_, {face.corners[a], face.corners[b]}, face.owners[a],
                                   face.owners[b], limit2, way);
  }

  // The vertices of owners in the largest cells; where all are of the uniform mesh, those in larger
  // cells around them.
  void addOwners(const std::array<Index, 3>& owners, std::vector<VertexIndex>& coarse) const {
    std::array<VertexIndex, 9> corners;
    for (std::size_t i = 0; i < 9; ++i)
      corners[i] = triangles_.corners[owners[i / 3]].vertices[i % 3];
    const auto isLarge = [&](VertexIndex v) { return cut_.clusters[v].level > 0; };
    if (std::any_of(corners.begin(), corners.end(), isLarge)) return addLargest(corners, coarse);
    for (const VertexIndex v : corners) {
      for (const Index c : cornersOf_->of(v)) {
        for (const VertexIndex w : triangles_.corners[c / 3].vertices) {
          if (isLarge(w)) coarse.push_back(w);
        }
      }
    }
  }

  // Of some vertices those of the largest cells.
  void addLargest(std::span<const VertexIndex> vertices, std::vector<VertexIndex>& coarse) const {
    int level = 0;
    for (const VertexIndex v : vertices) level = std::max(level, int{cut_.clusters[v].level});
    for (const VertexIndex v : vertices) {
      if (cut_.clusters[v].level == level) coarse.push_back(v);
    }
  }

  CutDistance& all_;
  const octree::Cut& cut_;
  const octree::CutMesh& made_;
  const Mesh& mesh_;
  std::vector<base::PolygonIndex> polygonOf_;  // of each uniform quad; kNone for none
  std::vector<std::uint8_t> isDirty_;          // of each uniform face
  std::vector<std::uint8_t> wanted_;           // corners of these
  CutTriangles triangles_;
  std::optional<reduce::CornersOfVertices> cornersOf_;
  std::vector<Index> localOf_;  // from ids to triangles_, of those that are there
  std::vector<VertexIndex> coarse_;
};

CutDistance::CutDistance(const uniform::SurfaceView& base, const octree::CutRule& rule,
                         base::Job& job)
    : base_(base),
      job_(job),
      tolerance_(static_cast<float>(rule.tolerance)),
      scales_(scalesOf(base.mesh, base.affine, rule, job)) {
  const std::size_t count = base.mesh.positions.size();
  base::Box box = base::Box::empty();
  for (const Position& p : base.mesh.positions) box.add(Vec3(p));
  middle_ = box.centre();
  base::resizeLarge(points_, count, job);
  job.forRanges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) points_[i] = toVoxels(base.mesh.positions[i]);
  });
  owner_.assign(count, kNone);
  distance_.assign(count, 0);
  faceBound_.assign(2 * base.mesh.quads.size(), 0);
}

base::Vec3f CutDistance::toVoxels(const Position& p) const {
  return Vec3f((Vec3(p) - middle_) * (1 / base_.affine.voxelSize()));
}

std::vector<VertexIndex> CutDistance::measure(const octree::Cut& cut, const octree::CutMesh& made,
                                              const std::vector<std::uint8_t>& changed) {
  return Measure(*this, cut, made).run(changed);
}

std::vector<VertexIndex> CutDistance::findUncovered(const octree::Cut& cut,
                                                    const octree::CutMesh& made) {
  return Measure(*this, cut, made).findUncovered(isUncovered_);
}

Deviation CutDistance::total(const octree::Cut& cut, const Mesh& mesh) const {
  std::vector<std::uint8_t> isUsed(mesh.positions.size());
  base::forPolygons(mesh, [&](base::PolygonIndex, base::Corners corners) {
    for (const VertexIndex v : corners) isUsed[v] = 1;
  });
  const auto isPresent = [&](std::size_t r) { return isUsed[cut.vertexOf[r]] != 0; };
  double sum = 0;
  std::size_t count = 0;
  float largest = 0;
  bool isTooFar = false;
  for (std::size_t r = 0; r < distance_.size(); ++r) {
    if (!isPresent(r)) continue;
    sum += static_cast<double>(distance_[r]);
    ++count;
    largest = std::max(largest, distance_[r]);
    isTooFar |= distance_[r] > toleranceAt(r);
  }
  const float ofVertices = largest;
  for (std::size_t face = 0; face < faceBound_.size(); ++face) {
    if (!isPresent(base_.mesh.quads[face / 2].vertices[0])) continue;
    largest = std::max(largest, faceBound_[face]);
  }
  isTooFar |= largest == kFar || isUncovered_;
  if (isTooFar) return measureWhole(cut, mesh, std::max(ofVertices, tolerance_));
  return {static_cast<double>(largest), count == 0 ? 0 : sum / static_cast<double>(count)};
}

Deviation CutDistance::measureWhole(const octree::Cut& cut, const Mesh& mesh,
                                    float expected) const {
  const std::vector<Triangle> faces = triangulate(base_.mesh);
  const reduce::ReferenceMesh reference(reduce::makeSurface(points_, faces, job_), {}, job_);
  std::vector<Vec3f> positions(mesh.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = toVoxels(mesh.positions[i]);
  reduce::Surface surface = reduce::makeSurface(positions, triangulate(mesh), job_);
  reduce::locateAll(surface, reference, cut.vertexOf, job_);
  const reduce::Certificate certificate = reduce::certify(surface, reference, expected, job_);
  return {static_cast<double>(certificate.largest), static_cast<double>(certificate.mean)};
}

}  // namespace tufa::refine
