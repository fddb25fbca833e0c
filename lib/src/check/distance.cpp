#include <tufa/check.h>
#include <tufa/error.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/job.h"
#include "check/sum_ranges.h"
#include "check/surface_distance.h"
#include "check/triangle_soup.h"
#include "grid/isosurface.h"
#include "grid/isovalue.h"
#include "grid/voxel_frame.h"

namespace tufa {
namespace {

using base::Bvh;

constexpr std::size_t kGrain = 1024;

/// Running totals over samples.
struct Tally {
  std::size_t samples = 0;
  double largest = 0;
  double sum = 0;
  double squares = 0;

  void add(double distance) {
    ++samples;
    largest = std::max(largest, distance);
    sum += distance;
    squares += distance * distance;
  }
  Tally& operator+=(const Tally& other) {
    samples += other.samples;
    largest = std::max(largest, other.largest);
    sum += other.sum;
    squares += other.squares;
    return *this;
  }
  [[nodiscard]] DistanceSummary summary() const {
    if (samples == 0) return {};
    const auto count = static_cast<double>(samples);
    return {samples, largest, sum / count, std::sqrt(squares / count)};
  }
};

/// The triangle's centre, and a lattice of `perEdge` points along an edge, without the corners.
template <class Measure>
void sampleTriangle(const checks::TriangleSoup& soup, const Triangle& triangle, int perEdge,
                    const Measure& measure) {
  const Vec3& a = soup.point(triangle.vertices[0]);
  const Vec3& b = soup.point(triangle.vertices[1]);
  const Vec3& c = soup.point(triangle.vertices[2]);
  measure((a + b + c) / 3);
  const int steps = perEdge - 1;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      if (i == steps || j == steps || i + j == 0) continue;
      measure(a + (b - a) * (1.0 * i / steps) + (c - a) * (1.0 * j / steps));
    }
  }
}

/// Vertices are sampled once each, by themselves.
std::vector<VertexIndex> usedVertices(const checks::TriangleSoup& soup, std::size_t count) {
  std::vector<bool> isUsed(count);
  for (const Triangle& triangle : soup.triangles()) {
    for (const VertexIndex v : triangle.vertices) isUsed[v] = true;
  }
  std::vector<VertexIndex> used;
  for (std::size_t v = 0; v < count; ++v) {
    if (isUsed[v]) used.push_back(static_cast<VertexIndex>(v));
  }
  return used;
}

Tally measureToMesh(const checks::TriangleSoup& soup, const std::vector<Vec3>& points,
                    base::Job& job) {
  return checks::sumRanges<Tally>(job, points.size(), kGrain,
                                  [&](std::size_t begin, std::size_t end) {
                                    Tally part;
                                    std::uint32_t hint = Bvh::kNone;
                                    for (std::size_t i = begin; i < end; ++i)
                                      part.add(soup.distance(points[i], hint));
                                    return part;
                                  });
}

DistanceReport measure(const Mesh& mesh, const openvdb::GridBase& grid,
                       const DistanceOptions& options, base::Job& job) {
  const grid::VoxelFrame frame(grid);
  const grid::IsoChoice iso = grid::chooseIsovalue(grid, options.isovalue, Inside::Auto);
  DistanceReport report;
  report.isovalue = iso.isovalue;
  report.voxelSize = frame.voxelSize();

  job.beginStage("isosurface samples", 0.1);
  const auto surface = grid::isosurfaceOf(grid, frame, iso);
  std::vector<Vec3> points = surface->samples(job);
  job.beginStage("mesh tree", 0.2);
  const checks::TriangleSoup soup(mesh, frame, job);
  job.beginStage("surface to mesh", 0.45);
  report.surfaceToMesh = measureToMesh(soup, points, job).summary();

  job.beginStage("sample tree", 0.5);
  std::vector<base::Box> boxes(points.size());
  std::transform(points.begin(), points.end(), boxes.begin(), [](const Vec3& p) {
    return base::Box{p, p};
  });
  Bvh tree(std::move(boxes), job);
  const checks::PointCloud cloud{std::move(points), std::move(tree)};

  using Distance = checks::SurfaceDistance;
  const auto newDistance = [&] { return Distance(surface->field(), cloud); };
  job.beginStage("vertices to surface", 0.6);
  const std::vector<VertexIndex> vertices = usedVertices(soup, mesh.positions.size());
  Tally tally = checks::sumRanges<Tally>(job, vertices.size(), kGrain,
                                         [&](std::size_t begin, std::size_t end) {
                                           Tally part;
                                           Distance distance = newDistance();
                                           for (std::size_t i = begin; i < end; ++i)
                                             part.add(distance(soup.point(vertices[i])));
                                           return part;
                                         });
  job.beginStage("triangles to surface", 1);
  tally += checks::sumRanges<Tally>(
      job, soup.triangles().size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Tally part;
        Distance distance = newDistance();
        for (std::size_t t = begin; t < end; ++t) {
          sampleTriangle(soup, soup.triangles()[t], options.samplesPerEdge,
                         [&](const Vec3& point) { part.add(distance(point)); });
        }
        return part;
      });
  report.meshToSurface = tally.summary();
  return report;
}

}  // namespace

DistanceReport checkAgainst(const Mesh& mesh, const openvdb::GridBase& grid,
                            const DistanceOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  if (options.samplesPerEdge < 2) {
    throw Error(
        ErrorCode::InvalidArgument,
        "samplesPerEdge is " + std::to_string(options.samplesPerEdge) + "; it must be 2 or more");
  }
  base::Job job(options.threads, options.progress);
  DistanceReport report;
  job.run([&] { report = measure(mesh, grid, options, job); });
  job.finish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

std::vector<double> distancesTo(const Mesh& mesh, const std::vector<Position>& points,
                                const DistanceOptions& options) {
  // A default frame: voxels are world units.
  const grid::VoxelFrame frame;
  base::Job job(options.threads, options.progress);
  std::vector<double> distances(points.size());
  job.run([&] {
    job.beginStage("mesh tree", 0.2);
    const checks::TriangleSoup soup(mesh, frame, job);
    job.beginStage("distances", 1);
    job.forRanges(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::uint32_t hint = Bvh::kNone;
      for (std::size_t i = begin; i < end; ++i) {
        distances[i] = soup.distance(frame.fromWorld(points[i]), hint);
      }
    });
  });
  job.finish();
  return distances;
}

}  // namespace tufa
