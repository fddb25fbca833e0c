#include "reduce/surface.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <utility>

#include "base/atomic_bits.h"
#include "base/collect.h"
#include "base/huge_pages.h"
#include "base/ranked_bits.h"
#include "base/shrink.h"
#include "reduce/local_quadric.h"
#include "reduce/reference_mesh.h"
#include "reduce/star.h"

namespace tufa::reduce {
namespace {

constexpr float kSteepCosine = 0.65f;
constexpr float kFar = std::numeric_limits<float>::max();

// Vertices are marked from several threads at a time.
void setFlag(std::uint8_t& flags, VertexFlag flag) {
  std::atomic_ref<std::uint8_t>(flags).fetch_or(flag, std::memory_order_relaxed);
}

// Whether triangles with these normals turn about two axes, not all about one as on planes,
// cylinders, cones and straight creases. By the eigenvalues a > b > c of the sum of n n^T: a is
// about the number of normals, so the principal minors add up to about a (b + c), and the
// determinant times a over their square is b c / (b + c)^2, about c / b where that is small.
bool bendBothWays(const Vec3f* normals, int n) {
  constexpr float kFlat = 1e-5f;    // b / a: a fifth of a degree
  constexpr float kOneWay = 0.02f;  // c / b
  LocalQuadric sum;
  for (int i = 0; i < n; ++i) sum.addPlane(normals[i], 1);
  const float first = sum.weight, minors = sum.minors();
  if (minors <= kFlat * first * first) return false;
  return sum.determinant() * first > kOneWay * minors * minors;
}

void makeVertex(Surface& s, const CornersOfVertices& corners, Index v) {
  constexpr int kMost = 64;
  Vec3f normals[kMost];
  const auto vertexAt = [&](Index c) { return s.triangles.corner(c); };
  int n = 0;
  bool isSteep = false, isTooMany = false;
  // Each neighbour once as start and once as end of the link, unless it is open. Their bits are
  // mixed: the ends of two fans may well have the same sum.
  Index sum = 0;
  const auto mixed = [](Index x) { return (x * 0x9e3779b1u) ^ ((x * 0x9e3779b1u) >> 16); };
  const Vec3f p = s.position[v];
  for (const Index c : corners.of(v)) {
    const Index a = vertexAt(nextCorner(c)), b = vertexAt(previousCorner(c));
    sum += mixed(a) - mixed(b);
    const Vec3f normal = cross(s.position[a] - p, s.position[b] - p);
    const float l = length(normal);
    if (!(l > 0)) {
      isSteep = true;
      continue;
    }
    if (n == kMost) {
      isTooMany = true;
    } else {
      normals[n++] = normal * (1 / l);
    }
  }
  if (sum != 0) setFlag(s.flags[v], kBorder);
  float leastCosine = -1;
  if (n > 0 && !isTooMany) s.axis[v] = base::Direction(commonAxis(normals, n, leastCosine));
  if (isSteep || leastCosine < kSteepCosine) setFlag(s.flags[v], kSteep);
  if (bendBothWays(normals, n)) setFlag(s.flags[v], kBent);
  if (leastCosine >= kLeastCosine) return;
  s.axis[v] = {};
  setFlag(s.flags[v], kNarrow);
  for (const Index c : corners.of(v)) {
    setFlag(s.flags[vertexAt(nextCorner(c))], kNarrow);
    setFlag(s.flags[vertexAt(previousCorner(c))], kNarrow);
  }
}

// For each vertex the face nearest to it of those at reference vertices that it stands for.
void findFaces(Surface& s, const ReferenceMesh& reference, std::span<const Index> standsFor,
               base::Job& job) {
  std::vector<float> nearest(s.position.size(), kFar);
  for (Index f = 0; f < reference.faceCount(); ++f) {
    job.pollCancelled(f);
    for (const Index r : reference.vertices(f)) {
      const Index v = standsFor[r];
      const float d = squaredLength(reference.positions()[r] - s.position[v]);
      if (d < nearest[v]) nearest[v] = d, s.face[v] = f;
    }
  }
  job.forRanges(s.position.size(), [&](std::size_t begin, std::size_t end) {
    for (Index v = static_cast<Index>(begin); v < end; ++v) {
      if (s.face[v] == kNone || !s.hasAxis(v)) continue;
      const Index f = reference.locate(s.face[v], s.position[v], s.axis[v].vector());
      if (f != kNone) s.face[v] = f;
    }
  });
}

void findChords(Surface& s, base::Job& job) {
  s.chords.clear();
  const std::vector<Index> some = base::collectIf(job, s.triangles.size(), [&](Index t) {
    const auto v = s.triangles[t].vertices;
    return s.isOnLine(v[0]) + s.isOnLine(v[1]) + s.isOnLine(v[2]) > 1;
  });
  std::vector<std::pair<std::uint64_t, Index>> edges;  // with their triangles' regions
  for (const Index t : some) {
    const auto v = s.triangles[t].vertices;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = v[i], b = v[(i + 1) % 3];
      if (s.isOnLine(a) && s.isOnLine(b) && commonPlanes(s.planesOf(a), s.planesOf(b)) > 0) {
        edges.emplace_back(Surface::chordKey(a, b), s.region[t]);
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (edges[i] == edges[i + 1]) s.chords.push_back(edges[i].first);
  }
}

// A vertex, and a corner at it.
using CornerAt = std::pair<Index, Index>;

// The vertices at triangles of several regions, rising, with all their corners.
std::vector<CornerAt> cornersOnLines(const Surface& s, base::Job& job) {
  std::vector<Index> regionAt;  // one of them
  base::resizeLarge(regionAt, s.position.size(), job, kNone);
  base::AtomicBits several(s.position.size());
  job.forRanges(s.triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (const Index v : s.triangles[t].vertices) {
        const std::atomic_ref<Index> at(regionAt[v]);
        Index other = at.load(std::memory_order_relaxed);
        if (other == kNone) {
          at.compare_exchange_strong(other, s.region[t], std::memory_order_relaxed);
        }
        if (other != kNone && other != s.region[t]) several.add(v);
      }
    }
  });
  const auto vertexAt = [&](Index c) { return s.triangles.corner(c); };
  const std::vector<Index> some = base::collectIf(
      job, 3 * s.triangles.size(), [&](Index c) { return several.has(vertexAt(c)); });
  std::vector<CornerAt> corners;
  corners.reserve(some.size());
  for (const Index c : some) corners.emplace_back(vertexAt(c), c);
  std::sort(corners.begin(), corners.end());
  return corners;
}

// How many edges of lines there are at a vertex, given its corners. Each is met twice, once in each
// of its triangles, where its region is not that of the other one: so the changes of region around
// the vertex are counted, by neighbours.
int linesAt(const Surface& s, std::span<const CornerAt> around) {
  int lines = 0;
  for (const auto& [v, c] : around) {
    const Index next = s.triangles.corner(nextCorner(c));
    for (const auto& [w, d] : around) {
      const Index before = s.triangles.corner(previousCorner(d));
      lines += before == next && s.region[c / 3] != s.region[d / 3];
    }
  }
  return lines;
}

}  // namespace

Surface makeSurface(base::SharedArray<Vec3f> positions, base::TriangleArray triangles,
                    base::Job& job) {
  Surface s;
  const std::size_t count = positions.size();
  s.position = std::move(positions);
  s.triangles = std::move(triangles);
  base::resizeLarge(s.axis, count, job);
  base::resizeLarge(s.flags, count, job);
  forCornerRanges(count, s.triangles, job, [&](const CornersOfVertices& corners) {
    for (Index v = corners.begin(); v < corners.end(); ++v) makeVertex(s, corners, v);
  });
  return s;
}

Index faceOf(const Surface& s, const ReferenceMesh& reference, Index vertex) {
  if (!s.isWhole) return s.face[vertex];
  const Index c = reference.cornerOf(vertex);
  return c == kNone ? kNone : c / 3;
}

void locateAll(Surface& s, const ReferenceMesh& reference, std::span<const Index> standsFor,
               base::Job& job) {
  s.isWhole = standsFor.empty();
  base::resizeLarge(s.owner, reference.positions().size(), job, kNone);
  if (s.isWhole) {
    job.forRanges(s.owner.size(), [&](std::size_t begin, std::size_t end) {
      for (Index v = static_cast<Index>(begin); v < end; ++v) s.owner[v] = faceOf(s, reference, v);
    });
    return;
  }
  s.face.assign(s.position.size(), kNone);
  s.source.resize(s.position.size());
  std::iota(s.source.begin(), s.source.end(), 0);
  const CornersOfVertices corners(s.position.size(), s.triangles, job);
  job.forRanges(s.owner.size(), [&](std::size_t begin, std::size_t end) {
    for (Index r = static_cast<Index>(begin); r < end; ++r) {
      float nearest = kFar;
      for (const Index c : corners.of(standsFor[r])) {
        const float d2 = squaredDistanceToTriangle(reference.positions()[r], s.corner(c / 3, 0),
                                                   s.corner(c / 3, 1), s.corner(c / 3, 2));
        if (d2 < nearest) nearest = d2, s.owner[r] = c / 3;
      }
    }
  });
  findFaces(s, reference, standsFor, job);
}

void setRegions(Surface& s, Regions regions, base::Job& job) {
  s.region = std::move(regions.ofTriangle);
  s.mayHold = std::move(regions.mayHold), s.planesOf = std::move(regions.planesOf);
  s.planeNormals = std::move(regions.normals);
  s.lineKind.assign(s.position.size(), LineKind::Off);
  s.lineStep.clear(), s.into.clear(), s.intoPlane.clear();
  const std::vector<CornerAt> corners = cornersOnLines(s, job);
  std::size_t done = 0;
  for (auto begin = corners.begin(); begin != corners.end();) {
    job.pollCancelled(done++);
    const Index v = begin->first;
    const auto end = std::find_if(begin, corners.end(), [&](auto& c) { return c.first != v; });
    const int lines = linesAt(s, {begin, end});
    const bool isSimple = lines == 2 && s.planesOf(v)[1] == kNone && (s.flags[v] & kBorder) == 0;
    if (lines > 0) s.lineKind[v] = isSimple ? LineKind::On : LineKind::End;
    begin = end;
  }
  findChords(s, job);
}

void apply(Surface& s, const ReferenceMesh& reference, const std::vector<SurfaceChanges>& changes,
           const std::vector<std::uint8_t>& dead, base::Job& job) {
  base::RankedBits leftTriangles(s.triangles.size()), leftVertices(s.position.size());
  for (std::size_t t = 0; t < dead.size(); ++t) {
    if (dead[t] == 0) leftTriangles.add(t);
  }
  leftTriangles.count();
  std::vector<Triangle> triangles;
  std::vector<Index> regions;
  base::reserveLarge(triangles, leftTriangles.size());
  regions.reserve(s.hasLines() ? leftTriangles.size() : 0);
  leftTriangles.forAll([&](std::size_t t) {
    job.pollCancelled(t);
    const std::size_t n = triangles.size();
    if (s.hasLines()) regions.push_back(s.region[t]);
    if (!s.changeOf.empty()) s.changeOf[n] = s.changeOf[t];
    triangles.push_back(s.triangles[t]);
  });
  for (const SurfaceChanges& some : changes) {
    for (const auto& [t, now] : some.changed) triangles[leftTriangles.rank(t)] = now;
  }
  for (const Triangle& t : triangles) {
    for (const Index v : t.vertices) leftVertices.add(v);
  }
  leftVertices.count();
  const std::size_t count = leftVertices.size();
  std::vector<Vec3f> positions;
  std::vector<Index> sources, faces;
  base::resizeLarge(positions, count, job);
  base::resizeLarge(sources, count, job), base::resizeLarge(faces, count, job);
  Index n = 0;
  leftVertices.forAll([&](std::size_t at) {
    job.pollCancelled(at);
    const auto v = static_cast<Index>(at);
    positions[n] = s.position[v], sources[n] = s.sourceOf(v), faces[n] = faceOf(s, reference, v);
    s.axis[n] = s.axis[v], s.flags[n] = s.flags[v];
    if (s.hasLines()) s.lineKind[n] = s.lineKind[v];
    if (!s.lineStep.empty()) s.lineStep[n] = s.lineStep[v];
    ++n;
  });
  for (const SurfaceChanges& some : changes) {
    for (const auto& [v, to, face] : some.moved) {
      if (!leftVertices.has(v)) continue;
      const Index now = leftVertices.rank(v);
      positions[now] = to, faces[now] = face;
      if (!s.isOnLine(now)) sources[now] = kNone;
    }
  }
  for (Triangle& t : triangles) {
    for (Index& v : t.vertices) v = leftVertices.rank(v);
  }
  job.forRanges(s.owner.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      if (s.owner[r] != kNone) s.owner[r] = leftTriangles.rank(s.owner[r]);
    }
  });
  base::shrinkTo(s.axis, count), base::shrinkTo(s.flags, count);
  if (s.hasLines()) base::shrinkTo(s.lineKind, count);
  if (!s.lineStep.empty()) base::shrinkTo(s.lineStep, count);
  if (!s.changeOf.empty()) base::shrinkTo(s.changeOf, triangles.size());
  s.position = std::move(positions), s.triangles = std::move(triangles);
  s.region = std::move(regions);
  s.source = std::move(sources), s.face = std::move(faces);
  s.isWhole = false;
}

}  // namespace tufa::reduce
