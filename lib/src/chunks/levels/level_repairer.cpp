#include "chunks/levels/level_repairer.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/polygons.h"
#include "base/single_precision.h"
#include "chunks/levels/mixed_pairs.h"
#include "refine/measured.h"
#include "refine/repair/repair.h"

namespace tufa::chunks {
namespace {

// How often the two meshes of an LOD are repaired alternately.
constexpr int kMostFlips = 3;

// The candidates of a mesh whose clusters another mesh has been searched with: strips, and a
// polygon of each pair found there.
std::vector<intersect::PolygonIndex> stripCandidatesOf(
    const SeamedCut& mesh, const std::vector<intersect::PolygonPair>& shared) {
  const auto firstStrip = static_cast<intersect::PolygonIndex>(mesh.firstStripPolygon());
  const auto count = firstStrip + static_cast<intersect::PolygonIndex>(mesh.strips.size());
  std::vector<intersect::PolygonIndex> candidates;
  for (const auto& [a, b] : shared) {
    if (a < firstStrip && b < firstStrip) candidates.push_back(a);
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  for (intersect::PolygonIndex i = firstStrip; i < count; ++i) candidates.push_back(i);
  return candidates;
}

// A hash of 128 bits of a polygon's corners in their order. Two different polygons practically
// never have the same.
std::array<std::uint64_t, 2> digitsOf(const Mesh& mesh, intersect::Corners corners) {
  std::array<std::uint64_t, 2> digits{corners.size(), 0};
  for (const VertexIndex vertex : corners) {
    const Position& p = mesh.positions[vertex];
    for (const double x : {p.x, p.y, p.z}) {
      const auto bits = std::bit_cast<std::uint64_t>(x);
      digits[0] = (digits[0] ^ bits) * 0x9E3779B97F4A7C15U;
      digits[0] ^= digits[0] >> 32;
      digits[1] = (digits[1] + bits) * 0xC2B2AE3D27D4EB4FU;
      digits[1] ^= digits[1] >> 29;
    }
  }
  return digits;
}

// The polygons that are not among the clean ones.
std::vector<intersect::PolygonIndex> findNew(const Mesh& mesh, const LevelRepairer::Clean& clean) {
  std::vector<intersect::PolygonIndex> found;
  base::forPolygons(mesh, [&](intersect::PolygonIndex polygon, intersect::Corners corners) {
    if (!std::binary_search(clean.begin(), clean.end(), digitsOf(mesh, corners))) {
      found.push_back(polygon);
    }
  });
  return found;
}

LevelRepairer::Clean findClean(const Mesh& mesh, const std::vector<intersect::PolygonPair>& pairs) {
  std::vector<intersect::PolygonIndex> meeting = intersect::polygonsOf(pairs);
  std::sort(meeting.begin(), meeting.end());
  LevelRepairer::Clean clean;
  base::forPolygons(mesh, [&](intersect::PolygonIndex polygon, intersect::Corners corners) {
    if (!std::binary_search(meeting.begin(), meeting.end(), polygon)) {
      clean.push_back(digitsOf(mesh, corners));
    }
  });
  std::sort(clean.begin(), clean.end());
  return clean;
}

// Makes one mesh, except for seams and strips, what another of the same cut is. Whether that
// changed anything.
bool takeShared(const SeamedCut& from, SeamedCut& to) {
  const Mesh& mesh = from.made.mesh;
  Mesh& own = to.made.mesh;
  const auto end = mesh.positions.begin() + static_cast<std::ptrdiff_t>(from.clusterCount);
  if (std::equal(mesh.positions.begin(), end, own.positions.begin()) && mesh.quads == own.quads) {
    return false;
  }
  std::copy(mesh.positions.begin(), end, own.positions.begin());
  own.quads = mesh.quads;
  return true;
}

}  // namespace

bool LevelRepairer::isFixed(const SeamedCut& mesh, VertexIndex vertex, Movable movable) const {
  const octree::ClusterRef& ref = mesh.cut.clusters[vertex];
  if (ref.level != 0) return false;
  const ChunkCells& chunks = region_.chunks;
  return movable == Movable::Clusters || mesh.isOnSeam(vertex) ||
         !chunks.own.contains(chunks.chunkOf(region_.cells[ref.cluster]));
}

std::vector<intersect::PolygonPair> LevelRepairer::repairIntersections(
    SeamedCut& mesh, Movable movable, std::vector<intersect::PolygonIndex> candidates,
    Clean* clean) const {
  std::vector<Position>& positions = mesh.made.mesh.positions;
  for (VertexIndex i = 0; i < positions.size(); ++i) {
    Position& p = positions[i];
    p = mesh.isOnSeam(i) ? region_.seamPositions[mesh.seamAt(i)] : region_.affine.toWorld(p);
    if (region_.singlePrecision) p = base::toSingle(p);
  }
  // Polygons of the uniform mesh too: they may intersect what has changed.
  if (clean != nullptr && !clean->empty()) candidates = findNew(mesh.made.mesh, *clean);
  refine::Source source;
  source.singlePrecision = region_.singlePrecision;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex vertex : vertices) points.push_back(positions[vertex]);
    return points;
  };
  source.isFixed = [&](VertexIndex vertex) { return isFixed(mesh, vertex, movable); };
  source.voxelSize = region_.affine.voxelSize();
  source.lastResort = false;
  refine::RepairReport report =
      refine::repairIntersections(mesh.made.mesh, candidates, source, job_);
  if (clean != nullptr) *clean = findClean(mesh.made.mesh, report.left);
  for (Position& p : positions) p = region_.affine.fromWorld(p);
  return std::move(report.left);
}

void LevelRepairer::repairRegular(LevelMeshes& meshes, Movable movable, Clean& clean) const {
  const SeamedCut& mesh = meshes.regular;
  meshes.pairs = repairIntersections(
      meshes.regular, movable,
      refine::candidatesOf(mesh.made, mesh.cut, region_.uniformCandidates, mesh.altered), &clean);
}

// The two meshes must end with the same interior. So what the repair of one moves is taken over by
// the other, which is then searched again: all of its strips, and pairs that the first one kept. If
// they do not agree after kMostFlips repairs each, the regular mesh decides, and the pairs of the
// transition mesh are only counted.
void LevelRepairer::repairInSequence(LevelMeshes& meshes, Movable movable, Clean& clean) const {
  const auto stripCandidates = [&] { return stripCandidatesOf(meshes.transition, meshes.pairs); };
  for (int turn = 0; turn < kMostFlips; ++turn) {
    if (!takeShared(meshes.regular, meshes.transition) && turn > 0) break;
    meshes.transitionPairs =
        repairIntersections(meshes.transition, movable, stripCandidates(), nullptr);
    if (!takeShared(meshes.transition, meshes.regular)) return;
    repairRegular(meshes, movable, clean);
  }
  if (takeShared(meshes.regular, meshes.transition)) {
    const intersect::Surface surface(meshes.transition.made.mesh, job_);
    meshes.transitionPairs = intersect::findPairs(surface, stripCandidates(), job_);
  }
}

void LevelRepairer::repairIntersections(LevelMeshes& meshes, bool alone, Movable movable,
                                        Clean& clean) const {
  repairRegular(meshes, movable, clean);
  if (alone) return;
  repairInSequence(meshes, movable, clean);
  meshes.mixedPairs =
      findMixedPairs(meshes.regular, meshes.transition, region_.seams, region_.seamPositions,
                     region_.affine, region_.singlePrecision, job_);
}

}  // namespace tufa::chunks
