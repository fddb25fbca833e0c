#include "reduce/reduction.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/huge_pages.h"
#include "reduce/clearance.h"
#include "reduce/new_folds.h"
#include "reduce/part.h"

namespace tufa::reduce {
namespace {

constexpr float kRadians = 0.01745329252f;
// The first phase may spend so much of the tolerance.
constexpr float kFirstShare = 0.7f;
// Of the tolerance that guards allow. The rest is for crossings that walks along an axis do not see
// exactly.
constexpr float kMargin = 0.998f;
// Degrees by which a triangle's normal may turn at a time.
constexpr float kMostTurn = 60;
// Other surface farther than so many tolerances needs no intersection test.
constexpr float kClearance = 4;
// PhaseLimits::errorShare of most phases, and of one that tries harder. Above that hardly a
// collapse passes the distance guard.
constexpr float kErrorShare = 1;
constexpr float kLargeErrorShare = 1.4f;
// Phases that contract clusters. The second and third ones find them along borders of parts before,
// but make slivers: where none are wanted there is one.
constexpr int kClusterPhases = 3;
// Where so few of the vertices are inside parts, as large triangles lie across the borders, parts
// of the next phases may have so many times as many vertices before they are split for their
// samples.
constexpr float kFewInner = 0.6f;
constexpr Index kFewerParts = 2;
// Voxels from which on faces are measured where sections lead elsewhere. Below, that allows hardly
// any more collapses, and takes a quarter more time.
constexpr float kAsksFaces = 0.3f;
// Where quotas were elsewhere than edges to collapse there may be more phases than asked for.
constexpr int kMostPhases = 24;
// Where lines alone are reduced, triangles beside them get longer and thinner than they will be.
constexpr float kLeastAngleAtLines = 2;
constexpr int kMostValenceAtLines = 40;
// Where the topology or the shape of triangles is in the way, slivers, fans and turns are allowed.
constexpr int kMostValenceAtLast = 40;
constexpr float kMostTurnAtLast = 120;
// Voxels that a mesh may be expected to be off which has come in beside its reference.
constexpr float kUnknown = 0.1f;
// Voxels; at larger tolerances the first attempt lets edges end anywhere near.
constexpr float kLooseTolerance = 4;
// A proxy is good for tolerances from so many times its error on: sample meshes have as many
// triangles then, give or take a percent in sum.
constexpr float kProxyRatio = 15;
// What was beyond the tolerance is held within so many tolerances and voxels, twice the voxels with
// each attempt: at this share of the tolerance, down to so many voxels; below, and where that does
// not help, it stays as it is.
constexpr float kHeldTolerances = 2;
constexpr float kHeldVoxels = 0.25f;
constexpr float kHeldShare = 0.25f;
constexpr float kLeastHeld = 0.2f;

// The share of the vertices on the lower side of each cut between parts. It differs in all phases,
// so that no two have borders at the same places: multiples of the golden ratio are far apart.
float shareOf(Index phase) {
  const float turns = 0.08f + 0.618034f * static_cast<float>(phase);
  return 0.3f + 0.4f * (turns - std::floor(turns));
}

// Divides scales by the largest one and returns that; 1 if there are none, or none above 0. So a
// tolerance in here is the largest anywhere, which phases and clearances go by.
float takeLargest(std::vector<float>& scales) {
  const auto most = std::max_element(scales.begin(), scales.end());
  if (most == scales.end() || !(*most > 0)) return 1;
  const float largest = *most;
  for (float& scale : scales) scale /= largest;
  if (std::all_of(scales.begin(), scales.end(), [](float scale) { return scale == 1; })) {
    scales.clear();
  }
  return largest;
}

}  // namespace

Options optionsForAngle(double degrees) {
  Options options;
  if (!(degrees > 0)) return options;
  options.leastAngle = static_cast<float>(degrees);
  options.sliverShare = options.bentSliverShare = 0;
  return options;
}

Reduction::Meshes Reduction::meshesOf(const InputMesh& input, const InputMesh& reference,
                                      std::span<const Index> standsFor, std::vector<float> scales,
                                      base::Job& job) {
  const float largestScale = takeLargest(scales);
  Surface surface = makeSurface(input.positions, input.triangles, job);
  if (standsFor.empty()) {
    ReferenceMesh own(surface, std::move(scales), job);
    return {std::move(surface), std::move(own), largestScale};
  }
  const Surface other = makeSurface(reference.positions, reference.triangles, job);
  return {std::move(surface), ReferenceMesh(other, std::move(scales), job), largestScale};
}

Reduction::Reduction(const InputMesh& input, const InputMesh& reference,
                     std::span<const Index> standsFor, std::vector<float> scales, Options options,
                     base::Job& job)
    : Reduction(meshesOf(input, reference, standsFor, std::move(scales), job), standsFor.empty(),
                std::move(options), job) {
  locateAll(surface_, reference_, standsFor, job);
}

Reduction::Reduction(Meshes meshes, bool isReference, Options options, base::Job& job)
    : options_(std::move(options)),
      job_(job),
      surface_(std::move(meshes.surface)),
      reference_(std::move(meshes.reference)),
      largestScale_(meshes.largestScale),
      isReference_(isReference) {}

Reduction::~Reduction() = default;

// Where the certificate is beyond the tolerance, the mesh is reduced again, and left as it was
// around there. Smaller tolerances there instead take more attempts, and hardly fewer triangles.
void Reduction::toTolerance(float tolerance, LineMode lines) {
  tolerance *= largestScale_;
  if (lines == LineMode::Alone) beginLines();
  if (tolerance < kLeastTolerance) {
    if (!isReference_ && tolerance_ == 0) measureWithin(kUnknown);
    return;
  }
  chooseReference(tolerance);
  tolerance -= proxyError();
  lines_ = lines;
  keepsShape_ = true;
  const float toleranceBefore = tolerance_;
  std::optional<Surface> before;
  if (!isReference_ || lines == LineMode::Alone) before = surface_;
  trees_.clear();
  for (attempt_ = 0;; ++attempt_) {
    nextTree_ = 0;
    descendTo(tolerance, 0);
    measureWithin(tolerance_);
    std::vector<Index> held = certificate_.beyond;
    if (options_.faults) addFacesNear(options_.faults(mesh()), held);
    if (attempt_ < kFoldAttempts) {
      const std::vector<Index> folded = newFolds();
      held.insert(held.end(), folded.begin(), folded.end());
    }
    if (held.empty() || attempt_ == options_.attempts) break;
    hold(held, tolerance);
    tolerance_ = toleranceBefore;
    surface_ = before ? *before : wholeSurface();
  }
  reference_.releaseAll();
}

Certificate Reduction::certificate() const {
  Certificate all = certificate_;
  if (!original_) return all;
  all.largest += proxy_->largest;
  all.mean += proxy_->mean;
  for (float& largest : all.ofRegion) largest += proxy_->largest;
  return all;
}

// The mesh of the first tolerance stands in for the reference from tolerances on that are many
// times its error. The surface, which is within `now` of the reference, must be within what is left
// of the tolerance. Where scales differ from place to place, so would what is left.
void Reduction::chooseReference(float tolerance) {
  const bool isMeasured = !isReference_ && tolerance_ > 0;
  if (original_ || !isMeasured || reference_.hasScales()) return;
  if (!proxy_) proxy_ = makeProxy(surface_, certificate_.largest, certificate_.mean);
  const float error = proxy_->largest, now = std::max(tolerance_, certificate_.largest);
  if (tolerance < std::max(kProxyRatio * error, now + 2 * error)) return;
  ReferenceMesh mesh = makeReference(*proxy_, reference_, job_);
  handOver(surface_, reference_, *proxy_, mesh, job_);
  proxy_->owners = {};
  original_ = std::exchange(reference_, std::move(mesh));
  tolerance_ += error;
}

// The faces of the reference below folds that it does not have itself.
std::vector<Index> Reduction::newFolds() const {
  return facesAtNewFolds(surface_, reference_, tolerance_, job_);
}

// Less is allowed around some faces of the reference than the tolerance.
void Reduction::hold(const std::vector<Index>& faces, float tolerance) {
  const float share = kHeldShare * tolerance < kLeastHeld ? 0 : kHeldShare;
  const float radius = kHeldTolerances * tolerance + std::ldexp(kHeldVoxels, attempt_);
  reference_.hold(faces, radius, share, job_);
}

// The surface as it was while the mesh was the reference. Made again where it is asked for, which
// is seldom: a copy would take 18 bytes a vertex at the time of the most memory.
Surface Reduction::wholeSurface() const {
  Surface surface = makeSurface(reference_.positions(), reference_.faces(), job_);
  locateAll(surface, reference_, {}, job_);
  if (regions_) reduce::setRegions(surface, regions_(), job_);
  return surface;
}

// The faces of the reference below the corners of some triangles.
void Reduction::addFacesNear(const std::vector<Index>& triangles, std::vector<Index>& faces) const {
  for (const Index t : triangles) {
    for (const Index v : surface_.triangles[t].vertices) {
      const Index face = faceOf(surface_, reference_, v);
      if (face != kNone) faces.push_back(face);
    }
  }
}

void Reduction::setRegions(std::function<Regions()> regions) {
  regions_ = std::move(regions);
  reduce::setRegions(surface_, regions_(), job_);
}

void Reduction::setScales(std::vector<float> scales) {
  largestScale_ = takeLargest(scales);
  reference_.setScales(std::move(scales));
}

void Reduction::replaceParts(std::span<const ReplacedPart> parts,
                             const std::vector<std::uint8_t>& isHeld) {
  if (!parts.empty()) {
    reduce::replaceParts(surface_, reference_, parts, job_);
    isReference_ = false;
  }
  holdRegions(surface_, isHeld, job_);
}

// Names all vertices, and forgets what went where in the step before.
void Reduction::beginLines() {
  const auto count = static_cast<Index>(surface_.lineKind.size());
  surface_.lineStep.resize(count);
  surface_.into.resize(count);
  surface_.intoPlane.assign(count, kNone);
  surface_.changeOf.assign(surface_.triangles.size(), kNone);
  surface_.oldForms.clear();
  for (Index v = 0; v < count; ++v) {
    surface_.lineStep[v] = {kNone, v, false};
    surface_.into[v] = v;
  }
  for (const Triangle& t : surface_.triangles) {
    const bool isBeside = std::any_of(t.vertices.begin(), t.vertices.end(),
                                      [&](Index v) { return surface_.isOnLine(v); });
    for (const Index v : t.vertices) surface_.lineStep[v].isBeside |= isBeside;
  }
}

// Large tolerances by way of smaller ones: most collapses are cheap there, as little surface is
// near other surface and triangles hold few samples. All tolerances have the same way, so the mesh
// of a larger one is made of one that smaller ones are made of, too, and does not have more
// triangles for having taken another course.
void Reduction::descendTo(float tolerance, Index count) {
  for (float step = kFirstStep; kRampStep * step <= tolerance; step *= kStep) {
    if (step > kRampStep * tolerance_) reduce(step, count, kRampPhases);
  }
  reduce(tolerance, count, kPhases);
}

// Each phase sees other parts. The first one spends a share of the tolerance only, so that surface
// along its parts' borders does not lag behind; once phases find little more, one tries harder.
void Reduction::reduce(float tolerance, Index count, int phases) {
  const bool isFirst = tolerance_ == 0;
  tolerance_ = std::max(tolerance_, tolerance);
  PhaseLimits limits;
  const float sine = std::sin(options_.leastAngle * kRadians);
  limits.leastSine2 = sine * sine;
  limits.sliverShare = options_.sliverShare;
  limits.bentSliverShare =
      tolerance > kStuckTolerance ? options_.sliverShare : options_.bentSliverShare;
  limits.turnCosine = std::cos(kMostTurn * kRadians);
  limits.flips = lines_ != LineMode::Alone;
  limits.lines = lines_;
  if (lines_ == LineMode::Alone) {
    const float least = std::sin(kLeastAngleAtLines * kRadians);
    limits.leastSine2 = least * least;
    limits.mostValence = kMostValenceAtLines;
  }
  if (!keepsShape_ && tolerance > kStuckTolerance) {
    limits.sliverShare = limits.bentSliverShare = 1;
    limits.mostValence = kMostValenceAtLast;
    limits.turnCosine = std::cos(kMostTurnAtLast * kRadians);
  }
  limits.isLoose = tolerance > kLooseTolerance && attempt_ == 0;
  limits.switchedOff = options_.switchedOff;
  PartSize size = options_.partSize;
  for (int i = 0, left = phases; left > 0 && triangleCount() > count; ++i, --left) {
    const bool isLast = left == 1 && phases == kPhases;
    limits.distance = tolerance * kMargin * (i == 0 ? kFirstShare : 1);
    limits.asksFaces = limits.distance >= kAsksFaces;
    limits.errorShare = isLast ? kLargeErrorShare : kErrorShare;
    limits.allPlaces = isLast;
    limits.clusters = options_.clusters && isFirst && lines_ == LineMode::Free &&
                      i < (limits.keepsAngle() ? 1 : kClusterPhases);
    const Index before = triangleCount();
    buildParts(size);
    if (partition_.innerShare() < kFewInner) {
      size.leastVertices = std::min(size.leastVertices * kFewerParts, size.vertices);
    }
    if (i == 0) markNarrow(surface_, partition_, kClearance * tolerance, job_);
    runPhase(limits, count);
    const bool isMore = lastCounts_.overQuota > 0 && triangleCount() < before;
    if (isMore && left == 1 && i < kMostPhases) ++left;
    if (i > 0 && hasRemovedLittle(before) && !isMore) left = std::min(left, 2);
  }
}

// The parts of a further attempt are those of the first one, so that it takes another course only
// near what is held.
void Reduction::buildParts(const PartSize& size) {
  if (nextTree_ == trees_.size()) {
    partition_.build(surface_, size, shareOf(phaseNumber_), job_);
    trees_.push_back(partition_.tree());
  } else {
    partition_.build(surface_, trees_[nextTree_], job_);
  }
  ++nextTree_;
}

// The parts, those of much work first, so that threads end at about the same time.
std::vector<Index> Reduction::largestFirst() const {
  std::vector<Index> order(partition_.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::size_t> work(order.size());
  for (const Index p : order) {
    work[p] = partition_.vertices(p).size();
    if (!surface_.isWhole) work[p] += partition_.samples(p).size();
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return work[a] > work[b]; });
  return order;
}

std::unique_ptr<Part> Reduction::takePart() {
  const std::lock_guard<std::mutex> lock(partsMutex_);
  if (parts_.empty()) return std::make_unique<Part>(job_);
  std::unique_ptr<Part> part = std::move(parts_.back());
  parts_.pop_back();
  return part;
}

void Reduction::returnPart(std::unique_ptr<Part> part) {
  const std::lock_guard<std::mutex> lock(partsMutex_);
  lastCounts_ += part->counts();
  part->clearCounts();
  lastChanges_.insert(lastChanges_.end(), part->changes().begin(), part->changes().end());
  part->changes().clear();
  lastWithWays_.insert(lastWithWays_.end(), part->withWays().begin(), part->withWays().end());
  part->withWays().clear();
  lastForms_.insert(lastForms_.end(), part->forms().begin(), part->forms().end());
  part->forms().clear();
  lastStored_.push_back(std::move(part->stored()));
  part->stored() = {};
  parts_.push_back(std::move(part));
}

// Parts read what no other part writes, so that their order does not show.
void Reduction::runPhase(const PhaseLimits& limits, Index count) {
  std::vector<std::uint8_t> dead;
  base::resizeLarge(dead, surface_.triangles.size(), job_);
  const std::vector<Index> quota = quotas(count);
  lastCounts_ = {};
  const std::vector<Index> order = largestFirst();
  std::atomic<std::size_t> next{0};
  job_.forRanges(order.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<Part> part = takePart();
    for (std::size_t i = begin; i < end; ++i) {
      const Index p = order[next++];
      PhaseLimits own = limits;
      own.quota = quota[p];
      part->load(surface_, reference_, partition_, p, own);
      if (own.clusters) part->contractClusters();
      part->collapseAll();
      if (limits.flips) part->flipAll();
      part->store(surface_, dead);
    }
    returnPart(std::move(part));
  });
  counts_ += lastCounts_;
  reference_.requireWays(lastWithWays_);
  lastWithWays_.clear();
  for (const auto& [vertex, plane] : lastChanges_) surface_.lineStep[vertex].addChange(plane);
  lastChanges_.clear();
  surface_.oldForms.insert(surface_.oldForms.end(), lastForms_.begin(), lastForms_.end());
  lastForms_.clear();
  isReference_ = false;
  if (surface_.isWhole) partition_ = {};  // at the time of the most memory
  apply(surface_, reference_, lastStored_, dead, job_);
  lastStored_.clear();
  ++phaseNumber_;
}

// Where large triangles hold many samples, parts are as much memory as the mesh.
void Reduction::measureWithin(float expected) {
  partition_ = {};
  parts_.clear();
  certificate_ = isReference_ ? Certificate() : certify(surface_, reference_, expected, job_);
}

ReducedMesh Reduction::mesh() const {
  const Surface& s = surface_;
  ReducedMesh mesh{{s.position.begin(), s.position.end()},
                   {s.triangles.begin(), s.triangles.end()},
                   s.source,
                   s.face,
                   {s.region.begin(), s.region.end()}};
  if (original_) {
    for (Index v = 0; v < s.position.size(); ++v) {
      mesh.faces[v] = faceBelow(*original_, *proxy_, s.face[v], s.position[v], s.axis[v].vector());
    }
  }
  if (!s.isWhole) return mesh;
  for (Index v = 0; v < s.position.size(); ++v) {
    mesh.sources.push_back(v);
    mesh.faces.push_back(faceOf(s, reference_, v));
  }
  return mesh;
}

}  // namespace tufa::reduce
