#include "refine/surface_reduction.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/box.h"
#include "base/connected.h"
#include "base/huge_pages.h"
#include "base/interpolated_normal.h"
#include "intersect/surface.h"
#include "refine/rounding.h"
#include "refine/tolerance_scales.h"

namespace tufa::refine {
namespace {

using base::Vec3f;

}  // namespace

SurfaceReduction::SurfaceReduction(SurfaceModel& model, const octree::CutRule& rule, base::Job& job)
    : model_(model), rule_(rule), job_(job) {
  const Mesh& mesh = model.mesh();
  std::vector<float> scales = scalesOf(mesh, model.affine(), rule, job);
  closeVertices_ = intersect::verticesOf(mesh, intersect::distinctPolygonsOf(model.closePairs()));
  for (const VertexIndex v : closeVertices_) closePositions_.push_back(mesh.positions[v]);
  // One array after the other, so that few are there twice.
  normals_ = base::PackedNormals(model.takeNormals(), job);
  faces_ = model.takeFaces(job);
  frame_ = LocalFrame(mesh.positions, model.affine().voxelSize(), job);
  takePositions(mesh.positions);
  keepsExact_ = model.report().openEdges > 0 || frame_.rounding() > 0 ||
                rule.tolerance < static_cast<double>(reduce::kLeastTolerance) ||
                std::any_of(scales.begin(), scales.end(), [](float scale) { return scale == 0; });
  if (!keepsExact_) model.releasePositions();
  const reduce::InputMesh input{positions_, faces_};
  reduce::Options options = reduce::optionsForAngle(rule.minAngle);
  if (model.repairs()) {
    options.faults = [this](const reduce::ReducedMesh& m) { return findIntersecting(m); };
  }
  reduction_.emplace(input, input, std::span<const reduce::Index>(), std::move(scales),
                     std::move(options), job);
}

void SurfaceReduction::takePositions(const std::vector<Position>& exact) {
  std::vector<Vec3f> positions;
  base::resizeLarge(positions, exact.size(), job_);
  job_.forRanges(positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) positions[i] = frame_.toLocal(exact[i]);
  });
  positions_ = std::move(positions);
}

Position SurfaceReduction::positionOf(const reduce::ReducedMesh& reduced,
                                      std::size_t vertex) const {
  const reduce::Index source = reduced.sources[vertex];
  if (source == reduce::kNone) return frame_.toExact(reduced.positions[vertex]);
  if (keepsExact_) return model_.mesh().positions[source];
  const auto found = std::lower_bound(closeVertices_.begin(), closeVertices_.end(), source);
  if (found == closeVertices_.end() || *found != source) return frame_.toExact(positions_[source]);
  return closePositions_[static_cast<std::size_t>(found - closeVertices_.begin())];
}

Normal SurfaceReduction::normalOf(const reduce::ReducedMesh& reduced, std::size_t vertex) const {
  const reduce::Index source = reduced.sources[vertex];
  if (source != reduce::kNone) return normals_[source];
  const auto [a, b, c] = faces_[reduced.faces[vertex]].vertices;
  return base::interpolatedNormal({Vec3(positions_[a]), Vec3(positions_[b]), Vec3(positions_[c])},
                                  {normals_[a], normals_[b], normals_[c]},
                                  Vec3(reduced.positions[vertex]));
}

// The triangles that intersect once the mesh is finished as finishMesh() does. Guards in single
// precision may take a star of slivers along a crease for simple whose vertices are out of order by
// less than they can tell.
std::vector<reduce::Index> SurfaceReduction::findIntersecting(const reduce::ReducedMesh& reduced) {
  Mesh mesh;
  mesh.positions.resize(reduced.positions.size());
  job_.forRanges(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = positionOf(reduced, i);
  });
  (void)takeToWorld(mesh, model_.affine(), job_);
  mesh.triangles = reduced.triangles;
  std::vector<intersect::PolygonIndex> found = intersect::findIntersecting(mesh, job_);
  isSearched_ = found.empty();
  return found;
}

AdaptiveMesh SurfaceReduction::toTolerance(double tolerance, bool drops) {
  isSearched_ = false;
  reduction_->toTolerance(static_cast<float>(frame_.within(tolerance)));
  AdaptiveMesh adaptive;
  const reduce::ReducedMesh reduced = extract(adaptive);
  if (!drops) return adaptive;
  findComponents();
  std::vector<std::uint8_t> isDropped(components_.size());
  for (std::size_t i = 0; i < components_.size(); ++i) {
    isDropped[i] = components_[i].size <= tolerance * components_[i].scale ? 1 : 0;
  }
  drop(isDropped, reduced, adaptive);
  return adaptive;
}

AdaptiveMesh SurfaceReduction::toCount(std::size_t triangles, bool drops) {
  const auto count = static_cast<reduce::Index>(
      std::min<std::size_t>(triangles, std::numeric_limits<reduce::Index>::max()));
  isSearched_ = false;
  const auto most = static_cast<float>(frame_.within(frame_.size()));
  if (most >= reduce::kLeastTolerance) reduction_->toCount(count, most);
  AdaptiveMesh adaptive;
  const reduce::ReducedMesh reduced = extract(adaptive);
  std::size_t left = reduced.triangles.size();
  if (!drops || left <= triangles) return adaptive;
  findComponents();
  const std::vector<std::size_t> counts = trianglesOfComponents(reduced);
  std::vector<std::uint32_t> order(components_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return components_[a].size < components_[b].size;
  });
  std::vector<std::uint8_t> isDropped(components_.size());
  for (const std::uint32_t component : order) {
    if (left <= triangles) break;
    if (components_[component].scale == 0) continue;
    isDropped[component] = 1;
    left -= counts[component];
  }
  drop(isDropped, reduced, adaptive);
  return adaptive;
}

reduce::ReducedMesh SurfaceReduction::extract(AdaptiveMesh& adaptive) const {
  const reduce::Certificate certificate = reduction_->certificate();
  const bool isReduced = reduction_->triangleCount() < faces_.size();
  adaptive.largestError =
      static_cast<double>(certificate.largest) + (isReduced ? frame_.rounding() : 0);
  adaptive.meanError = static_cast<double>(certificate.mean);
  adaptive.rounds = reduction_->attempts();
  reduce::ReducedMesh reduced = reduction_->mesh();
  ExtractedMesh& extracted = adaptive.extracted;
  Mesh& mesh = extracted.mesh;
  const std::size_t count = reduced.positions.size();
  mesh.positions.resize(count);
  mesh.normals.resize(count);
  extracted.baseVertices.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const reduce::Index source = reduced.sources[i];
    extracted.baseVertices[i] = source == reduce::kNone ? octree::kNone : source;
    mesh.positions[i] = positionOf(reduced, i);
    mesh.normals[i] = normalOf(reduced, i);
  }
  mesh.triangles = reduced.triangles;
  extracted.baseQuads.assign(mesh.triangles.size(), octree::kNone);
  if (!isSearched_) {
    extracted.candidates.resize(mesh.triangles.size());
    std::iota(extracted.candidates.begin(), extracted.candidates.end(), 0);
  }
  return reduced;
}

// The components of the uniform mesh that may be left out have a scale above 0; that of most
// vertices has none.
void SurfaceReduction::findComponents() {
  if (!components_.empty()) return;
  const std::vector<VertexIndex> lowest =
      base::connectedItems(positions_.size(), [&](const auto& connect) {
        for (const Triangle& face : faces_) {
          for (const VertexIndex other : face.vertices) connect(face.vertices[0], other);
        }
      });
  componentOf_.resize(lowest.size());
  std::vector<base::Box> boxes;
  std::vector<std::size_t> counts;
  octree::CutRule one = rule_;
  one.tolerance = 1;
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    if (lowest[i] == i) {
      componentOf_[i] = static_cast<std::uint32_t>(components_.size());
      components_.push_back({Vec3(0.0), 0, std::numeric_limits<double>::infinity(), false});
      boxes.push_back(base::Box::empty());
      counts.push_back(0);
    }
    const std::uint32_t component = componentOf_[i] = componentOf_[lowest[i]];
    const Vec3 point(frame_.toExact(positions_[i]));
    boxes[component].add(point);
    ++counts[component];
    double& scale = components_[component].scale;
    scale = std::min(scale, std::max(0.0, toleranceAt(one, model_.affine(), point)));
  }
  for (std::size_t i = 0; i < components_.size(); ++i) {
    components_[i].centre = boxes[i].centre();
    components_[i].size = boxes[i].size().length() / model_.affine().voxelSize();
  }
  const auto largest = std::max_element(counts.begin(), counts.end()) - counts.begin();
  components_[static_cast<std::size_t>(largest)].scale = 0;
}

std::uint32_t SurfaceReduction::componentAt(const reduce::ReducedMesh& reduced,
                                            std::size_t vertex) const {
  return componentOf_[faces_[reduced.faces[vertex]].vertices[0]];
}

std::vector<std::size_t> SurfaceReduction::trianglesOfComponents(
    const reduce::ReducedMesh& reduced) const {
  std::vector<std::size_t> counts(components_.size());
  for (const Triangle& triangle : reduced.triangles) {
    ++counts[componentAt(reduced, triangle.vertices[0])];
  }
  return counts;
}

void SurfaceReduction::drop(const std::vector<std::uint8_t>& isDropped,
                            const reduce::ReducedMesh& reduced, AdaptiveMesh& adaptive) {
  ExtractedMesh& extracted = adaptive.extracted;
  std::erase_if(extracted.mesh.triangles, [&](const Triangle& triangle) {
    return isDropped[componentAt(reduced, triangle.vertices[0])] != 0;
  });
  for (std::size_t i = 0; i < components_.size(); ++i) {
    if (isDropped[i] == 0 || components_[i].isTold) continue;
    adaptive.dropped.push_back({components_[i].centre, components_[i].size});
    components_[i].isTold = true;
  }
  const std::size_t left = extracted.mesh.triangles.size();
  extracted.baseQuads.resize(left);
  extracted.candidates.resize(isSearched_ ? 0 : left);
  (void)removeUnused(extracted.mesh, extracted.baseVertices);
}

}  // namespace tufa::refine
