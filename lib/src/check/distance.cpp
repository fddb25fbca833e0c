#include <tufa/check.h>
#include <chrono>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "check/surface_reference.h"
#include "grid/isovalue.h"
#include "grid/voxel_frame.h"

namespace tufa {
namespace {

// Share of the time.
constexpr double kSurfaceEnd = 0.2;

DistanceReport measure(const Mesh& mesh, const openvdb::GridBase& grid,
                       const DistanceOptions& options, base::Job& job) {
  const grid::VoxelFrame frame(grid);
  const grid::IsoChoice iso = grid::chooseIsovalue(grid, options.isovalue, Inside::Auto);
  DistanceReport report;
  report.isovalue = iso.isovalue;
  report.voxelSize = frame.voxelSize();

  const checks::SurfaceReference surface(grid, frame, iso, kSurfaceEnd, job);
  const auto ignore = [](std::size_t, double) {};
  surface.measure(mesh, options.samplesPerEdge, kSurfaceEnd, job, ignore, report);
  return report;
}

}  // namespace

DistanceReport checkAgainst(const Mesh& mesh, const openvdb::GridBase& grid,
                            const DistanceOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  checks::requireSamples(options.samplesPerEdge);
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
    job.forRanges(points.size(), checks::kSampleGrain, [&](std::size_t begin, std::size_t end) {
      std::uint32_t hint = base::Bvh::kNone;
      for (std::size_t i = begin; i < end; ++i) {
        distances[i] = soup.distance(frame.fromWorld(points[i]), hint);
      }
    });
  });
  job.finish();
  return distances;
}

}  // namespace tufa
