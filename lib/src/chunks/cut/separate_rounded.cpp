#include "chunks/cut/separate_rounded.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/single_precision.h"
#include "refine/repair/repair.h"

namespace tufa::chunks {
namespace {

using Place = std::array<double, 3>;

double nextAbove(double x, bool singlePrecision) {
  if (!singlePrecision) return std::nextafter(x, std::numeric_limits<double>::infinity());
  return double{std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity())};
}

}  // namespace

void keepApart(CutMesh& cut, const grid::Affine& affine, bool singlePrecision, base::Job& job) {
  std::vector<Position>& positions = cut.mesh.positions;
  const auto placeOf = [&](const Position& position) {
    const Position world = affine.toWorld(position);
    const Position p = singlePrecision ? base::toSingle(world) : world;
    return Place{p.x, p.y, p.z};
  };
  std::vector<std::uint8_t> isUsed(positions.size(), 0);  // collapses have left others
  for (std::size_t t = 0; t < cut.mesh.triangles.size(); ++t) {
    job.pollCancelled(t);
    for (const VertexIndex v : cut.mesh.triangles[t].vertices) isUsed[v] = 1;
  }
  std::vector<VertexIndex> used;
  for (VertexIndex v = 0; v < positions.size(); ++v) {
    job.pollCancelled(v);
    if (isUsed[v] != 0) used.push_back(v);
  }
  using Entry = std::pair<Place, VertexIndex>;
  std::vector<Entry> sorted(used.size());
  job.forRanges(used.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sorted[i] = {placeOf(positions[used[i]]), used[i]};
  });
  base::parallelSort(sorted.begin(), sorted.end(), std::less<>());
  std::set<Place> added;
  const auto isTaken = [&](const Place& place) {
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), Entry{place, 0});
    return (found != sorted.end() && found->first == place) || added.contains(place);
  };
  double moved = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    job.pollCancelled(i - 1);
    const Place& shared = sorted[i].first;
    if (shared != sorted[i - 1].first) continue;
    Position& position = positions[sorted[i].second];
    const Position before = position;
    const auto moveBy = [&](double distance) {
      position = affine.fromWorld({shared[0] + distance, shared[1], shared[2]});
    };
    // Numbers near 0 lie far closer together than the places that vertices can have.
    double step = nextAbove(shared[0], singlePrecision) - shared[0];
    for (moveBy(step); placeOf(position) == shared; moveBy(step)) step *= 2;
    for (int n = 2; isTaken(placeOf(position)); ++n) moveBy(n * step);
    added.insert(placeOf(position));
    moved = std::max(moved, (Vec3(position) - Vec3(before)).length());
  }
  cut.moved += moved / affine.voxelSize();
}

void separateRounded(CutMesh& cut, const grid::Affine& affine, bool singlePrecision,
                     base::Job& job) {
  if (cut.isSeparated) return;
  std::vector<Position>& positions = cut.mesh.positions;
  Mesh rounded;
  rounded.positions.resize(positions.size());
  rounded.triangles = cut.mesh.triangles;
  job.forRanges(positions.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Position world = affine.toWorld(positions[v]);
      rounded.positions[v] = singlePrecision ? base::toSingle(world) : world;
    }
  });
  const std::vector<Position> before = rounded.positions;
  refine::Source source;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex v : vertices) points.push_back(before[v]);
    return points;
  };
  source.isFixed = [&](VertexIndex v) { return cut.planesAt(v)[0] != ChunkPlane::kNone; };
  source.voxelSize = affine.voxelSize();
  source.singlePrecision = singlePrecision;
  source.lastResort = false;
  std::vector<intersect::PolygonIndex> candidates;
  for (std::uint32_t t = 0; t < rounded.triangles.size(); ++t) {
    job.pollCancelled(t);
    const auto& v = rounded.triangles[t].vertices;
    if ((cut.isNew[v[0]] | cut.isNew[v[1]] | cut.isNew[v[2]]) != 0) candidates.push_back(t);
  }
  if (refine::repairIntersections(rounded, candidates, source, job).movedVertices == 0) return;
  cut.reference = positions;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    job.pollCancelled(v);
    if (!(rounded.positions[v] == before[v])) positions[v] = affine.fromWorld(rounded.positions[v]);
  }
}

}  // namespace tufa::chunks
