#include "chunks/cut/separate_rounded.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/ranked_bits.h"
#include "base/single_precision.h"
#include "refine/repair/repair.h"

namespace tufa::chunks {
namespace {

using Place = std::array<double, 3>;

double nextAbove(double x, bool singlePrecision) {
  if (!singlePrecision) return std::nextafter(x, std::numeric_limits<double>::infinity());
  return double{std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity())};
}

// A hash of a place, below a power of two.
std::size_t hashOf(const Place& place, std::size_t size) {
  std::uint64_t hash = 0;
  for (const double x : place) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15U;  // -0 as 0
    hash ^= hash >> 29;
  }
  return static_cast<std::size_t>(hash) & (size - 1);
}

}  // namespace

// Vertices whose places may be those of others, as their hashes are the same, are few; they alone
// are sorted. Free places whose hash is that of one that is taken, one in eight at most, are passed
// by.
void keepApart(CutMesh& cut, const grid::Affine& affine, bool singlePrecision, base::Job& job) {
  std::vector<Position>& positions = cut.mesh.positions;
  const auto placeOf = [&](const Position& position) {
    const Position world = affine.toWorld(position);
    const Position p = singlePrecision ? base::toSingle(world) : world;
    return Place{p.x, p.y, p.z};
  };
  base::RankedBits used(positions.size());  // collapses have left others
  for (std::size_t t = 0; t < cut.mesh.triangles.size(); ++t) {
    job.pollCancelled(t);
    for (const VertexIndex v : cut.mesh.triangles[t].vertices) used.add(v);
  }
  const std::size_t size = std::bit_ceil(8 * positions.size() + 1);
  std::vector<std::size_t> hashes(positions.size());
  job.forRanges(positions.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) hashes[v] = hashOf(placeOf(positions[v]), size);
  });
  base::RankedBits taken(size), shared(size);
  used.forAll([&](std::size_t v) {
    job.pollCancelled(v);
    (taken.has(hashes[v]) ? shared : taken).add(hashes[v]);
  });
  std::vector<std::pair<Place, VertexIndex>> sorted;
  used.forAll([&](std::size_t v) {
    job.pollCancelled(v);
    if (!shared.has(hashes[v])) return;
    sorted.emplace_back(placeOf(positions[v]), static_cast<VertexIndex>(v));
  });
  std::sort(sorted.begin(), sorted.end());
  double moved = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const Place& place = sorted[i].first;
    if (place != sorted[i - 1].first) continue;
    Position& position = positions[sorted[i].second];
    const Position before = position;
    const auto moveBy = [&](double distance) {
      position = affine.fromWorld({place[0] + distance, place[1], place[2]});
    };
    // Numbers near 0 lie far closer together than the places that vertices can have.
    double step = nextAbove(place[0], singlePrecision) - place[0];
    for (moveBy(step); placeOf(position) == place; moveBy(step)) step *= 2;
    const auto hash = [&] { return hashOf(placeOf(position), size); };
    for (int n = 2; taken.has(hash()); ++n) moveBy(n * step);
    taken.add(hash());
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
