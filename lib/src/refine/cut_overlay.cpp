#include "refine/cut_overlay.h"

#include <algorithm>
#include <array>

#include "base/huge_pages.h"

namespace tufa::refine {
namespace {

using base::Vec3f;
using reduce::Index;

}  // namespace

std::vector<std::uint8_t> grown(const Mesh& mesh, const std::vector<std::uint8_t>& marks,
                                base::Job& job) {
  std::vector<std::uint8_t> more = marks;
  const std::size_t count = mesh.quads.size() + mesh.triangles.size();
  job.forRanges(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const base::Corners v = base::cornersOf(mesh, static_cast<base::PolygonIndex>(i));
      if (std::none_of(v.begin(), v.end(), [&](VertexIndex c) { return marks[c] != 0; })) continue;
      for (const VertexIndex c : v) mark(more, c);
    }
  });
  return more;
}

CutOverlay::CutOverlay(const CutOwners& owners, const octree::Cut& cut, const octree::CutMesh& made)
    : owners_(owners), cut_(cut), made_(made), mesh_(made.mesh) {
  base::resizeLarge(polygonOf_, owners_.base.mesh.quads.size(), owners_.job, octree::kNone);
  forEach(owners_.job, mesh_.quads.size() + mesh_.triangles.size(), [&](std::size_t i) {
    const auto polygon = static_cast<base::PolygonIndex>(i);
    polygonOf_[made_.sourceOf(polygon)] = polygon;
  });
}

base::Corners CutOverlay::cornersOf(std::uint32_t id, Triangle& storage) const {
  const base::PolygonIndex polygon = polygonOf_[id / 2];
  if (polygon == octree::kNone) return {};
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

bool CutOverlay::isInMesh(std::uint32_t face, const Triangle& r) const {
  Triangle own;
  if (!std::all_of(r.vertices.begin(), r.vertices.end(), [&](VertexIndex v) { return isFine(v); }))
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

// The triangles that ways may lead over: around the owners, found or to be found up to two
// polygons from a cluster, and one polygon more for what is pulled over a vertex there.
void CutOverlay::collectTriangles(const std::vector<std::uint8_t>& isCorner) {
  std::vector<std::uint8_t> marks(mesh_.positions.size());
  forEach(owners_.job, isCorner.size(), [&](std::size_t r) {
    if (isCorner[r] == 0) return;
    mark(marks, cut_.vertexOf[r]);
    if (owners_.owner[r] == octree::kNone) return;
    Triangle storage;
    for (const VertexIndex v : cornersOf(owners_.owner[r], storage)) mark(marks, v);
  });
  for (int i = 0; i < 3; ++i) marks = grown(mesh_, marks, owners_.job);
  addMarked(marks);
  base::resizeLarge(triangles_.positions, mesh_.positions.size(), owners_.job);
  forEach(owners_.job, mesh_.positions.size(), [&](std::size_t i) {
    triangles_.positions[i] = owners_.frame.toLocal(mesh_.positions[i]);
  });
  corners_.emplace(mesh_.positions.size(), triangles_.corners, owners_.job);
  triangles_.opposite = reduce::oppositeCorners(triangles_.corners, *corners_, owners_.job);
}

// The triangles of polygons with a marked vertex, in the order of the mesh. Each range of polygons
// is counted first, so that ranges are filled in at the same time.
void CutOverlay::addMarked(const std::vector<std::uint8_t>& marks) {
  const std::size_t count = mesh_.quads.size() + mesh_.triangles.size();
  const auto forMarked = [&](std::size_t range, const auto& body) {
    const std::size_t end = std::min((range + 1) * base::kGrain, count);
    for (std::size_t i = range * base::kGrain; i < end; ++i) {
      const auto polygon = static_cast<base::PolygonIndex>(i);
      const base::Corners v = base::cornersOf(mesh_, polygon);
      if (std::any_of(v.begin(), v.end(), [&](VertexIndex c) { return marks[c] != 0; }))
        body(polygon, v);
    }
  };
  const std::size_t ranges = (count + base::kGrain - 1) / base::kGrain;
  std::vector<Index> first(ranges + 1);
  owners_.job.forRanges(ranges, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t range = begin; range < end; ++range) {
      forMarked(range, [&](base::PolygonIndex, base::Corners v) {
        first[range + 1] += static_cast<Index>(v.size() - 2);
      });
    }
  });
  for (std::size_t range = 0; range < ranges; ++range) first[range + 1] += first[range];
  base::resizeLarge(triangles_.corners, first[ranges], owners_.job);
  base::resizeLarge(triangles_.ids, first[ranges], owners_.job);
  base::resizeLarge(firstLocal_, count, owners_.job);
  owners_.job.forRanges(ranges, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t range = begin; range < end; ++range) {
      Index next = first[range];
      const auto add = [&](const Triangle& corners, std::uint32_t id) {
        triangles_.corners[next] = corners;
        triangles_.ids[next++] = id;
      };
      forMarked(range, [&](base::PolygonIndex polygon, base::Corners v) {
        const std::uint32_t id = 2 * made_.sourceOf(polygon);
        firstLocal_[polygon] = next;
        add({v[0], v[1], v[2]}, id);
        if (v.size() == 4) add({v[0], v[2], v[3]}, id + 1);
      });
    }
  });
}

reduce::OwnedFace CutOverlay::ownedFace(const Triangle& r) const {
  reduce::OwnedFace owned;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexIndex v = r.vertices[i];
    owned.corners[i] = owners_.pointOf(v);
    owned.vertices[i] = v;
    owned.owners[i] = localOf(owners_.owner[v]);
  }
  return owned;
}

float CutOverlay::bound2(const reduce::OwnedFace& face, float limit) const {
  const float across2 = acrossOneEdge2(face);
  if (across2 <= limit * limit) return across2;
  return bound2(face, limit, [](const reduce::OverlayTurn&) {});
}

// The bound for a face of two owners that share an edge, which most faces are that have more than
// one: two of its edges pass that one. kFar2 for any other.
float CutOverlay::acrossOneEdge2(const reduce::OwnedFace& face) const {
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

// The way of an edge from corner a to corner b. One that is an edge of the mesh stays where it
// is, so that the faces do of which all edges are.
bool CutOverlay::findWay(const reduce::OwnedFace& face, std::size_t a, std::size_t b, float limit2,
                         reduce::OverlayPath& way) const {
  if (isFine(face.vertices[a]) && isFine(face.vertices[b])) {
    const VertexIndex from = cut_.vertexOf[face.vertices[a]], to = cut_.vertexOf[face.vertices[b]];
    const auto around = corners_->of(from);
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

}  // namespace tufa::refine
