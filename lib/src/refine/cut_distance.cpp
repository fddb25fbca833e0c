#include "refine/cut_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/polygons.h"
#include "base/sort_unique.h"
#include "reduce/certificate.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"
#include "refine/cut_folds.h"
#include "refine/cut_overlay.h"
#include "refine/cut_uncovered.h"

namespace tufa::refine {
namespace {

using base::Vec3f;
using reduce::Index;

// Where more than one in so many vertices is of a cell that must be split, faces are not measured:
// most would have to be again.
constexpr std::size_t kOften = 100;

// One mesh.
class Measure {
 public:
  Measure(CutOwners& owners, const octree::Cut& cut, const octree::CutMesh& made)
      : owners_(owners), cut_(cut), mesh_(made.mesh), overlay_(owners, cut, made) {}

  std::vector<VertexIndex> run(const std::vector<std::uint8_t>& changed) {
    findDirty(changed);
    overlay_.collectTriangles(wanted_);
    splitFolds();
    findOwners();
    sortCoarse();
    if (splittable() * kOften > mesh_.positions.size()) {
      leaveFaces();
    } else {
      measureFaces();
      sortCoarse();
    }
    return std::move(coarse_);
  }

 private:
  void sortCoarse() { base::sortUnique(coarse_); }

  // How many of the cells that must be split may be: then there is a next mesh.
  [[nodiscard]] std::size_t splittable() const {
    return static_cast<std::size_t>(
        std::count_if(coarse_.begin(), coarse_.end(),
                      [&](VertexIndex v) { return cut_.clusters[v].level > owners_.minLevel; }));
  }

  // Calls body(i, list) for all i, and adds the lists up to coarse_ in their order.
  template <class Body>
  void collectCoarse(std::size_t count, const Body& body) {
    std::vector<std::vector<VertexIndex>> lists((count + base::kGrain - 1) / base::kGrain);
    owners_.job.forRanges(lists.size(), 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t list = first; list < last; ++list) {
        const std::size_t end = std::min((list + 1) * base::kGrain, count);
        for (std::size_t i = list * base::kGrain; i < end; ++i) body(i, lists[list]);
      }
    });
    for (const auto& list : lists) coarse_.insert(coarse_.end(), list.begin(), list.end());
  }

  // Which uniform vertices need a new owner, which faces must be measured, and of which owners
  // these are. An owner is one no more if it was too far, or the vertex's own cluster or a vertex
  // of the owner's polygon has changed: that of a vertex of the mesh is a triangle at it. A way
  // leads over triangles that have a vertex in common with one of its owners, so it stays as it is
  // if no vertex has changed a polygon from these. A face without owners lies in the mesh, and does
  // so until a vertex of its polygon changes.
  void findDirty(const std::vector<std::uint8_t>& changed) {
    const std::vector<std::uint8_t> touched = grown(mesh_, changed, owners_.job);
    const std::size_t count = owners_.base.mesh.positions.size();
    std::vector<std::uint8_t> isNear(count, 0);
    forEach(owners_.job, count, [&](std::size_t r) {
      std::uint32_t& owner = owners_.owner[r];
      if (owner == octree::kNone) {
        isNear[r] = touched[cut_.vertexOf[r]];
        return;
      }
      const base::PolygonIndex polygon = overlay_.polygonOf(owner);
      bool isGone = polygon == octree::kNone || changed[cut_.vertexOf[r]] != 0 ||
                    owners_.distance[r] > owners_.toleranceAt(r);
      if (!isGone) {
        Triangle storage;
        for (const VertexIndex v : base::cornersOf(mesh_, polygon)) isGone |= changed[v] != 0;
        for (const VertexIndex v : overlay_.cornersOf(owner, storage)) isNear[r] |= touched[v];
      }
      if (!isGone) return;
      isNear[r] = 1;
      owner = octree::kNone;
    });
    isDirty_.assign(2 * owners_.base.mesh.quads.size(), 0);
    wanted_.assign(count, 0);
    forEach(owners_.job, isDirty_.size(), [&](std::size_t face) {
      const Triangle v = owners_.faceOf(face);
      if (owners_.faceBound[face] != kFarOff &&
          std::none_of(v.vertices.begin(), v.vertices.end(),
                       [&](VertexIndex r) { return isNear[r] != 0; })) {
        return;
      }
      isDirty_[face] = 1;
      for (const VertexIndex r : v.vertices) mark(wanted_, r);
    });
  }

  // Of a quad with one vertex in a larger cell, a triangle may have none.
  void splitFolds() {
    for (const auto& [a, b] : findFolds(overlay_.triangles(), cut_, owners_.base, owners_.job)) {
      std::vector<VertexIndex> corners;
      for (const Index t : {a, b}) {
        const base::Corners v =
            base::cornersOf(mesh_, overlay_.polygonOf(overlay_.triangles().ids[t]));
        corners.insert(corners.end(), v.begin(), v.end());
      }
      addLargest(corners, coarse_);
    }
  }

  // A triangle at a vertex that is one of the mesh. Else the nearest one around the vertex's
  // cluster, or where that is too far, one that lies nearer around the corners of that.
  void findOwners() {
    const reduce::CornersOfVertices& corners = overlay_.corners();
    const CutTriangles& triangles = overlay_.triangles();
    collectCoarse(wanted_.size(), [&](std::size_t r, std::vector<VertexIndex>& coarse) {
      if (wanted_[r] == 0 || owners_.owner[r] != octree::kNone) return;
      const VertexIndex own = cut_.vertexOf[r];
      if (overlay_.isFine(static_cast<VertexIndex>(r)) && !corners.of(own).empty()) {
        owners_.owner[r] = triangles.ids[corners.of(own).front() / 3];
        owners_.distance[r] = 0;
        return;
      }
      const Vec3f p = owners_.pointOf(static_cast<VertexIndex>(r));
      const float tolerance = owners_.toleranceAt(r);
      Index nearest = reduce::kNone;
      float least = kFarOff;
      const auto lookAround = [&](VertexIndex v) {
        for (const Index c : corners.of(v)) {
          const float d = triangles.distance(c / 3, p);
          if (d < least) least = d, nearest = c / 3;
        }
      };
      lookAround(own);
      if (nearest == reduce::kNone) return;  // its cluster has no polygons left
      if (least > tolerance) {
        const Triangle first = triangles.corners[nearest];
        for (const VertexIndex v : first.vertices) lookAround(v);
      }
      owners_.owner[r] = triangles.ids[nearest];
      owners_.distance[r] = least;
      if (least <= tolerance) return;
      addLargest(triangles.corners[nearest].vertices, coarse);
      coarse.push_back(own);
    });
  }

  // What is not measured, counts as too far, and is dirty in the next mesh.
  void leaveFaces() {
    forEach(owners_.job, isDirty_.size(), [&](std::size_t face) {
      if (isDirty_[face] != 0) owners_.faceBound[face] = kFarOff;
    });
  }

  void measureFaces() {
    collectCoarse(isDirty_.size(), [&](std::size_t face, std::vector<VertexIndex>& coarse) {
      if (isDirty_[face] == 0) return;
      float& bound = owners_.faceBound[face];
      const Triangle r = owners_.faceOf(face);
      if (overlay_.isInMesh(static_cast<std::uint32_t>(face), r)) {
        bound = 0;
        return;
      }
      bound = kFarOff;
      bool isFar = false;
      for (const VertexIndex v : r.vertices) {
        if (owners_.owner[v] == octree::kNone) {
          for (const VertexIndex c : r.vertices) coarse.push_back(cut_.vertexOf[c]);
          return;
        }
        isFar |= owners_.distance[v] > owners_.toleranceAt(v);
      }
      if (isFar) return;
      const reduce::OwnedFace owned = overlay_.ownedFace(r);
      if (owned.hasOneOwner()) {
        bound = 0;
        return;
      }
      const float limit = owners_.limitOf(r), squared = overlay_.bound2(owned, limit);
      if (squared <= limit * limit) {
        bound = std::sqrt(squared);
        return;
      }
      addOwners(owned.owners, coarse);
    });
  }

  // The vertices of owners in the largest cells; where all are of the uniform mesh, those in larger
  // cells around them.
  void addOwners(const std::array<Index, 3>& owners, std::vector<VertexIndex>& coarse) const {
    std::array<VertexIndex, 9> corners;
    for (std::size_t i = 0; i < 9; ++i)
      corners[i] = overlay_.triangles().corners[owners[i / 3]].vertices[i % 3];
    const auto isLarge = [&](VertexIndex v) { return cut_.clusters[v].level > 0; };
    if (std::any_of(corners.begin(), corners.end(), isLarge)) return addLargest(corners, coarse);
    for (const VertexIndex v : corners) {
      for (const Index c : overlay_.corners().of(v)) {
        for (const VertexIndex w : overlay_.triangles().corners[c / 3].vertices) {
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

  CutOwners& owners_;
  const octree::Cut& cut_;
  const Mesh& mesh_;
  CutOverlay overlay_;
  std::vector<std::uint8_t> isDirty_;  // of each uniform face
  std::vector<std::uint8_t> wanted_;   // corners of these
  std::vector<VertexIndex> coarse_;
};

}  // namespace

CutDistance::CutDistance(const uniform::SurfaceView& base, const LocalFrame& frame,
                         const octree::CutRule& rule, base::Job& job)
    : owners_(base, frame, rule, job) {}

std::vector<VertexIndex> CutDistance::measure(const octree::Cut& cut, const octree::CutMesh& made,
                                              const std::vector<std::uint8_t>& changed) {
  return Measure(owners_, cut, made).run(changed);
}

std::vector<VertexIndex> CutDistance::findUncovered(const octree::Cut& cut,
                                                    const octree::CutMesh& made) {
  CutUncovered found = findCutUncovered(owners_, cut, made);
  isUncovered_ = found.isAny;
  return std::move(found.vertices);
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
  for (std::size_t r = 0; r < owners_.distance.size(); ++r) {
    if (!isPresent(r)) continue;
    sum += static_cast<double>(owners_.distance[r]);
    ++count;
    largest = std::max(largest, owners_.distance[r]);
    isTooFar |= owners_.distance[r] > owners_.toleranceAt(r);
  }
  const float ofVertices = largest;
  for (std::size_t face = 0; face < owners_.faceBound.size(); ++face) {
    if (!isPresent(owners_.base.mesh.quads[face / 2].vertices[0])) continue;
    largest = std::max(largest, owners_.faceBound[face]);
  }
  isTooFar |= largest == kFarOff || isUncovered_;
  if (isTooFar) return measureWhole(cut, mesh, std::max(ofVertices, owners_.tolerance));
  return {static_cast<double>(largest), count == 0 ? 0 : sum / static_cast<double>(count)};
}

Deviation CutDistance::measureWhole(const octree::Cut& cut, const Mesh& mesh,
                                    float expected) const {
  const auto surfaceOf = [&](const Mesh& exact) {
    std::vector<Vec3f> positions(exact.positions.size());
    forEach(owners_.job, positions.size(),
            [&](std::size_t i) { positions[i] = owners_.frame.toLocal(exact.positions[i]); });
    return reduce::makeSurface(std::move(positions), triangulate(exact), owners_.job);
  };
  const reduce::ReferenceMesh reference(surfaceOf(owners_.base.mesh), {}, owners_.job);
  reduce::Surface surface = surfaceOf(mesh);
  reduce::locateAll(surface, reference, cut.vertexOf, owners_.job);
  const reduce::Certificate certificate =
      reduce::certify(surface, reference, expected, owners_.job);
  return {static_cast<double>(certificate.largest), static_cast<double>(certificate.mean)};
}

}  // namespace tufa::refine
