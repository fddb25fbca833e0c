#include "certify/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "certify/flat_triangle.h"

namespace tufa::certify {

using cut::Cut;
using openvdb::Vec3d;

namespace {

constexpr std::size_t kChunk = 2048;
// Samples along the longest side of a triangle: one a voxel, but not more than this. The distance of
// a patch from its triangle changes no faster than the patch bends.
constexpr int kMostSteps = 6;

// Most voxels to search around a sample beyond the nearest cells. What is farther is measured to the
// base quad that the polygon comes from.
constexpr double kLongestReach = 16;

// What a chunk of points or polygons found. Summed up in order, so that the mean is the same for any
// number of threads.
struct Part {
  double largest = 0;
  double sum = 0;
  std::size_t count = 0;
  std::vector<VertexIndex> coarse;
};

Vec3d vectorOf(const Position& p) { return {p.x, p.y, p.z}; }

template <class TreeT>
class Measure {
 public:
  Measure(const forest::Base<TreeT>& base, const BaseSurface<TreeT>& surface,
          const Candidate& candidate, const cut::CutRule& rule,
          base::Job& job)
      : base_(base), surface_(surface), cut_(candidate.cut), made_(candidate.made), mesh_(candidate.made.mesh),
        rule_(rule), job_(job) {}

  Deviation run() {
    collectTriangles();
    Deviation total;
    double sum = 0;
    std::size_t count = 0;
    const auto add = [&](const std::vector<Part>& parts) {
      for (const Part& part : parts) {
        total.largest = std::max(total.largest, part.largest);
        sum += part.sum;
        count += part.count;
        total.coarse.insert(total.coarse.end(), part.coarse.begin(), part.coarse.end());
      }
    };
    add(forChunks(base_.mesh.positions.size(), [&](std::size_t i, Part& part) { checkVertex(i, part); }));
    add(forChunks(base_.mesh.quads.size(), [&](std::size_t i, Part& part) { checkQuad(i, part); }));
    total.mean = count == 0 ? 0 : sum / static_cast<double>(count);
    add(forChunks(triangles_.size(), [&](std::size_t i, Part& part) { checkTriangle(i, part); }));
    std::sort(total.coarse.begin(), total.coarse.end());
    total.coarse.erase(std::unique(total.coarse.begin(), total.coarse.end()), total.coarse.end());
    return total;
  }

 private:
  // The three vertices of a triangle and, if it is half of a quad, the fourth, else the
  // first again.
  using Corners = std::array<VertexIndex, 4>;
  static int countOf(const Corners& corners) { return corners[3] == corners[0] ? 3 : 4; }

  [[nodiscard]] bool isFine(VertexIndex vertex) const { return cut_.clusters[vertex].level == 0; }

  // The triangles that are not the base mesh's own, and for each vertex those of the polygons around
  // it.
  void collectTriangles() {
    const auto take = [&](VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d,
                          std::uint32_t source) {
      polygons_.push_back({a, b, c, d});
      sources_.push_back(source);
      triangles_.emplace_back(vectorOf(mesh_.positions[a]), vectorOf(mesh_.positions[b]),
                              vectorOf(mesh_.positions[c]));
    };
    // A triangle from a base quad has lost a corner, so at least one of its own is of a larger cell.
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const auto& v = mesh_.triangles[i].vertices;
      take(v[0], v[1], v[2], v[0], made_.triangleSources[i]);
    }
    for (std::size_t i = 0; i < mesh_.quads.size(); ++i) {
      const auto& v = mesh_.quads[i].vertices;
      if (std::all_of(v.begin(), v.end(), [&](VertexIndex vertex) { return isFine(vertex); })) continue;
      take(v[0], v[1], v[2], v[3], made_.quadSources[i]);
      take(v[0], v[2], v[3], v[1], made_.quadSources[i]);
    }
    firstAround_.assign(mesh_.positions.size() + 1, 0);
    for (const Corners& corners : polygons_) {
      for (int i = 0; i < countOf(corners); ++i) ++firstAround_[corners[i] + 1];
    }
    for (std::size_t i = 1; i < firstAround_.size(); ++i) firstAround_[i] += firstAround_[i - 1];
    around_.resize(firstAround_.back());
    std::vector<std::uint32_t> next(firstAround_.begin(), firstAround_.end() - 1);
    for (std::uint32_t t = 0; t < polygons_.size(); ++t) {
      for (int i = 0; i < countOf(polygons_[t]); ++i) around_[next[polygons_[t][i]]++] = t;
    }
  }

  // The triangle around `vertex` that is nearest to the point, if nearer than `squared`.
  void findNearest(VertexIndex vertex, const Vec3d& point, double& squared,
                   std::uint32_t& nearest) const {
    for (std::uint32_t i = firstAround_[vertex]; i < firstAround_[vertex + 1]; ++i) {
      if (triangles_[around_[i]].closer(point, squared)) nearest = around_[i];
    }
  }

  void checkVertex(std::size_t index, Part& part) const {
    ++part.count;
    const VertexIndex vertex = cut_.vertexOf[index];
    if (isFine(vertex)) return;
    const Vec3d point = vectorOf(base_.mesh.positions[index]);
    double squared = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = 0;
    findNearest(vertex, point, squared, nearest);
    if (std::isinf(squared)) {
      part.coarse.push_back(vertex);
      return;
    }
    note(point, std::sqrt(squared), nearest, true, part);
  }

  void checkQuad(std::size_t index, Part& part) const {
    ++part.count;
    const auto& v = base_.mesh.quads[index].vertices;
    std::array<VertexIndex, 4> around{};
    for (int i = 0; i < 4; ++i) around[i] = cut_.vertexOf[v[i]];
    if (std::all_of(around.begin(), around.end(), [&](VertexIndex i) { return isFine(i); })) return;
    const Vec3d point = (vectorOf(base_.mesh.positions[v[0]]) + vectorOf(base_.mesh.positions[v[2]])) * 0.5;
    double squared = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = 0;
    for (int i = 0; i < 4; ++i) {
      if (std::find(around.begin(), around.begin() + i, around[i]) == around.begin() + i) {
        findNearest(around[i], point, squared, nearest);
      }
    }
    if (std::isinf(squared)) return;  // its vertices have no polygon either, and say so
    note(point, std::sqrt(squared), nearest, true, part);
  }

  void checkTriangle(std::size_t index, Part& part) const {
    const Corners& v = polygons_[index];
    const Vec3d a = vectorOf(mesh_.positions[v[0]]), b = vectorOf(mesh_.positions[v[1]]),
                c = vectorOf(mesh_.positions[v[2]]);
    Vec3d facing(0.0);
    for (const VertexIndex vertex : v) {
      const Normal& n = mesh_.normals[vertex];
      facing += Vec3d(n.x, n.y, n.z);
    }
    facing.normalize();
    const double voxel = base_.affine.voxelSize();
    const double longest =
        std::sqrt(std::max({(b - a).lengthSqr(), (c - b).lengthSqr(), (a - c).lengthSqr()})) / voxel;
    const int steps = std::clamp(static_cast<int>(std::ceil(longest)), 2, kMostSteps);
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const Vec3d point = a + (b - a) * (static_cast<double>(i) / steps) +
                            (c - a) * (static_cast<double>(j) / steps);
        const double bound = toleranceAt(point) * voxel;
        const int reach = 3 + static_cast<int>(std::min(kLongestReach, bound / voxel));
        const double distance = std::min(surface_.distance(point, facing, reach),
                                         surface_.distanceToQuad(point, sources_[index]));
        note(point, distance, static_cast<std::uint32_t>(index), false, part);
      }
    }
  }

  [[nodiscard]] double toleranceAt(const Vec3d& point) const {
    if (!rule_.scale) return rule_.tolerance;
    const openvdb::Coord& origin = base_.affine.origin();
    return rule_.toleranceAt(base_.affine.latticePoint({point[0], point[1], point[2]}, origin) +
                             origin.asVec3d());
  }

  // Takes a distance, in world units, into account; too large, the largest cells at `triangle` must be
  // split.
  void note(const Vec3d& point, double distance, std::uint32_t triangle, bool mean,
            Part& part) const {
    const double voxels = distance / base_.affine.voxelSize();
    part.largest = std::max(part.largest, voxels);
    if (mean) part.sum += voxels;
    if (voxels <= toleranceAt(point)) return;
    int level = 0;
    for (const VertexIndex vertex : polygons_[triangle]) {
      level = std::max(level, int{cut_.clusters[vertex].level});
    }
    for (const VertexIndex vertex : polygons_[triangle]) {
      if (level > 0 && cut_.clusters[vertex].level == level) part.coarse.push_back(vertex);
    }
  }

  template <class Body>
  std::vector<Part> forChunks(std::size_t count, const Body& body) {
    std::vector<Part> parts((count + kChunk - 1) / kChunk);
    job_.forRanges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t chunk = begin; chunk < end; ++chunk) {
        const std::size_t last = std::min((chunk + 1) * kChunk, count);
        for (std::size_t i = chunk * kChunk; i < last; ++i) body(i, parts[chunk]);
      }
    });
    return parts;
  }

  const forest::Base<TreeT>& base_;
  const BaseSurface<TreeT>& surface_;
  const Cut& cut_;
  const polygons::CutMesh& made_;
  const Mesh& mesh_;
  const cut::CutRule& rule_;
  base::Job& job_;
  std::vector<Corners> polygons_;  ///< of each triangle
  std::vector<std::uint32_t> sources_;  ///< the base quad of each triangle
  std::vector<FlatTriangle> triangles_;
  std::vector<std::uint32_t> firstAround_;
  std::vector<std::uint32_t> around_;
};

}  // namespace

template <class TreeT>
Deviation measureDeviation(const forest::Base<TreeT>& base, const BaseSurface<TreeT>& surface,
                           const Candidate& candidate,
                           const cut::CutRule& rule, base::Job& job) {
  return Measure<TreeT>(base, surface, candidate, rule, job).run();
}

template Deviation measureDeviation(const forest::Base<openvdb::FloatTree>&,
                                    const BaseSurface<openvdb::FloatTree>&, const Candidate&,
                                    const cut::CutRule&, base::Job&);
template Deviation measureDeviation(const forest::Base<openvdb::DoubleTree>&,
                                    const BaseSurface<openvdb::DoubleTree>&, const Candidate&,
                                    const cut::CutRule&, base::Job&);

}  // namespace tufa::certify
