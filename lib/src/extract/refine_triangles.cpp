#include "extract/refine_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/huge_pages.h"
#include "extract/triangle_edges.h"
#include "extract/trilinear_surface.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {
namespace {

constexpr double kLeastEdge = 0.125;  // voxels: halves are the finest
// Each halves edges of a voxel or two: far more than there are. What is left then is reported.
constexpr int kMostRounds = 64;
constexpr VertexIndex kUnsplit = ~VertexIndex{0};

class Refiner {
 public:
  Refiner(const grid::Volume& volume, const RefineRule& rule, Mesh& mesh, base::Job& job)
      : volume_(volume), rule_(rule), mesh_(mesh), job_(job) {}

  Refinement run() {
    mesh_.triangles = triangulate(mesh_);
    mesh_.quads = {};
    findMoves();
    isNew_.assign(mesh_.triangles.size(), 1);
    const std::size_t before = mesh_.positions.size();
    Refinement reached;
    while (true) {
      const TriangleEdges edges(mesh_.triangles, job_);
      settle(edges);
      if (reached.rounds == kMostRounds || !markEdges(edges)) break;
      markLongest(edges);
      splitEdges(edges);
      splitTriangles(edges);
      ++reached.rounds;
    }
    reached.addedVertices = mesh_.positions.size() - before;
    measure(reached);
    return reached;
  }

 private:
  /// Calls body(surface, index) for each index below `count`, in parallel.
  template <class Body>
  void forEach(std::size_t count, const Body& body) {
    job_.forRanges(count, 1024, [&](std::size_t begin, std::size_t end) {
      TrilinearSurface surface(volume_);
      for (std::size_t i = begin; i < end; ++i) body(surface, i);
    });
  }

  [[nodiscard]] Vec3 at(VertexIndex vertex) const { return {mesh_.positions[vertex]}; }

  [[nodiscard]] Vec3 middleOf(const Triangle& triangle) const {
    const auto& v = triangle.vertices;
    return (at(v[0]) + at(v[1]) + at(v[2])) / 3;
  }

  [[nodiscard]] bool hasStaying(const Triangle& triangle) const {
    const auto& v = triangle.vertices;
    return (stays_[v[0]] | stays_[v[1]] | stays_[v[2]]) != 0;
  }

  // As long as twice the area.
  [[nodiscard]] Vec3 normalOf(const Triangle& triangle) const {
    const auto& v = triangle.vertices;
    return (at(v[1]) - at(v[0])).cross(at(v[2]) - at(v[0]));
  }

  [[nodiscard]] Vec3 normalOf(const TriangleEdges& edges, EdgeIndex edge) const {
    Vec3 sum(0);
    for (const std::uint32_t t : edges.around(edge)) sum += normalOf(mesh_.triangles[t]);
    return sum;
  }

  // The foot of a point of the mesh, unless its way leads sideways or to the other side of a sheet.
  static std::optional<TrilinearSurface::Foot> footOf(TrilinearSurface& surface, const Vec3& point,
                                                      double reach, const Vec3& normal) {
    constexpr double kLeastCosine = 0.5;
    auto foot = surface.footOf(point, reach);
    if (foot && foot->outward.dot(normal) < kLeastCosine * normal.length()) foot.reset();
    return foot;
  }

  // Finds where the vertices go, and those that stay where they are.
  void findMoves() {
    std::vector<Vec3> normals(mesh_.positions.size(), Vec3(0));
    std::vector<double> reach(mesh_.positions.size(), TrilinearSurface::kReach);
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      job_.pollCancelled(i);
      const auto& corners = mesh_.triangles[i].vertices;
      const Vec3 normal = normalOf(mesh_.triangles[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexIndex a = corners[k], b = corners[(k + 1) % 3];
        normals[a] += normal;
        // So that the ends of an edge do not pass each other.
        const double half = (at(a) - at(b)).length() / 2 / volume_.affine.voxelSize();
        reach[a] = std::min(reach[a], half);
        reach[b] = std::min(reach[b], half);
      }
    }
    stays_.assign(mesh_.positions.size(), 0);
    moves_.assign(mesh_.positions.size(), {});
    forEach(moves_.size(), [&](TrilinearSurface& surface, std::size_t i) {
      const double distance = surface.distanceOf(mesh_.positions[i], rule_.tolerance);
      if (distance <= rule_.tolerance || distance > rule_.stayBeyond) return;
      const auto foot = footOf(surface, mesh_.positions[i], reach[i], normals[i]);
      if (foot) moves_[i] = {foot->point, foot->normal, true};
    });
  }

  // Where one of the last vertices goes, if it does.
  struct Move {
    Vec3 to;
    Normal normal;
    bool moves = false;
  };

  // Makes the moves, but for those that would fold the mesh.
  void settle(const TriangleEdges& edges) {
    const std::size_t first = mesh_.positions.size() - moves_.size();
    refuseFolds(edges, first);
    forEach(moves_.size(), [&](TrilinearSurface& surface, std::size_t i) {
      const std::size_t vertex = first + i;
      if (!moves_[i].moves) {
        const double distance = surface.distanceOf(mesh_.positions[vertex], rule_.tolerance);
        stays_[vertex] = distance > rule_.tolerance ? 1 : 0;
        return;
      }
      mesh_.positions[vertex] = moves_[i].to;
      if (!mesh_.normals.empty()) mesh_.normals[vertex] = moves_[i].normal;
    });
  }

  // Refuses the moves around triangles that they would turn too far, and around edges that they
  // would fold over, until there are none. Each round refuses some, so it ends: without moves all
  // is as it was.
  void refuseFolds(const TriangleEdges& edges, std::size_t first) {
    const auto after = [&](VertexIndex vertex) {
      return vertex < first || !moves_[vertex - first].moves ? at(vertex)
                                                             : moves_[vertex - first].to;
    };
    std::vector<Vec3> normals(mesh_.triangles.size(), Vec3(0));
    std::vector<std::uint8_t> folded(mesh_.triangles.size());
    for (bool found = true; found;) {
      forEach(folded.size(), [&](TrilinearSurface&, std::size_t i) {
        const auto& [a, b, c] = mesh_.triangles[i].vertices;
        normals[i] = (after(b) - after(a)).cross(after(c) - after(a));
        folded[i] = turns(normalOf(mesh_.triangles[i]), normals[i]) ? 1 : 0;
      });
      forEach(folded.size(), [&](TrilinearSurface&, std::size_t i) {
        for (const EdgeIndex edge : edges.sides(i)) {
          if (foldsOver(edges.around(edge), normals)) folded[i] = 1;
        }
      });
      found = false;
      for (std::size_t i = 0; i < folded.size(); ++i) {
        job_.pollCancelled(i);
        if (folded[i] == 0) continue;
        for (const VertexIndex vertex : mesh_.triangles[i].vertices) {
          if (vertex < first || !moves_[vertex - first].moves) continue;
          moves_[vertex - first].moves = false;
          found = true;
        }
      }
    }
  }

  static bool turns(const Vec3& before, const Vec3& after) {
    constexpr double kLeastCosine = 0.5;
    const double lengths = before.length() * after.length();
    return before.squaredLength() > 0 && !(before.dot(after) > kLeastCosine * lengths);
  }

  // Whether the two triangles around an edge come to face each other, more so than they did.
  bool foldsOver(std::span<const std::uint32_t> around, const std::vector<Vec3>& after) const {
    constexpr double kLeastCosine = -0.5;
    if (around.size() != 2) return false;
    const auto cosine = [](const Vec3& a, const Vec3& b) {
      const double lengths = a.length() * b.length();
      return lengths > 0 ? a.dot(b) / lengths : 1;
    };
    const double now = cosine(after[around[0]], after[around[1]]);
    if (now >= kLeastCosine) return false;
    return now < cosine(normalOf(mesh_.triangles[around[0]]), normalOf(mesh_.triangles[around[1]]));
  }

  // Marks the edges whose middles are off, and the longest edges of triangles whose own middle
  // alone is. Returns whether there are some.
  bool markEdges(const TriangleEdges& edges) {
    squaredLengths_.resize(edges.size());
    marked_.assign(edges.size(), 0);
    forEach(edges.size(), [&](TrilinearSurface& surface, std::size_t i) {
      const auto edge = static_cast<EdgeIndex>(i);
      const auto [a, b] = edges.ends(edge);
      squaredLengths_[i] = (at(a) - at(b)).squaredLength();
      const auto around = edges.around(edge);
      if (std::none_of(around.begin(), around.end(), [&](auto t) { return isNew_[t] != 0; })) {
        return;
      }
      if ((stays_[a] | stays_[b]) != 0 || !isLong(edge)) return;
      const Vec3 middle = (at(a) + at(b)) / 2;
      if (surface.distanceOf(middle, rule_.tolerance) <= rule_.tolerance) return;
      marked_[i] = footOf(surface, middle, reachOf(edge), normalOf(edges, edge)) ? 1 : 0;
    });
    // Not marked at once: that would change what other triangles see.
    std::vector<std::uint8_t> isOff(mesh_.triangles.size(), 0);
    forEach(isOff.size(), [&](TrilinearSurface& surface, std::size_t i) {
      if (isNew_[i] == 0 || hasStaying(mesh_.triangles[i])) return;
      const auto& sides = edges.sides(i);
      if (std::any_of(sides.begin(), sides.end(), [&](auto e) { return marked_[e] != 0; })) return;
      if (!isLong(longestOf(edges, i))) return;
      const Vec3 middle = middleOf(mesh_.triangles[i]);
      isOff[i] = surface.distanceOf(middle, rule_.tolerance) > rule_.tolerance ? 1 : 0;
    });
    for (std::size_t i = 0; i < isOff.size(); ++i) {
      if (isOff[i] != 0) marked_[longestOf(edges, i)] = 1;
    }
    return std::find(marked_.begin(), marked_.end(), 1) != marked_.end();
  }

  [[nodiscard]] bool isLong(EdgeIndex edge) const {
    const double least = kLeastEdge * volume_.affine.voxelSize();
    return squaredLengths_[edge] >= least * least;
  }

  // How far the middle of an edge may be moved, in voxels: its halves are shorter than it then.
  [[nodiscard]] double reachOf(EdgeIndex edge) const {
    return std::min(std::sqrt(squaredLengths_[edge]) / 4 / volume_.affine.voxelSize(),
                    TrilinearSurface::kReach);
  }

  [[nodiscard]] EdgeIndex longestOf(const TriangleEdges& edges, std::size_t triangle) const {
    const auto& sides = edges.sides(triangle);
    // One order for all triangles: of edges as long, that of the lowest number.
    return *std::max_element(sides.begin(), sides.end(), [&](EdgeIndex a, EdgeIndex b) {
      return squaredLengths_[a] != squaredLengths_[b] ? squaredLengths_[a] < squaredLengths_[b]
                                                      : a > b;
    });
  }

  // Marks the longest edge of each triangle with a marked one. Each edge leads to longer ones, so
  // it ends.
  void markLongest(const TriangleEdges& edges) {
    std::vector<EdgeIndex> open;
    for (std::size_t i = 0; i < marked_.size(); ++i) {
      if (marked_[i] != 0) open.push_back(static_cast<EdgeIndex>(i));
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
      job_.pollCancelled(i);
      for (const std::uint32_t triangle : edges.around(open[i])) {
        const EdgeIndex longest = longestOf(edges, triangle);
        if (marked_[longest] != 0) continue;
        marked_[longest] = 1;
        open.push_back(longest);
      }
    }
  }

  // Puts a vertex into the middle of each marked edge, and finds its way to the surface, unless the
  // edge ends on a crease.
  void splitEdges(const TriangleEdges& edges) {
    const std::size_t before = mesh_.positions.size();
    std::size_t count = before;
    added_.assign(edges.size(), kUnsplit);
    std::vector<EdgeIndex> split;
    for (std::size_t i = 0; i < added_.size(); ++i) {
      job_.pollCancelled(i);
      if (marked_[i] == 0) continue;
      added_[i] = static_cast<VertexIndex>(count++);
      split.push_back(static_cast<EdgeIndex>(i));
    }
    uniform::requireIndexable(count);
    const bool normals = !mesh_.normals.empty();
    mesh_.positions.resize(count);
    if (normals) mesh_.normals.resize(count);
    stays_.resize(count, 0);
    // Into the middles first: so the parts of a triangle have its normal.
    moves_.assign(split.size(), {});
    forEach(split.size(), [&](TrilinearSurface& surface, std::size_t i) {
      const std::size_t vertex = before + i;
      const auto [a, b] = edges.ends(split[i]);
      const Vec3 middle = (at(a) + at(b)) / 2;
      mesh_.positions[vertex] = middle;
      if (normals) {
        Vec3 normal = Vec3(mesh_.normals[a]) + Vec3(mesh_.normals[b]);
        if (!normal.normalize()) normal = Vec3(mesh_.normals[a]);
        mesh_.normals[vertex] = Normal(normal);
      }
      if ((stays_[a] | stays_[b]) != 0) return;
      const auto foot = footOf(surface, middle, reachOf(split[i]), normalOf(edges, split[i]));
      if (foot) moves_[i] = {foot->point, foot->normal, true};
    });
  }

  void splitTriangles(const TriangleEdges& edges) {
    std::vector<std::size_t> first(mesh_.triangles.size() + 1, 0);
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      job_.pollCancelled(i);
      first[i + 1] = first[i] + 1;
      for (const EdgeIndex edge : edges.sides(i)) first[i + 1] += marked_[edge];
    }
    std::vector<Triangle> split;
    base::resizeLarge(split, first.back(), job_);
    std::vector<std::uint8_t> isNew(split.size(), 0);
    job_.forRanges(mesh_.triangles.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        writeParts(edges, i, split.data() + first[i]);
        if (first[i + 1] - first[i] == 1) continue;
        std::fill(isNew.begin() + static_cast<std::ptrdiff_t>(first[i]),
                  isNew.begin() + static_cast<std::ptrdiff_t>(first[i + 1]), std::uint8_t{1});
      }
    });
    mesh_.triangles = std::move(split);
    isNew_ = std::move(isNew);
  }

  // Writes what a triangle becomes. If one of its edges is split, so is its longest.
  void writeParts(const TriangleEdges& edges, std::size_t triangle, Triangle* out) const {
    const auto& corners = mesh_.triangles[triangle].vertices;
    const auto& sides = edges.sides(triangle);
    const EdgeIndex longest = longestOf(edges, triangle);
    if (marked_[longest] == 0) {
      *out = mesh_.triangles[triangle];
      return;
    }
    // Turned so that the longest edge is from a to b.
    const std::size_t turn = longest == sides[0] ? 0 : longest == sides[1] ? 1 : 2;
    const VertexIndex a = corners[turn], b = corners[(turn + 1) % 3], c = corners[(turn + 2) % 3];
    const VertexIndex ab = added_[longest], bc = added_[sides[(turn + 1) % 3]],
                      ca = added_[sides[(turn + 2) % 3]];
    if (bc != kUnsplit && ca != kUnsplit) {
      *out++ = {a, ab, ca};
      *out++ = {ab, b, bc};
      *out++ = {ca, bc, c};
      *out = {ab, bc, ca};
      return;
    }
    if (ca == kUnsplit) {
      *out++ = {a, ab, c};
    } else {
      *out++ = {a, ab, ca};
      *out++ = {ca, ab, c};
    }
    if (bc == kUnsplit) {
      *out = {ab, b, c};
    } else {
      *out++ = {ab, b, bc};
      *out = {ab, bc, c};
    }
  }

  // How far the triangles are from the surface now.
  void measure(Refinement& reached) {
    constexpr float kStays = -1;
    std::vector<float> off(mesh_.triangles.size(), kStays);
    forEach(off.size(), [&](TrilinearSurface& surface, std::size_t i) {
      const Triangle& triangle = mesh_.triangles[i];
      if (hasStaying(triangle)) return;
      double most = surface.distanceOf(middleOf(triangle), rule_.tolerance);
      for (std::size_t side = 0; side < 3; ++side) {
        const Vec3 a = at(triangle.vertices[side]), b = at(triangle.vertices[(side + 1) % 3]);
        most = std::max({most, surface.distanceOf(a, rule_.tolerance),
                         surface.distanceOf((a + b) / 2, rule_.tolerance)});
      }
      off[i] = static_cast<float>(most);
    });
    for (const float distance : off) {
      if (distance == kStays) {
        ++reached.creaseTriangles;
        continue;
      }
      reached.largestVoxels = std::max(reached.largestVoxels, static_cast<double>(distance));
      reached.trianglesLeft += static_cast<double>(distance) > rule_.tolerance ? 1 : 0;
    }
  }

  const grid::Volume& volume_;
  RefineRule rule_;
  Mesh& mesh_;
  base::Job& job_;
  std::vector<std::uint8_t> stays_;     ///< of each vertex: it is off the surface
  std::vector<std::uint8_t> isNew_;     ///< of each triangle: not looked at yet
  std::vector<double> squaredLengths_;  ///< of each edge, world units
  std::vector<std::uint8_t> marked_;    ///< of each edge: to be split
  std::vector<VertexIndex> added_;      ///< of each edge: the vertex on it
  std::vector<Move> moves_;             ///< of the vertices of the last round
};

}  // namespace

Refinement refineTriangles(const grid::Volume& volume, const RefineRule& rule, Mesh& mesh,
                           base::Job& job) {
  return Refiner(volume, rule, mesh, job).run();
}

}  // namespace tufa::extraction
