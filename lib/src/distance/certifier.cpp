#include "distance/certifier.h"

#include <algorithm>
#include <cmath>

#include <limits>
#include "base/huge_pages.h"

namespace tufa::distance {

using octree::Cut;

namespace {

constexpr std::size_t kChunk = 2048;
constexpr std::uint32_t kNoPiece = std::numeric_limits<std::uint32_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Samples inside a triangle: one for each two voxels of its longest edge, but at most this many
// along it. Points of the uniform mesh, which are dense, are measured too; samples find what
// protrudes between them.
constexpr int kMostSteps = 3;
constexpr double kSampleSpacing = 2;
// Voxels to search around a sample at most. What is farther is measured to the uniform quad that
// the polygon comes from.
constexpr double kLongestReach = 16;

}  // namespace

double toleranceAt(const octree::CutRule& rule, const grid::Affine& affine, const Vec3& point) {
  if (!rule.scale) return rule.tolerance;
  const Coord& origin = affine.origin();
  return rule.toleranceAt(affine.latticePoint({point[0], point[1], point[2]}, origin) +
                          Vec3(origin));
}

Certifier::Certifier(const uniform::SurfaceView& base, const UniformReference& surface,
                     const octree::CutRule& rule, base::Job& job)
    : base_(base), surface_(surface), rule_(rule), job_(job) {
  base::resizeLarge(vertexErrors_, base.mesh.positions.size(), job);
  base::resizeLarge(quadErrors_, base.mesh.quads.size(), job);
  base::resizeLarge(wandered_, base.mesh.positions.size() + base.mesh.quads.size(), job);
}

// Four passes, each parallel over points or triangles: uniform vertices, uniform quads, vertices of
// the mesh, samples inside its triangles. Points whose surroundings did not change keep their
// distance from the mesh before, and count in the mean and among the far points, but are not
// measured.
Deviation Certifier::measure(const Cut& cut, const octree::CutMesh& made,
                             const std::vector<VertexIndex>& altered) {
  cut_ = &cut;
  made_ = &made;
  altered_.assign(cut.clusters.size(), 0);
  for (const VertexIndex vertex : altered) altered_[vertex] = 1;
  collectNewTriangles();
  newTriangleErrors_.assign(newTriangles_.size(), 0);
  cornerErrors_.assign(cut.clusters.size(), 0);
  findChanges();
  Deviation total;
  double sum = 0, unused = 0;
  forChunks(
      vertexErrors_.size(), [&](std::size_t i, Part& part) { measureVertex(i, part); }, total, sum);
  forChunks(
      quadErrors_.size(), [&](std::size_t i, Part& part) { measureQuad(i, part); }, total, sum);
  const std::size_t points = vertexErrors_.size() + quadErrors_.size();
  total.mean = points == 0 ? 0 : sum / static_cast<double>(points);
  Deviation samples;
  forChunks(
      cut.clusters.size(),
      [&](std::size_t i, Part& part) { measureCorner(static_cast<VertexIndex>(i), part); }, samples,
      unused);
  forChunks(
      newTriangles_.size(), [&](std::size_t i, Part& part) { measureNewTriangle(i, part); },
      samples, unused);
  largestKept_ = std::max({largestKept_, total.largest, samples.largest});
  total.largest = largestKept_;
  total.worst = std::max(total.worst, samples.worst);
  total.coarse.insert(total.coarse.end(), samples.coarse.begin(), samples.coarse.end());
  total.protruding = std::move(samples.coarse);
  for (std::vector<VertexIndex>* vertices : {&total.coarse, &total.protruding}) {
    std::sort(vertices->begin(), vertices->end());
    vertices->erase(std::unique(vertices->begin(), vertices->end()), vertices->end());
  }
  job_.checkCancelled(0, 1);
  positions_ = made.mesh.positions;
  if (vertexOf_.empty()) base::resizeLarge(vertexOf_, cut.vertexOf.size(), job_);
  vertexOf_ = cut.vertexOf;
  alteredKept_ = altered_;
  return total;
}

std::vector<float> Certifier::errorsAtVertices() const {
  std::vector<float> errors = cornerErrors_;
  const auto raise = [&](VertexIndex vertex, float error) {
    errors[vertex] = std::max(errors[vertex], error);
  };
  for (std::size_t i = 0; i < vertexErrors_.size(); ++i) raise(cut_->vertexOf[i], vertexErrors_[i]);
  for (std::size_t i = 0; i < quadErrors_.size(); ++i) {
    for (const VertexIndex corner : base_.mesh.quads[i].vertices) {
      raise(cut_->vertexOf[corner], quadErrors_[i]);
    }
  }
  for (std::size_t i = 0; i < newTriangles_.size(); ++i) {
    for (const VertexIndex corner : newTriangles_[i].corners) raise(corner, newTriangleErrors_[i]);
  }
  return errors;
}

// Collects the triangles at vertices of larger cells or altered ones, and for each vertex those of
// the polygons around it. Polygons of uniform vertices alone are those of the uniform mesh: their
// distance is 0. Both triangles of a quad count at all its corners, as a point may lie above the
// one that a corner is not part of.
void Certifier::collectNewTriangles() {
  const Mesh& mesh = made_->mesh;
  newTriangles_.clear();
  const auto take = [&](const std::array<VertexIndex, 4>& v, std::uint32_t source) {
    newTriangles_.push_back(
        {v, source,
         base::FlatTriangle(Vec3(mesh.positions[v[0]]), Vec3(mesh.positions[v[1]]),
                            Vec3(mesh.positions[v[2]]))});
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& v = mesh.triangles[i].vertices;
    job_.pollCancelled(i);
    if (isFine(v[0]) && isFine(v[1]) && isFine(v[2])) continue;
    take({v[0], v[1], v[2], v[0]}, made_->triangleSources[i]);
  }
  for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
    const auto& v = mesh.quads[i].vertices;
    job_.pollCancelled(i);
    if (std::all_of(v.begin(), v.end(), [&](VertexIndex vertex) { return isFine(vertex); }))
      continue;
    take({v[0], v[1], v[2], v[3]}, made_->quadSources[i]);
    take({v[0], v[2], v[3], v[1]}, made_->quadSources[i]);
  }
  const auto countOf = [](const NewTriangle& triangle) {
    return triangle.corners[3] == triangle.corners[0] ? 3 : 4;
  };
  firstAround_.assign(mesh.positions.size() + 1, 0);
  for (const NewTriangle& triangle : newTriangles_) {
    for (int i = 0; i < countOf(triangle); ++i) ++firstAround_[triangle.corners[i] + 1];
  }
  for (std::size_t i = 1; i < firstAround_.size(); ++i) firstAround_[i] += firstAround_[i - 1];
  around_.resize(firstAround_.back());
  std::vector<std::uint32_t> next(firstAround_.begin(), firstAround_.end() - 1);
  for (std::uint32_t t = 0; t < newTriangles_.size(); ++t) {
    for (int i = 0; i < countOf(newTriangles_[t]); ++i)
      around_[next[newTriangles_[t].corners[i]]++] = t;
  }
}

// Marks what must be measured again. A vertex has changed if a uniform vertex that it stands for
// stood at another place before, or was altered; a distance can have changed only if a triangle
// that it was measured to has, so vertices that share a polygon with a changed one are touched.
void Certifier::findChanges() {
  const std::vector<Position>& positions = made_->mesh.positions;
  changed_.assign(positions.size(), positions_.empty() ? 1 : 0);
  touched_ = changed_;
  if (positions_.empty()) return;
  for (std::size_t i = 0; i < vertexOf_.size(); ++i) {
    job_.pollCancelled(i);
    const VertexIndex vertex = cut_->vertexOf[i], before = vertexOf_[i];
    if (altered_[vertex] != 0 || alteredKept_[before] != 0 ||
        !(positions[vertex] == positions_[before])) {
      changed_[vertex] = 1;
    }
  }
  touched_ = changed_;
  for (const NewTriangle& triangle : newTriangles_) {
    const auto& v = triangle.corners;
    if (std::none_of(v.begin(), v.end(), [&](VertexIndex i) { return changed_[i] != 0; })) continue;
    for (const VertexIndex vertex : v) touched_[vertex] = 1;
  }
}

// Finds a triangle around `vertex` that the point lies above and within `enough` of, squared, or
// else the nearest one if it is nearer than `squared`. True if it is the former: the search may
// end, as what is within the tolerance needs no nearer place.
bool Certifier::findAround(VertexIndex vertex, const Vec3& point, double enough, double& squared,
                           std::uint32_t& nearest) const {
  const std::uint32_t begin = firstAround_[vertex], end = firstAround_[vertex + 1];
  for (std::uint32_t i = begin; i < end; ++i) {
    double height = 0;
    if (!newTriangles_[around_[i]].shape.isAbove(point, height) || height > enough) continue;
    squared = height;
    nearest = around_[i];
    return true;
  }
  for (std::uint32_t i = begin; i < end; ++i) {
    const base::FlatTriangle& shape = newTriangles_[around_[i]].shape;
    if (shape.squaredHeight(point) >= squared) continue;
    const double distance = shape.squaredDistance(point);
    if (distance >= squared) continue;
    squared = distance;
    nearest = around_[i];
  }
  return false;
}

// Where vertices were joined, the polygon below a point need not be around its cluster. Goes from
// triangle to neighbouring triangle while that comes nearer: never to another sheet, as those are
// not neighbours. Ends, as the distance falls with each step.
void Certifier::walkNearer(const Vec3& point, double enough, double& squared,
                           std::uint32_t& nearest) const {
  for (std::uint32_t last = kNoPiece; squared > enough && last != nearest;) {
    last = nearest;
    const auto corners = newTriangles_[nearest].corners;
    for (const VertexIndex corner : corners) {
      if (findAround(corner, point, enough, squared, nearest)) return;
    }
  }
}

// The distance of a uniform point to the polygons around its clusters, in voxels.
float Certifier::distanceAround(const VertexIndex* vertices, int count, const Vec3& point,
                                std::uint8_t& wandered, Part& part) const {
  double squared = kInfinity;
  std::uint32_t nearest = 0;
  const double bound = toleranceAt(point) * base_.affine.voxelSize();
  for (int i = 0; i < count; ++i) {
    if (std::find(vertices, vertices + i, vertices[i]) != vertices + i) continue;
    if (findAround(vertices[i], point, bound * bound, squared, nearest)) break;
  }
  if (std::isinf(squared)) {  // no polygon is left around them
    part.coarse.insert(part.coarse.end(), vertices, vertices + count);
    return 0;
  }
  wandered = squared > bound * bound ? 1 : 0;
  walkNearer(point, bound * bound, squared, nearest);
  const double voxels = std::sqrt(squared) / base_.affine.voxelSize();
  note(point, voxels, newTriangles_[nearest].corners.data(), 4, part);
  return static_cast<float>(voxels);
}

void Certifier::measureVertex(std::size_t index, Part& part) {
  const VertexIndex vertex = cut_->vertexOf[index];
  float& error = vertexErrors_[index];
  if (isFine(vertex)) {
    error = 0;
    return;
  }
  const Vec3 point = Vec3(base_.mesh.positions[index]);
  if (touched_[vertex] != 0 || wandered_[index] != 0) {
    error = distanceAround(&vertex, 1, point, wandered_[index], part);
  }
  noteFar(index, point, static_cast<double>(error), part);
  part.sum += static_cast<double>(error);
}

void Certifier::measureQuad(std::size_t index, Part& part) {
  const auto& v = base_.mesh.quads[index].vertices;
  std::array<VertexIndex, 4> around{};
  bool fine = true, touched = false;
  for (int i = 0; i < 4; ++i) {
    around[i] = cut_->vertexOf[v[i]];
    fine &= isFine(around[i]);
    touched |= touched_[around[i]] != 0;
  }
  if (!ignored_.empty() && ignored_[index] != 0) return;
  float& error = quadErrors_[index];
  if (fine) {
    error = 0;
    return;
  }
  const std::size_t number = base_.mesh.positions.size() + index;
  const Vec3 middle = (Vec3(base_.mesh.positions[v[0]]) + Vec3(base_.mesh.positions[v[2]])) * 0.5;
  if (touched || wandered_[number] != 0) {
    error = distanceAround(around.data(), 4, middle, wandered_[number], part);
  }
  if (error > 0) noteFar(number, middle, static_cast<double>(error), part);
  part.sum += static_cast<double>(error);
}

// The distance of a point of a polygon to the uniform mesh, world units. Where the mesh is folded
// its normals mislead, so the uniform quad that the polygon comes from and the normals of its
// vertices are tried as well.
double Certifier::distanceBelow(const Vec3& point, const Vec3& outward,
                                std::uint32_t source) const {
  const double enough = toleranceAt(point) * base_.affine.voxelSize();
  double least =
      std::min(distanceToBase(point, outward, enough), surface_.distanceToQuad(point, source));
  for (const VertexIndex vertex : base_.mesh.quads[source].vertices) {
    if (least <= enough) break;
    const Normal& n = base_.mesh.normals[vertex];
    least = std::min(least, distanceToBase(point, Vec3(n), enough));
  }
  return least;
}

void Certifier::measureCorner(VertexIndex vertex, Part& part) {
  if (changed_[vertex] == 0 || isFine(vertex)) return;
  if (firstAround_[vertex] == firstAround_[vertex + 1]) return;
  const octree::ClusterRef& ref = cut_->clusters[vertex];
  if (ref.level == 0 && made_->mesh.positions[vertex] == base_.mesh.positions[ref.cluster]) return;
  const Vec3 point = Vec3(made_->mesh.positions[vertex]);
  const NewTriangle& triangle = newTriangles_[around_[firstAround_[vertex]]];
  const double voxels =
      distanceBelow(point, facing(&vertex, 1), triangle.source) / base_.affine.voxelSize();
  cornerErrors_[vertex] = static_cast<float>(voxels);
  note(point, voxels, &vertex, 1, part);
}

// Samples inside a triangle. Its corners are measured once for all triangles around them, see
// measureCorner().
void Certifier::measureNewTriangle(std::size_t index, Part& part) {
  const NewTriangle& triangle = newTriangles_[index];
  const auto& v = triangle.corners;
  if (std::none_of(v.begin(), v.end(), [&](VertexIndex i) { return changed_[i] != 0; })) return;
  const Mesh& mesh = made_->mesh;
  const Vec3 a = Vec3(mesh.positions[v[0]]), b = Vec3(mesh.positions[v[1]]),
             c = Vec3(mesh.positions[v[2]]);
  const double voxel = base_.affine.voxelSize();
  const double longest = std::sqrt(
      std::max({(b - a).squaredLength(), (c - b).squaredLength(), (a - c).squaredLength()}));
  const int steps =
      static_cast<int>(std::clamp(longest / (kSampleSpacing * voxel), 1.0, double{kMostSteps}));
  const Vec3 outward = facing(v.data(), 4);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; i + j < steps; ++j) {
      // The centroids of the upright ones of the small triangles that fill this one.
      const double s = (i + 1.0 / 3) / steps, t = (j + 1.0 / 3) / steps;
      const Vec3 point = a + (b - a) * s + (c - a) * t;
      const double voxels = distanceBelow(point, outward, triangle.source) / voxel;
      note(point, voxels, v.data(), 4, part);
      newTriangleErrors_[index] = std::max(newTriangleErrors_[index], static_cast<float>(voxels));
    }
  }
}

// Lists a uniform point that is too far, whether its distance is new or kept from a mesh before.
void Certifier::noteFar(std::uint64_t index, const Vec3& point, double voxels, Part& part) const {
  if (voxels > toleranceAt(point)) part.farPoints.push_back(index);
}

// Records a distance. Where it exceeds the tolerance, the largest cells of the polygon must be
// split.
void Certifier::note(const Vec3& point, double voxels, const VertexIndex* corners, int count,
                     Part& part) const {
  part.worst = std::max(part.worst, voxels);
  if (voxels <= toleranceAt(point)) {
    part.largest = std::max(part.largest, voxels);
    return;
  }
  int level = 1;
  for (int i = 0; i < count; ++i) level = std::max(level, int{cut_->clusters[corners[i]].level});
  for (int i = 0; i < count; ++i) {
    if (cut_->clusters[corners[i]].level == level) part.coarse.push_back(corners[i]);
  }
}

// The mean normal of vertices. The polygon's own normal does not serve: it may be folded over.
Vec3 Certifier::facing(const VertexIndex* vertices, int count) const {
  Vec3 sum(0.0);
  for (int i = 0; i < count; ++i) {
    const Normal& n = made_->mesh.normals[vertices[i]];
    sum += Vec3(n);
  }
  sum.normalize();
  return sum;
}

double Certifier::toleranceAt(const Vec3& point) const {
  return distance::toleranceAt(rule_, base_.affine, point);
}

int Certifier::reachOf(double voxels) {
  return 3 + static_cast<int>(std::min(kLongestReach, voxels));
}

// Runs body over chunks in parallel and adds up their results in order, so that sums and lists are
// the same for any number of threads.
template <class Body>
void Certifier::forChunks(std::size_t count, const Body& body, Deviation& total, double& sum) {
  std::vector<Part> parts((count + kChunk - 1) / kChunk);
  job_.forRanges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      const std::size_t last = std::min((chunk + 1) * kChunk, count);
      for (std::size_t i = chunk * kChunk; i < last; ++i) body(i, parts[chunk]);
    }
  });
  for (const Part& part : parts) {
    total.largest = std::max(total.largest, part.largest);
    total.worst = std::max(total.worst, part.worst);
    sum += part.sum;
    total.coarse.insert(total.coarse.end(), part.coarse.begin(), part.coarse.end());
    total.farPoints.insert(total.farPoints.end(), part.farPoints.begin(), part.farPoints.end());
  }
}

}  // namespace tufa::distance
