#include "chunks/chain/lattice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/vec3.h"
#include "base/vertex_welder.h"
#include "chunks/chain/mixed_forms.h"

namespace tufa::chunks {
namespace {

// Steps along the edges of a chunk: 16 bits, less some for vertices that rounding moved out of it.
constexpr double kMostSteps = 65535 - 64;

bool hasArea(const std::vector<Position>& positions, const Triangle& t) {
  const Vec3 a(positions[t.vertices[0]]);
  const Vec3 normal =
      (Vec3(positions[t.vertices[1]]) - a).cross(Vec3(positions[t.vertices[2]]) - a);
  return normal.squaredLength() > 0;
}

// The places of a level's vertices, in steps; none if they do not tell its triangles apart.
std::vector<Position> placesOf(const ChainLevel& level, double step, base::Job& job) {
  std::vector<Position> places, different;
  base::VertexWelder welder(different);
  std::vector<VertexIndex> firstAt;  // for each of `different`
  const auto place = [step](double x) { return std::round(x / step) + 0.0; };
  for (VertexIndex v = 0; v < level.positions.size(); ++v) {
    job.pollCancelled(v);
    const Position& p = level.positions[v];
    places.push_back({place(p.x), place(p.y), place(p.z)});
    const VertexIndex at = welder.indexOf(places.back());
    if (at == firstAt.size()) {
      firstAt.push_back(v);
    } else if (level.into[firstAt[at]] != v) {
      return {};  // one that goes into the other is never drawn with it
    }
  }
  for (std::size_t n = 0; n < level.triangles.size(); ++n) {
    job.pollCancelled(n);
    const Triangle& t = level.triangles[n];
    for (const Triangle& form : {t, changed(level, t)}) {
      if (!isGone(form) && hasArea(level.positions, form) && !hasArea(places, form)) return {};
    }
  }
  return places;
}

}  // namespace

double latticeStep(const grid::Transform& transform, int chunkSize, double scale) {
  const auto rows = transform.matrix();
  double extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double along = 0;
    for (std::size_t row = 0; row < 3; ++row) along += std::abs(rows[row][axis]);
    extent = std::max(extent, along * chunkSize);
  }
  return std::exp2(std::ceil(std::log2(extent * scale / kMostSteps))) / scale;
}

bool moveToLattice(std::vector<ChainLevel>& levels, double step, base::Job& job) {
  std::vector<std::vector<Position>> places;
  for (const ChainLevel& level : levels) {
    places.push_back(placesOf(level, step, job));
    if (places.back().size() != level.positions.size()) return false;
  }
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (Position& p : places[i]) p = {p.x * step, p.y * step, p.z * step};
    levels[i].positions = std::move(places[i]);
  }
  return true;
}

}  // namespace tufa::chunks
