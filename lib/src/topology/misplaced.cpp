#include "topology/misplaced.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "base/bvh.h"
#include "base/connected.h"
#include "base/flat_triangle.h"
#include "base/huge_pages.h"
#include "base/polygons.h"
#include "base/sort_unique.h"
#include "intersect/exact.h"

namespace tufa::topology {
namespace {

// On which side of the line from a to b, seen from above, a point lies; 0 if the line is vertical.
// Up is along `axis`. A point on the line is taken as moved by an infinitesimal along the next axis
// and a smaller one along the third (simulation of simplicity, Edelsbrunner and Muecke 1990). So a
// ray never passes a vertex or an edge, and crosses each closed surface a well-defined number of
// times.
int sideFromAbove(int axis, const Position& a, const Position& b, const Position& point) {
  const int side = intersect::orientationAcross(axis, a, b, point);
  if (side != 0) return side;
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const Vec3 p(a), q(b);
  if (p[y] != q[y]) return p[y] > q[y] ? 1 : -1;
  return p[x] == q[x] ? 0 : (p[x] < q[x] ? 1 : -1);
}

// Whether the ray up from a point passes through a triangle. A point in the plane of the triangle
// does not count.
bool isAbove(int axis, const std::vector<Position>& positions, const Triangle& triangle,
             const Position& from) {
  const Position& a = positions[triangle.vertices[0]];
  const Position& b = positions[triangle.vertices[1]];
  const Position& c = positions[triangle.vertices[2]];
  const int side = sideFromAbove(axis, a, b, from);
  if (side == 0 || side != sideFromAbove(axis, b, c, from) ||
      side != sideFromAbove(axis, c, a, from)) {
    return false;
  }
  return side * intersect::orientation(a, b, c, from) < 0;
}

// A mesh and its connected components. Neighbours in a mesh are mostly neighbours in its arrays
// too, so runs of consecutive polygons have small boxes.
class Pieces {
 public:
  Pieces(const Mesh& mesh, int up, base::Job& job)
      : mesh_(mesh), up_(up), job_(job), componentOf_(connectedComponentsOf(mesh)) {
    for (VertexIndex i = 0; i < componentOf_.size(); ++i) {
      job.pollCancelled(i);
      if (componentOf_[i] == i) {
        componentOf_[i] = static_cast<std::uint32_t>(first_.size());
        first_.push_back(i);
        sizes_.push_back(0);
      } else {
        componentOf_[i] = componentOf_[componentOf_[i]];
      }
      ++sizes_[componentOf_[i]];
    }
  }

  [[nodiscard]] std::size_t count() const { return first_.size(); }
  [[nodiscard]] std::uint32_t componentOf(VertexIndex vertex) const { return componentOf_[vertex]; }
  // The lowest vertex of a component.
  [[nodiscard]] VertexIndex first(std::size_t component) const { return first_[component]; }
  // Vertices of a component.
  [[nodiscard]] std::size_t size(std::size_t component) const { return sizes_[component]; }

  // Six times the signed volume of each component. Taken about its lowest vertex, so that one far
  // from the origin does not lose its volume to rounding.
  [[nodiscard]] std::vector<double> volumes() const {
    return sums([&](std::uint32_t component, const Triangle& triangle) {
      const auto& v = triangle.vertices;
      const Vec3 origin = at(first_[component]);
      return (at(v[0]) - origin).dot((at(v[1]) - origin).cross(at(v[2]) - origin));
    });
  }

  // Twice the area of each component of at most so many vertices; 0 of others.
  [[nodiscard]] std::vector<double> areas(std::size_t mostVertices) const {
    return sums([&](std::uint32_t component, const Triangle& triangle) {
      const auto& v = triangle.vertices;
      if (sizes_[component] > mostVertices) return 0.0;
      return (at(v[1]) - at(v[0])).cross(at(v[2]) - at(v[0])).length();
    });
  }

  // For each of some vertices whether it lies inside an odd number of other components: whether a
  // ray up crosses their triangles an odd number of times. The vertices, which are few, are in a
  // tree, and the runs are looked up in it.
  [[nodiscard]] std::vector<std::uint8_t> areInside(
      const std::vector<VertexIndex>& vertices) const {
    std::vector<base::Box> points;
    for (const VertexIndex vertex : vertices) points.push_back({at(vertex), at(vertex)});
    const base::Bvh tree(std::move(points), job_);
    std::vector<std::uint8_t> inside(vertices.size(), 0);
    job_.forRanges(runCount(), 256, [&](std::size_t from, std::size_t to) {
      for (std::size_t run = from; run < to; ++run) {
        base::Box column = boxOf(run);
        column.lower[up_] = -std::numeric_limits<double>::infinity();
        tree.itemsMeeting(column, [&](std::uint32_t i, const base::Box&) {
          bool isOdd = false;
          forTrianglesOf(run, [&](const Triangle& triangle) {
            if (componentOf_[triangle.vertices[0]] == componentOf_[vertices[i]]) return;
            if (isAbove(up_, mesh_.positions, triangle, mesh_.positions[vertices[i]]))
              isOdd = !isOdd;
          });
          if (!isOdd) return;
          std::atomic_ref<std::uint8_t>(inside[i]).fetch_xor(1, std::memory_order_relaxed);
        });
      }
    });
    return inside;
  }

  // For each of some vertices the triangle of another component that is nearest to it, if there is
  // one.
  [[nodiscard]] std::vector<Triangle> nearestOthers(
      const std::vector<VertexIndex>& vertices) const {
    std::vector<base::Box> boxes;
    base::resizeLarge(boxes, runCount(), job_);
    for (std::size_t run = 0; run < boxes.size(); ++run) boxes[run] = boxOf(run);
    const base::Bvh runs(std::move(boxes), job_);
    std::vector<Triangle> found;
    for (const VertexIndex vertex : vertices) {
      job_.pollCancelled(vertex);
      double best = std::numeric_limits<double>::infinity();
      Triangle nearest;
      const std::uint32_t run = runs.nearest(at(vertex), best, [&](std::uint32_t candidate) {
        double least = best;
        forTrianglesOf(candidate, [&](const Triangle& triangle) {
          const auto& v = triangle.vertices;
          if (componentOf_[v[0]] == componentOf_[vertex]) return;
          const double squared = base::squaredDistanceTo(at(vertex), at(v[0]), at(v[1]), at(v[2]));
          if (squared >= least) return;
          least = squared;
          nearest = triangle;
        });
        return least;
      });
      if (run != base::Bvh::kNone) found.push_back(nearest);
    }
    return found;
  }

 private:
  static constexpr std::size_t kRun = 16;  // polygons

  [[nodiscard]] Vec3 at(VertexIndex vertex) const { return Vec3(mesh_.positions[vertex]); }
  [[nodiscard]] std::size_t size() const { return mesh_.quads.size() + mesh_.triangles.size(); }
  [[nodiscard]] std::size_t runCount() const { return (size() + kRun - 1) / kRun; }

  // Calls body(triangle) for those of a run, quads first.
  template <class Body>
  void forTrianglesOf(std::size_t run, const Body& body) const {
    const std::size_t end = std::min((run + 1) * kRun, size());
    for (std::size_t i = run * kRun; i < end; ++i) {
      if (i >= mesh_.quads.size()) {
        body(mesh_.triangles[i - mesh_.quads.size()]);
        continue;
      }
      const auto& v = mesh_.quads[i].vertices;
      body({v[0], v[1], v[2]});
      body({v[0], v[2], v[3]});
    }
  }
  [[nodiscard]] base::Box boxOf(std::size_t run) const {
    base::Box box = base::Box::empty();
    forTrianglesOf(run, [&](const Triangle& triangle) {
      for (const VertexIndex vertex : triangle.vertices) box.add(at(vertex));
    });
    return box;
  }
  // The sum of value(component, triangle) over the triangles of each component. Sums of parts of
  // the mesh, whichever threads make them, are added up in the order of the parts.
  template <class Value>
  [[nodiscard]] std::vector<double> sums(const Value& value) const {
    constexpr std::size_t kAtOnce = 4096;  // runs
    std::vector<std::vector<std::pair<std::uint32_t, double>>> parts(runCount() / kAtOnce + 1);
    job_.forRanges(parts.size(), 1, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        auto& part = parts[i];
        const std::size_t last = std::min((i + 1) * kAtOnce, runCount());
        for (std::size_t run = i * kAtOnce; run < last; ++run) {
          forTrianglesOf(run, [&](const Triangle& triangle) {
            const std::uint32_t component = componentOf_[triangle.vertices[0]];
            if (part.empty() || part.back().first != component) part.emplace_back(component, 0);
            part.back().second += value(component, triangle);
          });
        }
      }
    });
    std::vector<double> all(count());
    for (const auto& part : parts) {
      for (const auto& [component, sum] : part) all[component] += sum;
    }
    return all;
  }

  const Mesh& mesh_;
  int up_;  // axis of rays
  base::Job& job_;
  std::vector<std::uint32_t> componentOf_;  // of each vertex
  std::vector<VertexIndex> first_;          // of each component, its lowest vertex
  std::vector<std::size_t> sizes_;          // and how many it has
};

// All vertices of those components of which component(i) holds.
template <class Predicate>
std::vector<VertexIndex> verticesOf(const Pieces& pieces, std::size_t vertices, base::Job& job,
                                    const Predicate& component) {
  std::vector<VertexIndex> found;
  for (VertexIndex i = 0; i < vertices; ++i) {
    job.pollCancelled(i);
    if (component(pieces.componentOf(i))) found.push_back(i);
  }
  return found;
}

// Whether what lies in no other component of a closed mesh faces inward. That of the largest volume
// does not.
bool isHoleOutermost(const std::vector<double>& volumes) {
  const auto isSmaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  return *std::max_element(volumes.begin(), volumes.end(), isSmaller) < 0;
}

// The vertices of misplaced components, of those with these first vertices, and the vertices of the
// triangles of others nearest to them.
std::vector<VertexIndex> findWrong(const Pieces& pieces, const std::vector<double>& volumes,
                                   bool isOutermostHole, std::size_t allVertices,
                                   std::vector<VertexIndex> small, base::Job& job) {
  // Leaves of some vertices those on the wrong side. Those that no polygon uses are components
  // without volume, and right.
  const auto keepWrong = [&](std::vector<VertexIndex>& vertices) {
    const std::vector<std::uint8_t> inside = pieces.areInside(vertices);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const double volume = volumes[pieces.componentOf(vertices[i])];
      const bool isHole = (volume < 0) != isOutermostHole;
      if (volume != 0 && (inside[i] != 0) != isHole) vertices[kept++] = vertices[i];
    }
    vertices.resize(kept);
  };
  keepWrong(small);
  if (small.empty()) return {};
  // A component some of whose vertices are right intersects another one: it is not misplaced as a
  // whole. Only components whose first vertex is wrong are tested vertex by vertex.
  std::vector<std::size_t> wrong(pieces.count(), 0);  // vertices
  for (const VertexIndex vertex : small) wrong[pieces.componentOf(vertex)] = 1;
  const auto isWrong = [&](std::uint32_t component) { return wrong[component] != 0; };
  std::vector<VertexIndex> tested = verticesOf(pieces, allVertices, job, isWrong);
  keepWrong(tested);
  std::fill(wrong.begin(), wrong.end(), 0);
  for (const VertexIndex vertex : tested) ++wrong[pieces.componentOf(vertex)];
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    if (wrong[i] != pieces.size(i)) wrong[i] = 0;
  }
  std::vector<VertexIndex> misplaced = verticesOf(pieces, allVertices, job, isWrong);
  if (misplaced.empty()) return {};
  for (const Triangle& nearest : pieces.nearestOthers(misplaced)) {
    misplaced.insert(misplaced.end(), nearest.vertices.begin(), nearest.vertices.end());
  }
  return misplaced;
}

}  // namespace

std::vector<VertexIndex> connectedComponentsOf(const Mesh& mesh) {
  return base::connectedItems(mesh.positions.size(), [&](const auto& connect) {
    base::forPolygons(mesh, [&](base::PolygonIndex, base::Corners v) {
      for (const VertexIndex other : v) connect(v[0], other);
    });
  });
}

std::vector<VertexIndex> findMisplaced(const Mesh& mesh, base::Job& job, std::size_t mostVertices,
                                       double thinnest, const OpenMesh* open) {
  // Across the axis of an open mesh all is there that a ray may pass.
  const Pieces pieces(mesh, open != nullptr && open->axis == 2 ? 0 : 2, job);
  if (pieces.count() <= 1) return {};
  const std::size_t all = mesh.positions.size();
  std::vector<std::uint8_t> isSmall(pieces.count());
  for (std::size_t i = 0; i < pieces.count(); ++i) isSmall[i] = pieces.size(i) <= mostVertices;
  for (VertexIndex v = 0; open != nullptr && v < all; ++v) {
    job.pollCancelled(v);
    if (open->isNearEnd(mesh.positions[v])) isSmall[pieces.componentOf(v)] = 0;
  }
  std::vector<VertexIndex> small;  // the first vertex of each component that is
  for (std::size_t i = 0; i < pieces.count(); ++i) {
    if (isSmall[i] != 0) small.push_back(pieces.first(i));
  }
  if (small.empty()) return {};
  const std::vector<double> volumes = pieces.volumes();
  const bool isHole = open != nullptr ? open->isHoleOutermost : isHoleOutermost(volumes);
  std::vector<VertexIndex> found = findWrong(pieces, volumes, isHole, all, std::move(small), job);
  if (thinnest > 0) {
    // A plate of area 2A is as thick as its volume V over A; here are 6 V and 4 A.
    const std::vector<double> areas = pieces.areas(mostVertices);
    const std::vector<VertexIndex> thin = verticesOf(pieces, all, job, [&](std::uint32_t i) {
      return isSmall[i] != 0 && areas[i] > 0 && std::abs(volumes[i]) <= 1.5 * thinnest * areas[i];
    });
    found.insert(found.end(), thin.begin(), thin.end());
  }
  base::sortUnique(found);
  return found;
}

}  // namespace tufa::topology
