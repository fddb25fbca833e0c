#include "shading/shaded_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/require_at_most.h"
#include "base/vec3.h"

namespace tufa::shading {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Finds the smooth groups of faces around each vertex. A corner is a place in the index list: 3 t
/// + k is corner k of triangle t.
class CreaseSplitter {
 public:
  CreaseSplitter(const Mesh& mesh, double creaseAngle, base::Job& job)
      : mesh_(mesh),
        triangles_(triangulate(mesh)),
        leastCosine_(creaseAngle < 180 ? std::cos(creaseAngle * kPi / 180) : -2),
        leastAgreement_(creaseAngle < 180 ? std::cos(creaseAngle / 2 * kPi / 180) : -2),
        leastJoinCosine_(creaseAngle < 90 ? std::cos(2 * creaseAngle * kPi / 180) : -2),
        job_(job) {}

  ShadedMesh split() {
    findFaceNormals();
    gatherCorners();
    ShadedMesh out;
    out.indices.resize(corners_.size());
    // first[v]: first vertex of v's groups, once the counts are summed.
    std::vector<VertexIndex> first(mesh_.positions.size() + 1);
    forVertices([&](std::size_t v, Star& star) {
      first[v + 1] = labelPieces(v, star);
      for (std::size_t i = 0; i < star.labels.size(); ++i) {
        out.indices[corners_[begin_[v] + i]] = star.labels[i];
      }
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    out.sources.resize(first.back());
    out.normals.resize(first.back());
    forVertices([&](std::size_t v, Star&) {
      for (std::size_t i = begin_[v]; i < begin_[v + 1]; ++i) out.indices[corners_[i]] += first[v];
      for (VertexIndex n = first[v]; n < first[v + 1]; ++n) {
        out.sources[n] = static_cast<VertexIndex>(v);
        const Normal ofFaces = normalOfPiece(v, n, out.indices);
        const bool whole = first[v + 1] - first[v] == 1 && !mesh_.normals.empty();
        out.normals[n] = whole && agrees(v, ofFaces) ? mesh_.normals[v] : ofFaces;
      }
    });
    return out;
  }

 private:
  /// Work space for the corners around one vertex.
  struct Star {
    /// The other end of an edge at the vertex, and the corner of a face beside it.
    struct Spoke {
      VertexIndex end;
      VertexIndex corner;  ///< counted around the vertex
      friend auto operator<=>(const Spoke&, const Spoke&) = default;
    };
    /// A smooth edge between two faces, by their corners.
    struct Join {
      double cosine;
      VertexIndex a, b;
    };
    std::vector<Spoke> spokes;
    std::vector<Join> joins;
    std::vector<Vec3> sums;  ///< of each group's areas
    std::vector<VertexIndex> labels;
  };

  template <class Body>
  void forVertices(Body&& body) {
    job_.forRanges(mesh_.positions.size(), [&](std::size_t begin, std::size_t end) {
      Star star;
      for (std::size_t v = begin; v < end; ++v) body(v, star);
    });
  }

  [[nodiscard]] Vec3 point(VertexIndex v) const {
    const Position& p = mesh_.positions[v];
    return {p.x, p.y, p.z};
  }

  void findFaceNormals() {
    normals_.resize(triangles_.size());
    job_.forRanges(triangles_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const auto& v = triangles_[t].vertices;
        const Vec3 a = point(v[0]);
        normals_[t] = (point(v[1]) - a).cross(point(v[2]) - a);
        if (!normals_[t].normalize(0)) normals_[t] = Vec3(0);
      }
    });
  }

  void gatherCorners() {
    base::requireAtMost(std::numeric_limits<VertexIndex>::max(),
                        3 * std::uint64_t{triangles_.size()}, "indices", "a mesh split at creases");
    begin_.assign(mesh_.positions.size() + 1, 0);
    for (const Triangle& t : triangles_) {
      for (const VertexIndex v : t.vertices) ++begin_[v + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    corners_.resize(begin_.back());
    std::vector<VertexIndex> next(begin_.begin(), begin_.end() - 1);
    VertexIndex corner = 0;
    for (const Triangle& t : triangles_) {
      for (const VertexIndex v : t.vertices) corners_[next[v]++] = corner++;
    }
  }

  static VertexIndex root(std::vector<VertexIndex>& parents, VertexIndex i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  }

  /// Whether the surface is smooth across an edge of two faces.
  [[nodiscard]] bool smooth(std::size_t t, std::size_t u) const {
    const Vec3& n = normals_[t];
    const Vec3& m = normals_[u];
    // A face without area has no direction that could differ.
    return n.dot(m) >= leastCosine_ || n == Vec3(0) || m == Vec3(0);
  }

  /// Whether the mesh's own normal of a vertex is near that of the faces around it. Less than a
  /// voxel beside a crease the gradient of the samples, from which it comes, is bent towards the
  /// other side.
  [[nodiscard]] bool agrees(std::size_t v, const Normal& ofFaces) const {
    const Vec3 faces(ofFaces);
    return faces == Vec3(0) || Vec3(mesh_.normals[v]).dot(faces) >= leastAgreement_;
  }

  /// Numbers the groups around a vertex from 0, in the order of their first corners; returns their
  /// number and leaves each corner's in star.labels.
  VertexIndex labelPieces(std::size_t v, Star& star) const {
    const auto degree = static_cast<VertexIndex>(begin_[v + 1] - begin_[v]);
    std::vector<VertexIndex>& labels = star.labels;
    labels.resize(degree);
    std::iota(labels.begin(), labels.end(), VertexIndex{0});
    star.spokes.clear();
    for (VertexIndex i = 0; i < degree; ++i) {
      const VertexIndex corner = corners_[begin_[v] + i];
      const auto& face = triangles_[corner / 3].vertices;
      star.spokes.push_back({face[(corner + 1) % 3], i});
      star.spokes.push_back({face[(corner + 2) % 3], i});
    }
    std::sort(star.spokes.begin(), star.spokes.end());
    star.joins.clear();
    for (std::size_t s = 0; s + 1 < star.spokes.size(); ++s) {
      const auto [end, i] = star.spokes[s];
      const auto [nextEnd, j] = star.spokes[s + 1];
      if (end != nextEnd || !smooth(faceAt(v, i), faceAt(v, j))) continue;
      star.joins.push_back({normals_[faceAt(v, i)].dot(normals_[faceAt(v, j)]), i, j});
    }
    join(v, star);
    return numberRoots(labels);
  }

  /// Joins groups across smooth edges, the flattest first, as long as they face the same way on the
  /// whole: over a few small faces that bevel a crease both of its sides are smoothly connected.
  void join(std::size_t v, Star& star) const {
    std::sort(star.joins.begin(), star.joins.end(), [](const Star::Join& x, const Star::Join& y) {
      return std::tuple(-x.cosine, x.a, x.b) < std::tuple(-y.cosine, y.a, y.b);
    });
    star.sums.clear();
    for (VertexIndex i = 0; i < star.labels.size(); ++i) star.sums.push_back(areaAt(v, i));
    for (const Star::Join& join : star.joins) {
      VertexIndex a = root(star.labels, join.a), b = root(star.labels, join.b);
      if (a == b) continue;
      const Vec3 &m = star.sums[a], &n = star.sums[b];
      if (m.dot(n) < leastJoinCosine_ * m.length() * n.length()) continue;
      if (a > b) std::swap(a, b);
      star.labels[b] = a;
      star.sums[a] += star.sums[b];
    }
  }

  /// Twice a face's area along its normal.
  [[nodiscard]] Vec3 areaAt(std::size_t v, VertexIndex i) const {
    const auto& face = triangles_[faceAt(v, i)].vertices;
    const Vec3 a = point(face[0]);
    return (point(face[1]) - a).cross(point(face[2]) - a);
  }

  /// Numbers the trees of a forest, given as parents that precede their children.
  static VertexIndex numberRoots(std::vector<VertexIndex>& parents) {
    VertexIndex count = 0;
    for (VertexIndex i = 0; i < parents.size(); ++i) {
      parents[i] = parents[i] == i ? count++ : parents[parents[i]];
    }
    return count;
  }

  [[nodiscard]] std::size_t faceAt(std::size_t v, VertexIndex i) const {
    return corners_[begin_[v] + i] / 3;
  }

  [[nodiscard]] Normal normalOfPiece(std::size_t v, VertexIndex piece,
                                     const std::vector<VertexIndex>& indices) const {
    Vec3 sum(0);
    for (std::size_t i = begin_[v]; i < begin_[v + 1]; ++i) {
      const VertexIndex corner = corners_[i];
      if (indices[corner] != piece) continue;
      const auto& face = triangles_[corner / 3].vertices;
      const Vec3 here = point(face[corner % 3]);
      const Vec3 a = point(face[(corner + 1) % 3]) - here;
      const Vec3 b = point(face[(corner + 2) % 3]) - here;
      sum += std::atan2(a.cross(b).length(), a.dot(b)) * normals_[corner / 3];
    }
    sum.normalize(0);
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
  }

  const Mesh& mesh_;
  std::vector<Triangle> triangles_;
  double leastCosine_, leastAgreement_, leastJoinCosine_;
  base::Job& job_;
  std::vector<Vec3> normals_;         ///< of faces; zero for those without area
  std::vector<VertexIndex> begin_;    ///< of each vertex's corners
  std::vector<VertexIndex> corners_;  ///< ascending at each vertex
};

}  // namespace

ShadedMesh splitAtCreases(const Mesh& mesh, double creaseAngle, base::Job& job) {
  return CreaseSplitter(mesh, creaseAngle, job).split();
}

ShadedMesh unsplit(const Mesh& mesh) {
  constexpr VertexIndex kUnused = std::numeric_limits<VertexIndex>::max();
  ShadedMesh out;
  std::vector<VertexIndex> places(mesh.positions.size(), kUnused);
  for (const Triangle& t : triangulate(mesh)) {
    for (const VertexIndex v : t.vertices) {
      if (places[v] == kUnused) {
        places[v] = static_cast<VertexIndex>(out.sources.size());
        out.sources.push_back(v);
        if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
      }
      out.indices.push_back(places[v]);
    }
  }
  return out;
}

void orderForGraphics(ShadedMesh& mesh, std::span<const std::size_t> parts) {
  const std::size_t count = mesh.sources.size();
  VertexIndex* part = mesh.indices.data();
  for (const std::size_t size : parts) {
    meshopt_optimizeVertexCache(part, part, size, count);
    part += size;
  }
  std::vector<VertexIndex> remap(count);
  meshopt_optimizeVertexFetchRemap(remap.data(), mesh.indices.data(), mesh.indices.size(), count);
  // Vertices that no triangle uses come last.
  auto next = static_cast<VertexIndex>(
      std::count_if(remap.begin(), remap.end(), [](VertexIndex n) { return n != ~0U; }));
  for (VertexIndex& place : remap) {
    if (place == ~0U) place = next++;
  }
  meshopt_remapIndexBuffer(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(),
                           remap.data());
  const ShadedMesh old = {mesh.sources, mesh.normals, {}};
  for (std::size_t n = 0; n < count; ++n) {
    mesh.sources[remap[n]] = old.sources[n];
    if (!old.normals.empty()) mesh.normals[remap[n]] = old.normals[n];
  }
}

}  // namespace tufa::shading
