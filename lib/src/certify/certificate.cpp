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

// Cells to search around a sample, at first and, where nothing was found, at last.
constexpr double kLongestReach = 32;
constexpr int kLastReach = 64;

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
          const Candidate& candidate, const std::function<double(const Vec3d&)>& tolerance,
          base::Job& job)
      : base_(base), surface_(surface), cut_(candidate.cut), mesh_(candidate.mesh),
        tolerance_(tolerance), job_(job) {}

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
  [[nodiscard]] bool isFine(VertexIndex vertex) const { return cut_.clusters[vertex].level == 0; }

  // The triangles that are not the base mesh's own, and for each vertex those around it.
  void collectTriangles() {
    const auto take = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
      vertices_.push_back({a, b, c});
      triangles_.emplace_back(vectorOf(mesh_.positions[a]), vectorOf(mesh_.positions[b]),
                              vectorOf(mesh_.positions[c]));
    };
    // A triangle from a base quad has lost a corner, so at least one of its own is of a larger cell.
    for (const Triangle& triangle : mesh_.triangles) {
      take(triangle.vertices[0], triangle.vertices[1], triangle.vertices[2]);
    }
    for (const Quad& quad : mesh_.quads) {
      const auto& v = quad.vertices;
      if (std::all_of(v.begin(), v.end(), [&](VertexIndex i) { return isFine(i); })) continue;
      take(v[0], v[1], v[2]);
      take(v[0], v[2], v[3]);
    }
    firstAround_.assign(mesh_.positions.size() + 1, 0);
    for (const auto& triangle : vertices_) {
      for (const VertexIndex vertex : triangle) ++firstAround_[vertex + 1];
    }
    for (std::size_t i = 1; i < firstAround_.size(); ++i) firstAround_[i] += firstAround_[i - 1];
    around_.resize(3 * vertices_.size());
    std::vector<std::uint32_t> next(firstAround_.begin(), firstAround_.end() - 1);
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
      for (const VertexIndex vertex : vertices_[i]) around_[next[vertex]++] = i;
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
    const auto& v = vertices_[index];
    const Vec3d a = vectorOf(mesh_.positions[v[0]]), b = vectorOf(mesh_.positions[v[1]]),
                c = vectorOf(mesh_.positions[v[2]]);
    const double voxel = base_.affine.voxelSize();
    const double longest =
        std::sqrt(std::max({(b - a).lengthSqr(), (c - b).lengthSqr(), (a - c).lengthSqr()})) / voxel;
    const int steps = std::clamp(static_cast<int>(std::ceil(longest)), 2, kMostSteps);
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const Vec3d point = a + (b - a) * (static_cast<double>(i) / steps) +
                            (c - a) * (static_cast<double>(j) / steps);
        const double bound = tolerance_(latticePoint(point)) * voxel;
        const int reach = 3 + static_cast<int>(std::min(kLongestReach, bound / voxel));
        double distance = surface_.distance(point, triangles_[index].normal(), reach);
        if (std::isinf(distance)) {
          distance = surface_.distance(point, triangles_[index].normal(), kLastReach);
        }
        note(point, distance, static_cast<std::uint32_t>(index), false, part);
      }
    }
  }

  [[nodiscard]] Vec3d latticePoint(const Vec3d& point) const {
    const openvdb::Coord& origin = base_.affine.origin();
    return base_.affine.latticePoint({point[0], point[1], point[2]}, origin) +
           origin.asVec3d();
  }

  // Takes a distance, in world units, into account; too large, the largest cells at `triangle` must be
  // split.
  void note(const Vec3d& point, double distance, std::uint32_t triangle, bool mean,
            Part& part) const {
    const double voxels = distance / base_.affine.voxelSize();
    part.largest = std::max(part.largest, voxels);
    if (mean) part.sum += voxels;
    if (voxels <= tolerance_(latticePoint(point))) return;
    int level = 0;
    for (const VertexIndex vertex : vertices_[triangle]) {
      level = std::max(level, int{cut_.clusters[vertex].level});
    }
    for (const VertexIndex vertex : vertices_[triangle]) {
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
  const Mesh& mesh_;
  const std::function<double(const Vec3d&)>& tolerance_;
  base::Job& job_;
  std::vector<std::array<VertexIndex, 3>> vertices_;
  std::vector<FlatTriangle> triangles_;
  std::vector<std::uint32_t> firstAround_;
  std::vector<std::uint32_t> around_;
};

}  // namespace

template <class TreeT>
Deviation measureDeviation(const forest::Base<TreeT>& base, const BaseSurface<TreeT>& surface,
                           const Candidate& candidate,
                           const std::function<double(const Vec3d&)>& tolerance, base::Job& job) {
  return Measure<TreeT>(base, surface, candidate, tolerance, job).run();
}

template Deviation measureDeviation(const forest::Base<openvdb::FloatTree>&,
                                    const BaseSurface<openvdb::FloatTree>&, const Candidate&,
                                    const std::function<double(const Vec3d&)>&, base::Job&);
template Deviation measureDeviation(const forest::Base<openvdb::DoubleTree>&,
                                    const BaseSurface<openvdb::DoubleTree>&, const Candidate&,
                                    const std::function<double(const Vec3d&)>&, base::Job&);

}  // namespace tufa::certify
