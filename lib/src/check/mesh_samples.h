#pragma once

#include <tufa/check.h>
#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "base/job.h"
#include "check/sum_ranges.h"
#include "check/triangle_soup.h"

namespace tufa::checks {

inline constexpr std::size_t kSampleGrain = 1024;

/// Throws Error(InvalidArgument) for fewer samples along an edge than its ends, and for so many
/// that a triangle has half a million.
inline void requireSamples(int perEdge) {
  constexpr int kMost = 1000;
  if (perEdge >= 2 && perEdge <= kMost) return;
  throw Error(ErrorCode::InvalidArgument, "samplesPerEdge is " + std::to_string(perEdge) +
                                              "; it must be from 2 to " + std::to_string(kMost));
}

/// Running totals over samples.
struct Tally {
  std::size_t samples = 0;
  double largest = 0;
  double sum = 0;
  double squares = 0;

  void add(double distance) {
    ++samples;
    largest = std::max(largest, distance);
    sum += distance;
    squares += distance * distance;
  }
  Tally& operator+=(const Tally& other) {
    samples += other.samples;
    largest = std::max(largest, other.largest);
    sum += other.sum;
    squares += other.squares;
    return *this;
  }
  [[nodiscard]] DistanceSummary summary() const {
    if (samples == 0) return {};
    const auto count = static_cast<double>(samples);
    return {samples, largest, sum / count, std::sqrt(squares / count)};
  }
};

/// Measures at the vertices that triangles have, each once. `newMeasure` makes a function of a
/// point of voxel space for one thread.
template <class NewMeasure>
Tally measureVertices(const TriangleSoup& soup, base::Job& job, const NewMeasure& newMeasure) {
  const std::vector<VertexIndex> vertices = soup.usedVertices();
  return sumRanges<Tally>(job, vertices.size(), kSampleGrain,
                          [&](std::size_t begin, std::size_t end) {
                            Tally part;
                            auto measure = newMeasure();
                            for (std::size_t i = begin; i < end; ++i)
                              part.add(measure(soup.point(vertices[i])));
                            return part;
                          });
}

/// Measures at the centre of each triangle, and on a lattice of `perEdge` points along an edge,
/// without the corners.
template <class NewMeasure>
Tally measureTriangles(const TriangleSoup& soup, int perEdge, base::Job& job,
                       const NewMeasure& newMeasure) {
  const auto sample = [&](const Triangle& triangle, const auto& add) {
    const Vec3& a = soup.point(triangle.vertices[0]);
    const Vec3& b = soup.point(triangle.vertices[1]);
    const Vec3& c = soup.point(triangle.vertices[2]);
    add((a + b + c) / 3);
    const int steps = perEdge - 1;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        if (i == steps || j == steps || i + j == 0) continue;
        add(a + (b - a) * (1.0 * i / steps) + (c - a) * (1.0 * j / steps));
      }
    }
  };
  return sumRanges<Tally>(
      job, soup.triangles().size(), kSampleGrain, [&](std::size_t begin, std::size_t end) {
        Tally part;
        auto measure = newMeasure();
        for (std::size_t t = begin; t < end; ++t) {
          sample(soup.triangles()[t], [&](const Vec3& point) { part.add(measure(point)); });
        }
        return part;
      });
}

/// Measures from points to the mesh. `visit(i, distance)` is told each distance, on any thread.
template <class Visit>
Tally measureToMesh(const TriangleSoup& soup, const std::vector<Vec3>& points, base::Job& job,
                    const Visit& visit) {
  return sumRanges<Tally>(job, points.size(), kSampleGrain,
                          [&](std::size_t begin, std::size_t end) {
                            Tally part;
                            std::uint32_t hint = Bvh::kNone;
                            for (std::size_t i = begin; i < end; ++i) {
                              const double distance = soup.distance(points[i], hint);
                              visit(i, distance);
                              part.add(distance);
                            }
                            return part;
                          });
}

}  // namespace tufa::checks
