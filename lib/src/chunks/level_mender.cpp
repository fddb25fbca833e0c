#include "chunks/level_mender.h"

#include <algorithm>
#include <utility>

#include "base/single_precision.h"
#include "certify/measured.h"
#include "chunks/mixed_pairs.h"
#include "mend/mend.h"

namespace tufa::chunks {
namespace {

// How often the two meshes of a level are mended in turn.
constexpr int kMostTurns = 3;

// Polygons of which each pair that meets has one: those of strips and of the pairs that another
// mesh with the same clusters has.
std::vector<mend::PolygonIndex> stripSuspectsOf(const SeamedCut& mesh,
                                                const std::vector<mend::PolygonPair>& shared) {
  const Mesh& own = mesh.made.mesh;
  const auto count = static_cast<mend::PolygonIndex>(own.quads.size() + own.triangles.size());
  const auto firstStrip = count - static_cast<mend::PolygonIndex>(mesh.strips.size());
  std::vector<mend::PolygonIndex> suspects;
  for (const auto& [a, b] : shared) {
    if (a < firstStrip && b < firstStrip) suspects.push_back(a);
  }
  std::sort(suspects.begin(), suspects.end());
  suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
  for (mend::PolygonIndex i = firstStrip; i < count; ++i) suspects.push_back(i);
  return suspects;
}

// Makes of one mesh, but for seams and strips, what another of the same cut is. Returns whether
// that changed anything.
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

bool LevelMender::isFixed(const SeamedCut& mesh, VertexIndex vertex, Movable movable) const {
  const cut::ClusterRef& ref = mesh.cut.clusters[vertex];
  if (ref.level != 0) return false;
  const ChunkCells& chunks = region_.chunks;
  return movable == Movable::Clusters || mesh.isOnSeam(vertex) ||
         !chunks.own.isInside(chunks.chunkOf(region_.cells[ref.cluster]));
}

std::vector<mend::PolygonPair> LevelMender::mend(
    SeamedCut& mesh, Movable movable, const std::vector<mend::PolygonIndex>& suspects) const {
  std::vector<Position>& positions = mesh.made.mesh.positions;
  for (VertexIndex i = 0; i < positions.size(); ++i) {
    Position& p = positions[i];
    p = mesh.isOnSeam(i) ? region_.seamPositions[mesh.seamAt(i)] : region_.affine.toWorld(p);
    if (region_.singlePrecision) p = base::toSingle(p);
  }
  mend::Source source;
  source.singlePrecision = region_.singlePrecision;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex vertex : vertices) points.push_back(positions[vertex]);
    return points;
  };
  source.isFixed = [&](VertexIndex vertex) { return isFixed(mesh, vertex, movable); };
  source.voxelSize = region_.affine.voxelSize();
  source.toTheFloor = false;
  mend::MendReport report = mend::mend(mesh.made.mesh, suspects, source, job_);
  for (Position& p : positions) p = region_.affine.fromWorld(p);
  return std::move(report.left);
}

void LevelMender::mendRegular(LevelMeshes& meshes, Movable movable) const {
  const SeamedCut& mesh = meshes.regular;
  meshes.pairs = mend(meshes.regular, movable,
                      certify::suspectsOf(mesh.made, mesh.cut, region_.baseSuspects, mesh.altered));
}

void LevelMender::mendInTurn(LevelMeshes& meshes, Movable movable) const {
  const auto stripSuspects = [&] { return stripSuspectsOf(meshes.transition, meshes.pairs); };
  for (int turn = 0; turn < kMostTurns; ++turn) {
    if (!takeShared(meshes.regular, meshes.transition) && turn > 0) break;
    meshes.transitionPairs = mend(meshes.transition, movable, stripSuspects());
    if (!takeShared(meshes.transition, meshes.regular)) return;
    mendRegular(meshes, movable);
  }
  if (takeShared(meshes.regular, meshes.transition)) {
    const mend::Surface surface(meshes.transition.made.mesh, job_);
    meshes.transitionPairs = mend::findPairs(surface, stripSuspects(), job_);
  }
}

void LevelMender::mend(LevelMeshes& meshes, bool alone, Movable movable) const {
  mendRegular(meshes, movable);
  if (alone) return;
  mendInTurn(meshes, movable);
  meshes.mixedPairs =
      findMixedPairs(meshes.regular, meshes.transition, region_.seams, region_.seamPositions,
                     region_.affine, region_.singlePrecision, job_);
}

}  // namespace tufa::chunks
