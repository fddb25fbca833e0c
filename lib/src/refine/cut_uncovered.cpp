#include "refine/cut_uncovered.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include "base/bits.h"
#include "base/polygons.h"
#include "reduce/box3f.h"
#include "reduce/map_degree.h"
#include "refine/cut_overlay.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

using base::Vec3f;
using reduce::Index;

class Finder {
 public:
  Finder(const CutOwners& owners, const octree::Cut& cut, const octree::CutMesh& made)
      : owners_(owners), cut_(cut), made_(made), overlay_(owners, cut, made) {}

  CutUncovered run() {
    CutUncovered found;
    const std::vector<VertexIndex> componentOf = topology::connectedComponentsOf(made_.mesh);
    const std::vector<VertexIndex> seedOf = findSeeds(componentOf);
    findFacesNear(componentOf, seedOf);
    overlay_.collectTriangles(isCorner_);
    std::vector<std::pair<VertexIndex, std::uint32_t>> faces;  // of components
    for (std::uint32_t face = 0; face < isNear_.size(); ++face) {
      if (isNear_[face] == 0) continue;
      faces.emplace_back(componentOf[cut_.vertexOf[owners_.faceOf(face).vertices[0]]], face);
    }
    std::sort(faces.begin(), faces.end());
    std::vector<std::uint8_t> levelOf(seedOf.size(), 0);  // of each component the largest
    std::vector<std::uint8_t> isUncovered(seedOf.size(), 0);
    auto next = faces.begin();
    for (VertexIndex component = 0; component < seedOf.size(); ++component) {
      const auto first = next;
      while (next != faces.end() && next->first == component) ++next;
      if (seedOf[component] == octree::kNone) continue;
      const std::optional<int> degree = degreeAt(seedOf[component], {first, next});
      if (degree == 1) continue;
      found.isAny = true;
      isUncovered[component] = degree.has_value() ? 1 : 0;
    }
    for (VertexIndex v = 0; v < componentOf.size(); ++v) {
      std::uint8_t& level = levelOf[componentOf[v]];
      level = std::max(level, cut_.clusters[v].level);
    }
    for (VertexIndex v = 0; v < componentOf.size(); ++v) {
      const VertexIndex component = componentOf[v];
      if (isUncovered[component] != 0 && cut_.clusters[v].level == levelOf[component]) {
        found.vertices.push_back(v);
      }
    }
    return found;
  }

 private:
  // Of each closed component a vertex of a larger cell, none where all is as in the uniform mesh.
  [[nodiscard]] std::vector<VertexIndex> findSeeds(
      const std::vector<VertexIndex>& componentOf) const {
    std::vector<VertexIndex> seedOf(componentOf.size(), octree::kNone);
    base::forPolygons(made_.mesh, [&](base::PolygonIndex, base::Corners v) {
      VertexIndex& seed = seedOf[componentOf[v[0]]];
      if (seed != octree::kNone) return;
      const auto large = std::find_if(v.begin(), v.end(),
                                      [&](VertexIndex k) { return cut_.clusters[k].level > 0; });
      if (large != v.end()) seed = *large;
    });
    if (owners_.base.topology.openEdges == 0) return seedOf;
    const std::vector<std::uint64_t> oddEdges = oddEdgesOf(componentOf);
    for (std::size_t i = 0; i < seedOf.size(); ++i) {
      if (oddEdges[i] != 0) seedOf[i] = octree::kNone;
    }
    return seedOf;
  }

  // For each component the exclusive or of its polygons' edges, as mixed keys: 0 if every edge has
  // two polygons, as in a closed component.
  [[nodiscard]] std::vector<std::uint64_t> oddEdgesOf(
      const std::vector<VertexIndex>& componentOf) const {
    std::vector<std::uint64_t> odd(componentOf.size(), 0);
    base::forPolygons(made_.mesh, [&](base::PolygonIndex, base::Corners v) {
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
    isNear_.assign(2 * owners_.base.mesh.quads.size(), 0);
    isCorner_.assign(owners_.base.mesh.positions.size(), 0);
    forEach(owners_.job, isNear_.size(), [&](std::size_t face) {
      const Triangle r = owners_.faceOf(face);
      const VertexIndex seed = seedOf[componentOf[cut_.vertexOf[r.vertices[0]]]];
      if (seed == octree::kNone) return;
      const auto& [a, b, c] = r.vertices;
      const std::array<Vec3f, 3> p{owners_.pointOf(a), owners_.pointOf(b), owners_.pointOf(c)};
      const Vec3f at = owners_.frame.toLocal(made_.mesh.positions[seed]);
      const float limit = owners_.limitOf(r);
      reduce::Box3f box = reduce::boxOf(p.data());
      box.growBy(2 * limit);
      if (!box.meets({at, at})) return;
      if (reduce::squaredDistanceToTriangle(at, p[0], p[1], p[2]) > limit * limit) return;
      if (overlay_.isInMesh(static_cast<std::uint32_t>(face), r)) return;
      if (std::any_of(r.vertices.begin(), r.vertices.end(),
                      [&](VertexIndex v) { return owners_.owner[v] == octree::kNone; }))
        return;
      isNear_[face] = 1;
      for (const VertexIndex v : r.vertices) mark(isCorner_, v);
    });
  }

  // How often some uniform faces cover a vertex; unknown if one of them has no way, as where cells
  // may not be split.
  [[nodiscard]] std::optional<int> degreeAt(
      VertexIndex v, std::span<const std::pair<VertexIndex, std::uint32_t>> faces) const {
    const std::span<const Index> corners = overlay_.corners().of(v);
    if (corners.empty()) return 0;  // no face is near
    reduce::MapDegree degree(overlay_.triangles(), v, corners.front() / 3);
    for (const auto& [component, face] : faces) {
      const Triangle r = owners_.faceOf(face);
      const float limit = owners_.limitOf(r);
      const float found = overlay_.bound2(overlay_.ownedFace(r), limit,
                                          [&](const reduce::OverlayTurn& turn) { degree(turn); });
      if (!(found <= limit * limit)) return {};
    }
    return degree.degree();
  }

  const CutOwners& owners_;
  const octree::Cut& cut_;
  const octree::CutMesh& made_;
  CutOverlay overlay_;
  std::vector<std::uint8_t> isNear_;    // of each face, whether it is near the seed
  std::vector<std::uint8_t> isCorner_;  // of these faces
};

}  // namespace

CutUncovered findCutUncovered(const CutOwners& owners, const octree::Cut& cut,
                              const octree::CutMesh& made) {
  return Finder(owners, cut, made).run();
}

}  // namespace tufa::refine
