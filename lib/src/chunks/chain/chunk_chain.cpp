#include "chunks/chain/chunk_chain.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/box.h"
#include "base/huge_pages.h"
#include "base/interpolated_normal.h"
#include "base/single_precision.h"
#include "intersect/surface.h"
#include "refine/surface_reduction.h"
#include "refine/tolerance_scales.h"

namespace tufa::chunks {
namespace {

using base::Vec3f;

// Voxels that vertices inside a chunk keep from its faces, unless they were nearer before.
constexpr double kDepth = 2e-3;
// Where the cut has moved the surface by less than this share of a tolerance at most, all of the
// surface is reduced by that less: scales would save few triangles, and no proxy can stand in for a
// reference with scales.
constexpr double kLittleMoved = 0.012;

}  // namespace

ChunkChain::ChunkChain(CutMesh cut, const grid::Affine& affine, const octree::CutRule& rule,
                       int chunkSize, bool singlePrecision, base::Job& job)
    : cut_(std::move(cut)),
      faces_(std::move(cut_.mesh.triangles)),
      normals_(std::exchange(cut_.mesh.normals, {}), job),
      affine_(affine),
      chunkSize_(chunkSize),
      singlePrecision_(singlePrecision),
      job_(job),
      frame_(cut_.mesh.positions, affine.voxelSize(), job,
             cut_.errors.empty() ? base::TriangleView() : faces_),
      curveVertices_(static_cast<VertexIndex>(cut_.mesh.positions.size())),
      isScaled_(static_cast<bool>(rule.scale)),
      tolerance_(rule.tolerance) {
  for (const MovedVertex& moved : cut_.movedAt) mostMoved_ = std::max(mostMoved_, moved.by);
  const auto localsOf = [&](const std::vector<Position>& from) {
    std::vector<Vec3f> local;
    base::resizeLarge(local, from.size(), job);
    job.forRanges(local.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) local[i] = frame_.toLocal(from[i]);
    });
    return local;
  };
  const reduce::InputMesh input{localsOf(cut_.mesh.positions), faces_};
  const reduce::InputMesh reference{localsOf(cut_.reference), input.triangles};
  std::vector<reduce::Index> same(cut_.reference.size());
  std::iota(same.begin(), same.end(), 0);
  reduce::Options options = reduce::optionsForAngle(rule.minAngle);
  options.faults = [this](const reduce::ReducedMesh& m) { return findIntersecting(m); };
  reduction_.emplace(input, same.empty() ? input : reference, same, scalesOf(rule),
                     std::move(options), job);
  reduction_->setRegions([this] { return regionsOf(); });
  kinds_ = reduction_->surface().lineKind;
}

reduce::Regions ChunkChain::regionsOf() const {
  reduce::Regions regions;
  regions.ofTriangle = cut_.chunkOf;
  regions.planesOf = [this](reduce::Index v) { return cut_.planesAt(v); };
  for (const ChunkPlane& plane : cut_.planes) {
    float gradient[3] = {};
    gradient[plane.axis] = 1;
    regions.normals.emplace_back(Vec3(affine_.normal(gradient[0], gradient[1], gradient[2])));
  }
  regions.mayHold = [this](reduce::Index region, reduce::Index plane, Vec3f place, Vec3f a,
                           Vec3f b) {
    const Coord& chunk = cut_.chunks[region];
    const auto latticeOf = [&](Vec3f p) {
      return affine_.latticePoint(frame_.toExact(p), Coord(0));
    };
    const Vec3 at = latticeOf(place);
    bool isDeep = true;
    double depth[6];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = double(chunk[axis]) * chunkSize_;
      depth[2 * axis] = at[axis] - low;
      depth[2 * axis + 1] = low + chunkSize_ - at[axis];
      isDeep &= depth[2 * axis] >= kDepth && depth[2 * axis + 1] >= kDepth;
    }
    if (isDeep) return true;
    const Vec3 from = latticeOf(a), to = latticeOf(b);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = double(chunk[axis]) * chunkSize_, high = low + chunkSize_;
      const double before[2] = {std::min(from[axis], to[axis]) - low,
                                high - std::max(from[axis], to[axis])};
      for (std::size_t side = 0; side < 2; ++side) {
        if (plane != reduce::kNone && cut_.planes[plane].axis == static_cast<int>(axis)) continue;
        if (depth[2 * axis + side] < std::min(kDepth, before[side])) return false;
      }
    }
    return true;
  };
  return regions;
}

// What is left of a tolerance where the cut has moved the surface least.
double ChunkChain::leftOf(double tolerance) const {
  return tolerance - cut_.moved - (hasScales(tolerance) ? 0 : mostMoved_);
}

// Whether less of a tolerance is allowed where the cut has moved the surface than elsewhere.
bool ChunkChain::hasScales(double tolerance) const {
  return isScaled_ || mostMoved_ > kLittleMoved * tolerance;
}

// What guards multiply a tolerance with, or none: where the surface was moved, what leaves room for
// that.
std::vector<float> ChunkChain::scalesOf(const octree::CutRule& rule) const {
  std::vector<float> scales;
  if (rule.scale) scales = refine::scalesOf(cut_.mesh, affine_, rule, job_);
  if (cut_.movedAt.empty() || !hasScales(rule.tolerance)) return scales;
  if (scales.empty()) base::resizeLarge(scales, cut_.mesh.positions.size(), job_, 1.0f);
  const double left = leftOf(rule.tolerance);
  for (const auto& [v, by] : cut_.movedAt) {
    constexpr double kRounding = 1e-6;
    const double scale = static_cast<double>(scales[v]) - by / left - kRounding;
    scales[v] = left > 0 ? static_cast<float>(std::max(0.0, scale)) : 0;
  }
  return scales;
}

void ChunkChain::reduce(double tolerance, reduce::LineMode lines) {
  isSearched_ = false;
  if (tolerance != tolerance_ && hasScales(tolerance_) && !isScaled_) {
    octree::CutRule rule;
    rule.tolerance = tolerance;
    reduction_->setScales(scalesOf(rule));
  }
  tolerance_ = tolerance;
  reduction_->toTolerance(static_cast<float>(frame_.within(std::max(0.0, leftOf(tolerance)))),
                          lines);
}

// The triangles that intersect once positions are rounded as they are written. Guards in single
// precision may take a star of slivers along a crease for simple, and bands have another frame.
std::vector<reduce::Index> ChunkChain::findIntersecting(const reduce::ReducedMesh& reduced) {
  Mesh mesh;
  mesh.positions.resize(reduced.positions.size());
  job_.forRanges(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<VertexIndex>(begin); v < end; ++v) {
      mesh.positions[v] = written(place(reduced, v).at);
    }
  });
  mesh.triangles = reduced.triangles;
  std::vector<intersect::PolygonIndex> found = intersect::findIntersecting(mesh, job_);
  isSearched_ = found.empty();
  return found;
}

Position ChunkChain::written(const Position& p) const {
  const Position world = affine_.toWorld(p);
  return singlePrecision_ ? base::toSingle(world) : world;
}

ChainLevel ChunkChain::next(double tolerance, ChainLevel* before) {
  if (before == nullptr && !cut_.errors.empty()) {
    ChainLevel level = extract(before);
    level.errors = cut_.errors;
    return level;
  }
  if (before != nullptr) {
    reduce(tolerance, reduce::LineMode::Alone);
    setInto(*before);
    before->isChangedSearched = isSearched_;
    before->transitionErrors = errorsOf(reduction_->certificate());
  }
  reduce(tolerance, before == nullptr ? reduce::LineMode::Free : reduce::LineMode::Held);
  ChainLevel level = extract(before);
  level.isSearched = isSearched_;
  level.errors = errorsOf(reduction_->certificate());
  return level;
}

void ChunkChain::replace(std::vector<ReducedBand> bands, const std::vector<std::uint8_t>& isHeld) {
  std::vector<reduce::ReplacedPart> parts;
  for (ReducedBand& band : bands) {
    if (band.surface.isWhole) continue;
    std::vector<Vec3f> positions;
    for (const Placed& placed : band.placed) {
      const Vec3f local = frame_.toLocal(placed.at);
      positions.push_back(local);
      placed_.emplace(std::array{local.x, local.y, local.z}, placed);
    }
    parts.push_back({std::move(band.surface), std::move(positions), std::move(band.vertices),
                     std::move(band.triangles)});
  }
  reduction_->replaceParts(parts, isHeld);
}

ReducedBand ChunkChain::reduceBand(double tolerance) {
  reduce(tolerance, reduce::LineMode::Free);
  const reduce::ReducedMesh reduced = reduction_->mesh();
  ReducedBand band;
  for (VertexIndex v = 0; v < reduced.positions.size(); ++v) {
    job_.pollCancelled(v);
    band.placed.push_back(place(reduced, v));
  }
  band.surface = reduction_->takeSurface();
  return band;
}

CutMesh ChunkChain::reduceAlone(double tolerance) {
  reduce(tolerance, reduce::LineMode::Free);
  reduce::ReducedMesh reduced = reduction_->mesh();
  CutMesh cut;
  for (VertexIndex v = 0; v < reduced.positions.size(); ++v) {
    job_.pollCancelled(v);
    const auto [at, normal] = place(reduced, v);
    cut.mesh.positions.push_back(at);
    cut.mesh.normals.push_back(normal);
    const reduce::Index source = reduced.sources[v];
    if (source == reduce::kNone || cut_.planesAt(source)[0] == ChunkPlane::kNone) continue;
    cut.onPlanes.push_back(v);
    cut.planesOf.push_back(cut_.planesAt(source));
  }
  cut.mesh.triangles = std::move(reduced.triangles);
  cut.chunkOf = std::move(reduced.regions);
  cut.chunks = cut_.chunks;
  cut.planes = cut_.planes;
  cut.errors = errorsOf(reduction_->certificate());
  return cut;
}

// What each vertex has gone into at last. One that went for a plane and into none has moved: its
// new place is a vertex of its own.
void ChunkChain::setInto(ChainLevel& level) {
  const std::vector<reduce::Index>& went = reduction_->wentInto();
  level.intoPlane = reduction_->wentFor();
  const reduce::ReducedMesh reduced = reduction_->mesh();
  const std::vector<reduce::LineStep>& lines = reduction_->surface().lineStep;
  std::vector<VertexIndex> now(level.own);
  std::iota(now.begin(), now.end(), 0);
  for (VertexIndex v = 0; v < lines.size(); ++v) {
    job_.pollCancelled(v);
    const reduce::Index name = lines[v].name;
    if (level.intoPlane[name] == ChunkPlane::kNone) continue;
    now[name] = static_cast<VertexIndex>(level.positions.size());
    add(level, reduced, v);
    level.curveVertex.push_back(curveVertices_++);
    level.into.push_back(now[name]);
  }
  for (VertexIndex v = 0; v < level.own; ++v) {
    job_.pollCancelled(v);
    VertexIndex last = v;
    while (went[last] != last) last = went[last];
    level.into[v] = now[last];
  }
  level.intoPlane.resize(level.positions.size(), ChunkPlane::kNone);
}

std::vector<double> ChunkChain::errorsOf(const reduce::Certificate& certificate) const {
  const bool isReduced = reduction_->triangleCount() < faces_.size();
  std::vector<double> errors(cut_.chunks.size(),
                             cut_.moved + mostMoved_ + (isReduced ? frame_.rounding() : 0));
  for (std::size_t i = 0; i < certificate.ofRegion.size(); ++i) {
    errors[i] += static_cast<double>(certificate.ofRegion[i]);
  }
  if (isScaled_) return errors;
  // Where the surface was moved, less was allowed by as much, or nothing if that is more.
  const double most = std::max(tolerance_, cut_.moved + mostMoved_ + frame_.rounding());
  for (double& error : errors) {
    if (certificate.beyond.empty()) error = std::min(error, most);
  }
  return errors;
}

// A vertex of the mesh as it is now.
void ChunkChain::add(ChainLevel& level, const reduce::ReducedMesh& reduced, VertexIndex v) const {
  const reduce::Index source = reduced.sources[v];
  const reduce::LineKind kind = source == reduce::kNone ? reduce::LineKind::Off : kinds_[source];
  level.cutVertex.push_back(kind == reduce::LineKind::Off ? ChainLevel::kNone : source);
  level.isEnd.push_back(kind == reduce::LineKind::End ? 1 : 0);
  const auto [at, normal] = place(reduced, v);
  level.normals.push_back(normal);
  level.positions.push_back(written(at));
}

ChunkChain::Placed ChunkChain::place(const reduce::ReducedMesh& reduced, VertexIndex v) const {
  const std::vector<Position>& at = cut_.mesh.positions;
  const reduce::Index source = reduced.sources[v];
  if (source != reduce::kNone && frame_.toLocal(at[source]) == reduced.positions[v]) {
    return {at[source], normals_[source]};
  }
  const Vec3f& local = reduced.positions[v];
  const auto placed = placed_.find({local.x, local.y, local.z});
  if (placed != placed_.end()) return placed->second;
  const Position p = frame_.toExact(reduced.positions[v]);
  const auto [a, b, c] = faces_[reduced.faces[v]].vertices;
  return {p, base::interpolatedNormal({Vec3(at[a]), Vec3(at[b]), Vec3(at[c])},
                                      {normals_[a], normals_[b], normals_[c]}, Vec3(p))};
}

ChainLevel ChunkChain::extract(const ChainLevel* before) const {
  reduce::ReducedMesh reduced = reduction_->mesh();
  ChainLevel level;
  level.own = reduced.positions.size();
  const std::vector<reduce::LineStep>& lines = reduction_->surface().lineStep;
  for (VertexIndex v = 0; v < level.own; ++v) {
    job_.pollCancelled(v);
    add(level, reduced, v);
    const VertexIndex onCurve = level.cutVertex[v];
    level.curveVertex.push_back(onCurve == ChainLevel::kNone || before == nullptr
                                    ? onCurve
                                    : before->curveVertex[before->into[lines[v].name]]);
    level.into.push_back(v);
  }
  level.intoPlane.assign(level.own, ChunkPlane::kNone);
  level.triangles = std::move(reduced.triangles);
  level.chunkOf = std::move(reduced.regions);
  level.transitionErrors.assign(cut_.chunks.size(), 0);
  return level;
}

}  // namespace tufa::chunks
