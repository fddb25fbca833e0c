#include "topology/misplaced.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/bvh.h"
#include "base/connected.h"
#include "base/flat_triangle.h"
#include "base/polygons.h"
#include "base/sort_unique.h"
#include "intersect/exact.h"

namespace tufa::topology {
namespace {

// On which side of the line from a to b, seen from above, a point lies; 0 if the line is vertical.
// A point on the line is taken as moved by an infinitesimal along x and a smaller one along y
// (simulation of simplicity, Edelsbrunner and Muecke 1990). So a ray never passes a vertex or an
// edge, and crosses each closed surface a well-defined number of times.
int sideFromAbove(const Position& a, const Position& b, const Position& point) {
  const int side = intersect::orientationAcross(2, a, b, point);
  if (side != 0) return side;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;
  return a.x == b.x ? 0 : (a.x < b.x ? 1 : -1);
}

// Whether the ray up from a point passes through a triangle. A point in the plane of the triangle
// does not count.
bool isAbove(const std::vector<Position>& positions, const Triangle& triangle,
             const Position& from) {
  const Position& a = positions[triangle.vertices[0]];
  const Position& b = positions[triangle.vertices[1]];
  const Position& c = positions[triangle.vertices[2]];
  const int side = sideFromAbove(a, b, from);
  if (side == 0 || side != sideFromAbove(b, c, from) || side != sideFromAbove(c, a, from)) {
    return false;
  }
  return side * intersect::orientation(a, b, c, from) < 0;
}

// A mesh and its connected components, to find what lies around a vertex. Neighbours in a mesh are
// mostly neighbours in its arrays too, so boxes of runs of consecutive polygons serve as the leaves
// of the tree.
class Pieces {
 public:
  Pieces(const Mesh& mesh, const std::vector<VertexIndex>& components, base::Job& job)
      : mesh_(mesh), components_(components), runs_(boxesOfRuns(job), job) {}

  // Six times the signed volume of each component, at its lowest vertex. Taken about that vertex,
  // so that a component far from the origin does not lose its volume to rounding.
  [[nodiscard]] std::vector<double> volumes() const {
    std::vector<double> volumes(components_.size());
    forTriangles(0, mesh_.quads.size() + mesh_.triangles.size(), [&](const Triangle& triangle) {
      const auto& v = triangle.vertices;
      const VertexIndex component = components_[v[0]];
      const Vec3 origin = at(component);
      volumes[component] += (at(v[0]) - origin).dot((at(v[1]) - origin).cross(at(v[2]) - origin));
    });
    return volumes;
  }

  // Whether the vertex lies inside an odd number of other components: whether a ray up crosses
  // their triangles an odd number of times.
  [[nodiscard]] bool isInside(VertexIndex vertex) const {
    bool inside = false;
    runs_.itemsAbove(at(vertex), [&](std::uint32_t run) {
      forTriangles(begin(run), end(run), [&](const Triangle& triangle) {
        if (components_[triangle.vertices[0]] == components_[vertex]) return;
        inside ^= isAbove(mesh_.positions, triangle, mesh_.positions[vertex]);
      });
    });
    return inside;
  }

  // Finds the triangle of another component that is nearest to a vertex. False if there is none.
  [[nodiscard]] bool findNearestOther(VertexIndex vertex, Triangle& nearest) const {
    double best = std::numeric_limits<double>::infinity();
    return runs_.nearest(at(vertex), best, [&](std::uint32_t run) {
      double least = best;
      forTriangles(begin(run), end(run), [&](const Triangle& triangle) {
        const auto& v = triangle.vertices;
        if (components_[v[0]] == components_[vertex]) return;
        const double squared = base::squaredDistanceTo(at(vertex), at(v[0]), at(v[1]), at(v[2]));
        if (squared >= least) return;
        least = squared;
        nearest = triangle;
      });
      return least;
    }) != base::Bvh::kNone;
  }

 private:
  static constexpr std::size_t kRun = 16;

  [[nodiscard]] Vec3 at(VertexIndex vertex) const { return Vec3(mesh_.positions[vertex]); }
  [[nodiscard]] std::size_t size() const { return mesh_.quads.size() + mesh_.triangles.size(); }
  [[nodiscard]] static std::size_t begin(std::uint32_t run) { return run * kRun; }
  [[nodiscard]] std::size_t end(std::uint32_t run) const {
    return std::min(begin(run) + kRun, size());
  }

  // Calls body(triangle) for those of the polygons `begin` to `end`, quads first.
  template <class Body>
  void forTriangles(std::size_t begin, std::size_t end, const Body& body) const {
    for (std::size_t i = begin; i < end; ++i) {
      if (i >= mesh_.quads.size()) {
        body(mesh_.triangles[i - mesh_.quads.size()]);
        continue;
      }
      const auto& v = mesh_.quads[i].vertices;
      body({v[0], v[1], v[2]});
      body({v[0], v[2], v[3]});
    }
  }
  [[nodiscard]] std::vector<base::Box> boxesOfRuns(base::Job& job) const {
    std::vector<base::Box> boxes((size() + kRun - 1) / kRun, base::Box::empty());
    job.forRanges(boxes.size(), 256, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const auto run = static_cast<std::uint32_t>(i);
        forTriangles(begin(run), end(run), [&](const Triangle& triangle) {
          for (const VertexIndex vertex : triangle.vertices) boxes[i].add(at(vertex));
        });
      }
    });
    return boxes;
  }

  const Mesh& mesh_;
  const std::vector<VertexIndex>& components_;
  base::Bvh runs_;
};

}  // namespace

std::vector<VertexIndex> connectedComponentsOf(const Mesh& mesh) {
  return base::connectedItems(mesh.positions.size(), [&](const auto& connect) {
    base::forPolygons(mesh, [&](base::PolygonIndex, base::Corners v) {
      for (const VertexIndex other : v) connect(v[0], other);
    });
  });
}

std::vector<VertexIndex> findMisplaced(const Mesh& mesh, base::Job& job, std::size_t mostVertices) {
  const std::vector<VertexIndex> names = connectedComponentsOf(mesh);
  std::vector<VertexIndex> misplaced;
  if (std::all_of(names.begin(), names.end(), [](VertexIndex name) { return name == 0; })) {
    return misplaced;
  }
  std::vector<std::uint32_t> sizes(names.size(), 0);
  for (const VertexIndex name : names) ++sizes[name];
  if (std::none_of(sizes.begin(), sizes.end(),
                   [&](std::uint32_t size) { return size > 0 && size <= mostVertices; })) {
    return misplaced;
  }
  const Pieces components(mesh, names, job);
  // Vertices that no polygon uses are components without volume. The component of the largest
  // volume lies in no other one.
  const std::vector<double> volumes = components.volumes();
  const auto isSmaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const double outermost = *std::max_element(volumes.begin(), volumes.end(), isSmaller);
  const auto isWrong = [&](std::size_t vertex) {
    const double volume = volumes[names[vertex]];
    if (volume == 0) return false;
    const bool isHole = (volume < 0) != (outermost < 0);
    return components.isInside(static_cast<VertexIndex>(vertex)) != isHole;
  };
  std::vector<std::uint8_t> wrong(names.size(), 0);
  job.forRanges(names.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      wrong[i] = names[i] == i && sizes[i] <= mostVertices && isWrong(i) ? 1 : 0;
    }
  });
  // A component some of whose vertices are right intersects another one: it is not misplaced as a
  // whole. Only components whose first vertex is wrong are tested vertex by vertex.
  for (std::size_t i = 0; i < names.size(); ++i) {
    job.pollCancelled(i);
    if (names[i] != i && wrong[names[i]] != 0 && !isWrong(i)) wrong[names[i]] = 0;
  }
  for (VertexIndex i = 0; i < names.size(); ++i) {
    job.pollCancelled(i);
    if (wrong[names[i]] == 0) continue;
    misplaced.push_back(i);
    Triangle nearest;
    if (!components.findNearestOther(i, nearest)) continue;
    misplaced.insert(misplaced.end(), nearest.vertices.begin(), nearest.vertices.end());
  }
  base::sortUnique(misplaced);
  return misplaced;
}

}  // namespace tufa::topology
