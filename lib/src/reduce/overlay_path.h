#pragma once

#include <algorithm>
#include <array>

#include "reduce/corners.h"
#include "reduce/triangles.h"

namespace tufa::reduce {

// How edges and faces of the reference run over the triangles of a mesh. Functions here see the
// mesh as a type M: mesh(t, i) is the position of a triangle's corner i, mesh.vertex(t, i) its
// vertex, and mesh.across(t, i) the triangle across the edge opposite it, or kNone. If it has a
// function mesh.mayPass(t, from, to), ways from one triangle to another lead only over those for
// which that is true, as it is of the neighbours of both.

/// More than any squared distance.
inline constexpr float kFar2 = 1e30f;

/// A way over triangles.
struct OverlayPath {
  static constexpr int kMost = 48;  ///< triangles: a face may lie over a fan of needles
  std::array<Index, kMost> triangles;
  int count = 0;
  float largest2 = 0;  ///< the largest squared distance of the segment from an edge on the way
};

/// The squared distance of a segment from a triangle's edge, the one opposite its corner i.
template <class M>
float squaredDistanceToEdge(const M& mesh, const std::array<Vec3f, 2>& pq, Index t, int i) {
  return squaredDistanceOfSegments(pq[0], pq[1], mesh(t, (i + 1) % 3), mesh(t, (i + 2) % 3));
}

/// As findOverlayPath(), for ways of one step or two, which most are. Edges that do not lead to
/// `to` are not measured.
template <class M>
bool findShortPath(const M& mesh, const std::array<Vec3f, 2>& pq, Index from, Index to,
                   float limit2, OverlayPath& path) {
  Index next[3];
  for (int i = 0; i < 3; ++i) {
    next[i] = mesh.across(from, i);
    if (next[i] != to) continue;
    next[i] = kNone;
    const float d2 = squaredDistanceToEdge(mesh, pq, from, i);
    if (d2 > limit2) continue;
    path.count = 2, path.largest2 = d2;
    path.triangles[0] = from, path.triangles[1] = to;
    return true;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; next[i] != kNone && j < 3; ++j) {
      if (mesh.across(next[i], j) != to) continue;
      const float first2 = squaredDistanceToEdge(mesh, pq, from, i);
      if (first2 > limit2) break;
      const float d2 = std::max(first2, squaredDistanceToEdge(mesh, pq, next[i], j));
      if (d2 > limit2) continue;
      path.count = 3, path.largest2 = d2;
      path.triangles[0] = from, path.triangles[1] = next[i], path.triangles[2] = to;
      return true;
    }
  }
  return false;
}

/// A way from triangle `from`, which is near p, to `to`, which is near q, each step across an edge
/// that the segment from p to q comes within the limit of. Then the segment falls into pieces, each
/// with both ends within the limit of one triangle, whatever way it is: so the one of fewest
/// triangles will do. Returns false if there is none among the triangles looked at first.
template <class M>
bool findOverlayPath(const M& mesh, const std::array<Vec3f, 2>& pq, Index from, Index to,
                     float limit2, OverlayPath& path) {
  if (from == to) {
    path.count = 1;
    path.largest2 = 0;
    path.triangles[0] = from;
    return true;
  }
  if (findShortPath(mesh, pq, from, to, limit2, path)) return true;
  struct Step {
    Index triangle;
    int before, depth;
    float largest2;
  };
  constexpr int kLooked = 256;
  Step steps[kLooked];
  int count = 1;
  steps[0] = {from, -1, 1, 0};
  const auto arrive = [&](int last, float largest2) {
    path.count = steps[last].depth + 1;
    path.largest2 = largest2;
    path.triangles[static_cast<std::size_t>(path.count - 1)] = to;
    for (int at = last, i = path.count - 2; at >= 0; at = steps[at].before, --i) {
      path.triangles[static_cast<std::size_t>(i)] = steps[at].triangle;
    }
    return true;
  };
  for (int k = 0; k < count; ++k) {
    const Step step = steps[k];
    if (step.depth == OverlayPath::kMost) break;
    Index next[3];
    for (int i = 0; i < 3; ++i) {
      next[i] = mesh.across(step.triangle, i);
      if (next[i] != to) continue;
      const float d2 = squaredDistanceToEdge(mesh, pq, step.triangle, i);
      if (d2 <= limit2) return arrive(k, std::max(step.largest2, d2));
      next[i] = kNone;
    }
    if (step.depth + 1 == OverlayPath::kMost) continue;
    for (int i = 0; i < 3; ++i) {
      if (next[i] == kNone || count == kLooked) continue;
      if constexpr (requires { mesh.mayPass(next[i], from, to); }) {
        if (!mesh.mayPass(next[i], from, to)) continue;
      }
      const auto isNext = [&](const Step& seen) { return seen.triangle == next[i]; };
      if (std::any_of(steps, steps + count, isNext)) continue;
      const float d2 = squaredDistanceToEdge(mesh, pq, step.triangle, i);
      if (d2 <= limit2) steps[count++] = {next[i], k, step.depth + 1, std::max(step.largest2, d2)};
    }
  }
  return false;
}

/// A face of the reference with the owners of its corners.
struct OwnedFace {
  std::array<Vec3f, 3> corners;
  std::array<Index, 3> vertices;
  std::array<Index, 3> owners;

  [[nodiscard]] bool hasOneOwner() const {
    return owners[0] == owners[1] && owners[1] == owners[2];
  }
};

/// The triangles that the edges of a face pass in turn. Steps back and forth are left out.
struct OverlayLoop {
  static constexpr int kMost = 3 * OverlayPath::kMost;
  std::array<Index, kMost> triangles;
  int count = 0;

  void add(Index triangle) {
    if (count >= 2 && at(count - 2) == triangle) {
      --count;
    } else {
      triangles[static_cast<std::size_t>(count++)] = triangle;
    }
  }
  /// Leaves out steps back and forth where the loop closes.
  void close() {
    int first = 0;
    while (count - first >= 3 && at(first + 1) == at(count - 1)) ++first, --count;
    beginAt(first);
  }
  [[nodiscard]] Index at(int i) const { return triangles[static_cast<std::size_t>(i)]; }
  void beginAt(int first) {
    std::copy(triangles.begin() + first, triangles.begin() + count, triangles.begin());
    count -= first;
  }
};

template <class M>
bool hasVertex(const M& mesh, Index triangle, Index vertex) {
  for (int k = 0; k < 3; ++k) {
    if (mesh.vertex(triangle, k) == vertex) return true;
  }
  return false;
}

/// A loop, or its arc, that goes round a vertex and is pulled over it. With the triangles that take
/// its place it takes some steps from triangle to triangle around the vertex, all the way round
/// once or more; the first one leads from one triangle to another.
struct OverlayTurn {
  Index vertex;
  Index from, to;
  int steps;
};

/// Pulls a loop over a vertex, if it gets shorter: its first `arc` triangles are around the vertex,
/// and those on the other side take their place. onTurn: see overlayBound2().
template <class M, class OnTurn>
bool pullOver(const M& mesh, Index vertex, int arc, const OnTurn& onTurn, OverlayLoop& loop) {
  std::array<Index, OverlayLoop::kMost> others;
  int count = 0;
  for (Index before = loop.at(arc - 2), t = loop.at(arc - 1); t != loop.at(0);) {
    Index next = kNone;
    for (int i = 0; i < 3; ++i) {
      if (mesh.vertex(t, i) != vertex && mesh.across(t, i) != before) next = mesh.across(t, i);
    }
    if (next == kNone || count + 2 >= arc) return false;
    before = t, t = next;
    others[static_cast<std::size_t>(count++)] = t;
  }
  onTurn(OverlayTurn{vertex, loop.at(0), loop.at(1), arc - 1 + count});
  OverlayLoop pulled;
  for (int i = arc - 1; i < loop.count; ++i) pulled.add(loop.at(i));
  for (int i = count; i-- > 0;) pulled.add(others[static_cast<std::size_t>(i)]);  // from loop.at(0)
  pulled.close();
  loop = pulled;
  return true;
}

/// Pulls a loop together over vertices that are near a face. Returns the largest squared distance
/// of one of them from it, or kFar2 if that does not succeed within the limit.
///
/// Where the loop crosses an edge is near a point of the face, and so is the vertex. The loop's
/// arc around the vertex and the vertex make triangles, each inside one triangle of the mesh, that
/// go to triangles in the face corner by corner; then the loop crosses all edges at the vertex.
template <class M, class OnTurn>
float pullTogether(const M& mesh, const std::array<Vec3f, 3>& face, float limit2,
                   const OnTurn& onTurn, OverlayLoop& loop) {
  float worst = 0;
  const auto isNear = [&](Index t, int k) {
    const float d2 = squaredDistanceToTriangle(mesh(t, k), face[0], face[1], face[2]);
    if (d2 <= limit2) worst = std::max(worst, d2);
    return d2 <= limit2;
  };
  const auto pullOnce = [&] {
    for (int turn = 0; turn < loop.count; ++turn) {
      std::rotate(loop.triangles.begin(), loop.triangles.begin() + 1,
                  loop.triangles.begin() + loop.count);
      for (int k = 0; k < 3; ++k) {
        const Index first = loop.at(0), vertex = mesh.vertex(first, k);
        int arc = 1;
        while (arc < loop.count && hasVertex(mesh, loop.at(arc), vertex)) ++arc;
        if (arc == loop.count) {
          if (!isNear(first, k)) continue;
          onTurn(OverlayTurn{vertex, first, loop.at(1), arc});
          return loop.count = 0, true;
        }
        if (arc > 2 && isNear(first, k) && pullOver(mesh, vertex, arc, onTurn, loop)) {
          return true;
        }
      }
    }
    return false;
  };
  while (loop.count > 2) {
    if (!pullOnce()) return kFar2;
  }
  return worst;
}

/// A bound of the squared distance between a face of the reference and the mesh where the face lies
/// over it, from the ways of its edges; more than the limit, at most kFar2, if there is none. The
/// ways make a loop, which must fall together or be pulled together over vertices near the face.
/// The distances of the corners from their owners are not in it.
/// findPath(a, b, path) finds the way from corner a to corner b, as findOverlayPath() does;
/// onTurn(turn) learns of each vertex that the loop is pulled over.
template <class M, class FindPath, class OnTurn>
float overlayBound2(const M& mesh, const OwnedFace& face, float limit2, const FindPath& findPath,
                    const OnTurn& onTurn) {
  float worst = 0;
  OverlayLoop loop;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    // The same way from both of the edge's faces.
    const bool isTurned = face.vertices[i] > face.vertices[j];
    const std::size_t a = isTurned ? j : i, b = isTurned ? i : j;
    OverlayPath path;
    if (!findPath(a, b, path)) return kFar2;
    worst = std::max(worst, path.largest2);
    for (int k = 0; k + 1 < path.count; ++k) {  // the last one begins the next edge
      loop.add(path.triangles[static_cast<std::size_t>(isTurned ? path.count - 1 - k : k)]);
    }
  }
  loop.close();
  return std::max(worst, pullTogether(mesh, face.corners, limit2, onTurn, loop));
}
template <class M, class OnTurn>
float overlayBound2(const M& mesh, const OwnedFace& face, float limit2, const OnTurn& onTurn) {
  const auto findPath = [&](std::size_t a, std::size_t b, OverlayPath& path) {
    return findOverlayPath(mesh, {face.corners[a], face.corners[b]}, face.owners[a], face.owners[b],
                           limit2, path);
  };
  return overlayBound2(mesh, face, limit2, findPath, onTurn);
}
template <class M>
float overlayBound2(const M& mesh, const OwnedFace& face, float limit2) {
  return overlayBound2(mesh, face, limit2, [](const OverlayTurn&) {});
}

/// The squared distance of a face's farthest corner from that of its owners where it is least: a
/// bound of the way from the face to the mesh, not of the way back.
template <class M>
float wholeFace2(const M& mesh, const OwnedFace& face) {
  float best = kFar2;
  for (const Index t : face.owners) {
    float worst = 0;
    for (const Vec3f& p : face.corners) {
      worst = std::max(worst, squaredDistanceToTriangle(p, mesh(t, 0), mesh(t, 1), mesh(t, 2)));
    }
    best = std::min(best, worst);
  }
  return best;
}

}  // namespace tufa::reduce
