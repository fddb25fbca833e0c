#include "fit/sample_mesh.h"

#include <tufa/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/box.h"
#include "base/number_text.h"

namespace tufa::fit {

// Scenes have numbers up to 1e12, and radii from 1e-12 on. A blob's radius is 0.004 to 3 diagonals.
Frame frameOf(const Mesh& mesh, const std::vector<Triangle>& triangles) {
  constexpr double kFarthest = 1e10, kShortest = 1e-9;
  base::Box box = base::Box::empty();
  for (const Triangle& triangle : triangles) {
    for (const VertexIndex v : triangle.vertices) {
      const Vec3 p(mesh.positions[v]);
      if (!p.isFinite()) {
        throw Error(ErrorCode::InvalidArgument,
                    "vertex " + std::to_string(v) + " of the mesh is not finite; repair it first");
      }
      box.add(p);
    }
  }
  Frame frame;
  if (triangles.empty()) return frame;
  frame.middle = box.centre();
  frame.diagonal = box.size().length();
  double farthest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, -box.lower[axis], box.upper[axis]});
  }
  if (farthest > kFarthest || frame.diagonal < kShortest) {
    throw Error(ErrorCode::InvalidArgument,
                "the mesh's diagonal is " + base::numberText(frame.diagonal) +
                    " and its farthest coordinate " + base::numberText(farthest) +
                    ": scenes can describe it from a diagonal of " + base::numberText(kShortest) +
                    " on and up to coordinates of " + base::numberText(kFarthest) +
                    "; scale it first");
  }
  return frame;
}

double volumeOf(const Mesh& mesh, const std::vector<Triangle>& triangles, const Frame& frame) {
  constexpr double kThickness = 1e-3;
  double volume = 0, area = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = frame.toUnit(Vec3(mesh.positions[t.vertices[0]])),
               b = frame.toUnit(Vec3(mesh.positions[t.vertices[1]])),
               c = frame.toUnit(Vec3(mesh.positions[t.vertices[2]]));
    volume += a.dot(b.cross(c)) / 6;
    area += (b - a).cross(c - a).length() / 2;
  }
  if (volume < -kThickness * area) {
    throw Error(ErrorCode::InvalidArgument,
                "the mesh faces inward: its volume is negative; tufa repair turns closed meshes");
  }
  return std::max(volume, kThickness * area);
}

// Those in a triangle by the sequence of Roberts (2018).
std::vector<Sample> sampleMesh(const Mesh& mesh, const std::vector<Triangle>& triangles,
                               const Frame& frame, std::size_t count) {
  std::vector<double> areaBefore{0};
  const auto cornersOf = [&](const Triangle& t) {
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = frame.toUnit(Vec3(mesh.positions[t.vertices[i]]));
    }
    return corners;
  };
  for (const Triangle& t : triangles) {
    const auto p = cornersOf(t);
    areaBefore.push_back(areaBefore.back() + (p[1] - p[0]).cross(p[2] - p[0]).length());
  }
  if (!(frame.diagonal > 0) || !(areaBefore.back() > 0)) {
    throw Error(ErrorCode::InvalidArgument, "the mesh has no area to take samples of");
  }
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const auto next =
        std::upper_bound(areaBefore.begin() + 1, areaBefore.end(), at * areaBefore.back());
    const auto t = std::min<std::size_t>(next - areaBefore.begin(), triangles.size()) - 1;
    const auto p = cornersOf(triangles[t]);
    Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (!normal.normalize(0)) continue;
    const double number = static_cast<double>(i);
    double u = std::fmod(0.5 + number * 0.7548776662466927, 1);
    double v = std::fmod(0.5 + number * 0.5698402909980532, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    samples.push_back({p[0] + (p[1] - p[0]) * u + (p[2] - p[0]) * v, normal});
  }
  return samples;
}

}  // namespace tufa::fit
