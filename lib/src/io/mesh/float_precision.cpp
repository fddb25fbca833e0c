#include "io/mesh/float_precision.h"

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "base/number_text.h"
#include "base/single_precision.h"
#include "base/vec3.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

/// Whether a triangle turns over, or loses its area, where its corners are rounded.
bool turnsOver(const std::array<Vec3, 3>& exact, const std::array<Vec3, 3>& rounded) {
  const auto normalOf = [](const std::array<Vec3, 3>& p) {
    return (p[1] - p[0]).cross(p[2] - p[0]);
  };
  const Vec3 before = normalOf(exact), after = normalOf(rounded);
  return before.squaredLength() > 0 && !(before.dot(after) > 0);
}

}  // namespace

bool needsDoublePrecision(const Mesh& mesh) {
  return !std::all_of(mesh.positions.begin(), mesh.positions.end(),
                      [](const Position& p) { return p == base::toSingle(p); });
}

Position floatOrigin(const Mesh& mesh) {
  if (!needsDoublePrecision(mesh)) return {0, 0, 0};
  const Bounds bounds = boundsOf(mesh);
  return base::toSingle({0.5 * (bounds.least.x + bounds.greatest.x),
                         0.5 * (bounds.least.y + bounds.greatest.y),
                         0.5 * (bounds.least.z + bounds.greatest.z)});
}

void requireFloatRange(const Mesh& mesh) {
  // Of half the range, so that differences are in it.
  constexpr double kFarthest = std::numeric_limits<float>::max() / 2;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Position& p = mesh.positions[v];
    const double farthest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    if (farthest <= kFarthest) continue;
    throw Error(ErrorCode::LimitExceeded,
                "vertex " + std::to_string(v) + " lies " + base::numberText(farthest) +
                    " from the origin, farther than single precision reaches; write .ply, .obj or "
                    ".off, which have double precision");
  }
}

double requireFloatsEnough(const Mesh& mesh, const Position& origin, std::string_view format) {
  constexpr double kThin = 0.01, kMost = 0.05;
  if (!needsDoublePrecision(mesh)) return 0;
  const auto rounded = [&](const Position& p) {
    const Vec3 relative = Vec3(p) - Vec3(origin);
    return Vec3(base::toSingle({relative[0], relative[1], relative[2]}));
  };
  double largest = 0, edges = 0;
  for (const Position& p : mesh.positions) {
    largest = std::max(largest, (Vec3(p) - Vec3(origin) - rounded(p)).length());
  }
  std::size_t turned = 0, count = 0;
  for (const Triangle& t : triangulate(mesh)) {
    std::array<Vec3, 3> exact, after;
    for (std::size_t i = 0; i < 3; ++i) {
      const Position& p = mesh.positions.at(t.vertices[i]);
      exact[i] = Vec3(p), after[i] = rounded(p);
    }
    edges += (exact[1] - exact[0]).length();
    ++count;
    turned += turnsOver(exact, after) ? 1 : 0;
  }
  const double mean = count == 0 ? 0 : edges / static_cast<double>(count);
  if (largest <= (turned == 0 ? kMost : kThin) * mean) return largest;
  const std::string turns = turned == 0 ? ""
                                        : ", and turns " + std::to_string(turned) +
                                              (turned == 1 ? " triangle over" : " triangles over");
  throw Error(ErrorCode::LimitExceeded,
              std::string(format) + " has single precision, which moves vertices by up to " +
                  base::shortNumberText(largest) + " where edges are " +
                  base::shortNumberText(mean) + " long in the mean" + turns +
                  ": write .ply, .obj or .off, which have double precision, or move the "
                  "volume to the origin");
}

}  // namespace tufa::io
