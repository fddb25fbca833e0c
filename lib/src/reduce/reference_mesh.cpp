#include "reduce/reference_mesh.h"

#include "reduce/star.h"

#include <utility>

namespace tufa::reduce {
namespace {

constexpr std::size_t kGrain = 16384;
constexpr float kRoughCosine = 0.65f;

}  // namespace

ReferenceMesh::ReferenceMesh(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                             std::vector<float> scales, base::Job& job)
    : positions_(positions.begin(), positions.end()),
      faces_(triangles.size()),
      cornerOf_(positions.size(), kNone),
      rough_(positions.size(), 0),
      scales_(std::move(scales)) {
  const std::vector<Index> opposite = oppositeCorners(positions.size(), triangles, job);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      faces_[t].vertex[i] = triangles[t].vertices[i];
      faces_[t].opposite[i] = opposite[3 * t + i];
      cornerOf_[faces_[t].vertex[i]] = static_cast<Index>(3 * t + i);
    }
  }
  markRough(job);
}

void ReferenceMesh::markRough(base::Job& job) {
  std::vector<Vec3f> normals(faces_.size());
  job.forRanges(faces_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto p = cornersOf(static_cast<Index>(f));
      normals[f] = unit(cross(p[1] - p[0], p[2] - p[0]));
    }
  });
  job.forRanges(positions_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    constexpr int kMost = 64;
    Vec3f normalsAround[kMost];
    for (std::size_t v = begin; v < end; ++v) {
      int n = 0;
      const Index first = cornerOf_[v];
      if (first == kNone) continue;
      Index c = first;
      do {
        normalsAround[n++] = normals[c / 3];
        c = around(c);
      } while (c != first && c != kNone && n < kMost);
      float leastCosine;
      static_cast<void>(commonAxis(normalsAround, n, leastCosine));
      rough_[v] = c == kNone || leastCosine < kRoughCosine ? kRough : 0;
    }
  });
}

void ReferenceMesh::hold(std::span<const Index> faces, float radius) {
  std::vector<Index> seenFrom(positions_.size(), kNone), reached;
  std::vector<std::uint8_t> isNew(positions_.size(), 0);
  for (const Index face : faces) {
    const auto corners = cornersOf(face);
    const Vec3f middle = (corners[0] + corners[1] + corners[2]) * (1.0f / 3);
    reached.clear();
    const auto reach = [&](Index f) {
      for (const Index v : faces_[f].vertex) {
        if (seenFrom[v] == face) continue;
        seenFrom[v] = face;
        reached.push_back(v);
      }
      return true;
    };
    reach(face);
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const Index v = reached[i];
      isNew[v] = 1;
      if (squaredLength(positions_[v] - middle) <= radius * radius) allAround(v, reach);
    }
  }
  if (!isScaled()) scales_.assign(positions_.size(), 1);
  for (std::size_t v = 0; v < isNew.size(); ++v) {
    if (isNew[v] == 0) continue;
    rough_[v] |= kHeld;
    scales_[v] = 0;
  }
}

void ReferenceMesh::releaseAll() {
  for (std::uint8_t& flags : rough_) flags &= kRough;
}

Index ReferenceMesh::locate(Index start, Vec3f p, Vec3f axis, int steps) const {
  Index face = start;
  for (int step = 0; step < steps && face != kNone; ++step) {
    Vec3f q[3];
    for (std::size_t i = 0; i < 3; ++i) q[i] = corner(face, i) - p;
    int out = -1;
    float worst = 0;
    for (int i = 0; i < 3; ++i) {
      const float side = dot(cross(q[(i + 1) % 3], q[(i + 2) % 3]), axis);
      if (side < worst) worst = side, out = i;
    }
    if (out < 0) return dot(cross(q[1] - q[0], q[2] - q[0]), axis) > 0 ? face : kNone;
    const Index c = faces_[face].opposite[static_cast<std::size_t>(out)];
    face = c == kNone ? kNone : c / 3;
  }
  return kNone;
}

}  // namespace tufa::reduce
