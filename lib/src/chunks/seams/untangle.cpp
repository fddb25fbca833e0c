#include "chunks/seams/untangle.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "chunks/seams/face_segments.h"
#include "uniform/case_table.h"

namespace tufa::chunks {
namespace {

// A segment leads back if the cosines of the turns at both its ends are less than this.
constexpr double kBack = -0.5;

// The vertices of a curve in order.
std::vector<SeamIndex> verticesOf(const SeamCurve& curve) {
  std::vector<SeamIndex> vertices;
  if (curve.begin != kNoSeam) vertices.push_back(curve.begin);
  vertices.insert(vertices.end(), curve.arcs.begin(), curve.arcs.end());
  if (curve.end != kNoSeam) vertices.push_back(curve.end);
  if (curve.closed) vertices.push_back(curve.arcs.front());
  return vertices;
}

using Point = std::array<double, 2>;

// Whether the segment from b to c leads back along those before and behind it.
bool leadsBack(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto cosine = [](const Point& from, const Point& at, const Point& to) {
    const double x = at[0] - from[0], y = at[1] - from[1], u = to[0] - at[0], v = to[1] - at[1];
    return (x * u + y * v) / std::max(std::hypot(x, y) * std::hypot(u, v), 1e-30);
  };
  return cosine(a, b, c) < kBack && cosine(b, c, d) < kBack;
}

// The segments of curves on one face, counted from its first vertex.
std::vector<FaceSegment> segmentsOf(const Seams& seams, const std::vector<SeamCurve>& curves,
                                    std::size_t begin, std::size_t end) {
  const auto axes = uniform::otherAxes(curves[begin].axis);
  const Coord& corner = seams.vertices[curves[begin].arcs.front()].cell;
  const auto place = [&](SeamIndex index) -> std::array<double, 2> {
    const SeamVertex& vertex = seams.vertices[index];
    const Vec3 at = Vec3(vertex.cell - corner) + vertex.offset;
    return {at[axes[0]], at[axes[1]]};
  };
  std::vector<FaceSegment> segments;
  for (std::size_t line = begin; line < end; ++line) {
    const std::vector<SeamIndex> vertices = verticesOf(curves[line]);
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      segments.push_back(
          {line, vertices[i - 1], vertices[i], place(vertices[i - 1]), place(vertices[i])});
    }
  }
  return segments;
}

}  // namespace

void untangle(const std::vector<Vec3>& fallbacks, Seams& seams) {
  const std::vector<SeamCurve>& curves = seams.curves;
  forFaces(curves, [&](std::size_t begin, std::size_t end) {
    for (bool any = true; any;) {
      any = false;
      std::vector<FaceSegment> segments = segmentsOf(seams, curves, begin, end);
      std::vector<std::size_t> back;
      for (std::size_t i = 1; i + 1 < segments.size(); ++i) {
        const FaceSegment &before = segments[i - 1], &at = segments[i], &behind = segments[i + 1];
        if (before.line != at.line || at.line != behind.line) continue;
        if (leadsBack(before.a, at.a, at.b, behind.b)) back.insert(back.end(), {at.from, at.to});
      }
      const auto move = [&](std::size_t vertex) {
        // A point on a chunk edge lies on several faces, not all of which every chunk has; it
        // stays.
        if (vertex >= seams.arcs.size()) return;
        Vec3& offset = seams.vertices[vertex].offset;
        any |= offset != fallbacks[vertex];
        offset = fallbacks[vertex];
      };
      for (const std::size_t vertex : back) move(vertex);
      forCrossings(segments, [&](std::size_t i, std::size_t j) {
        for (const std::size_t k : {i, j}) {
          move(segments[k].from);
          move(segments[k].to);
        }
      });
    }
  });
}

}  // namespace tufa::chunks
