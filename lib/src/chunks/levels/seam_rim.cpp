#include "chunks/levels/seam_rim.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "chunks/seams/polyline.h"

namespace tufa::chunks {
namespace {

// The arcs of a curve in an order in which its parts (quadrants, if it is closed) are contiguous,
// and the part of each.
struct Parts {
  std::vector<std::size_t> order;
  std::vector<std::uint32_t> of;
};

// Empty for a closed curve in one cell.
Parts partsOf(const Seams& seams, const SeamCurve& curve) {
  const std::size_t count = curve.arcs.size();
  Parts parts;
  if (!curve.closed) {
    parts.order.resize(count);
    std::iota(parts.order.begin(), parts.order.end(), std::size_t{0});
    parts.of.assign(count, 0);
    return parts;
  }
  const std::vector<std::uint8_t> quadrants = quadrantsOf(seams, curve);
  if (quadrants.empty()) return parts;
  std::size_t start = 0;
  while (quadrants[start] == quadrants[(start + count - 1) % count]) ++start;
  std::uint32_t part = 0;
  for (std::size_t i = start; i < start + count; ++i) {
    if (i > start && quadrants[i % count] != quadrants[(i - 1) % count]) ++part;
    parts.order.push_back(i % count);
    parts.of.push_back(part);
  }
  return parts;
}

// Adds the stretches of the clusters on one side of a curve.
void addSide(const SeamedCut& mesh, const Seams& seams, std::uint32_t number, const Parts& parts,
             bool above, refine::Rim& rim, std::vector<std::uint8_t>& fixed) {
  const SeamCurve& curve = seams.curves[number];
  const auto clusterAt = [&](std::size_t place) {
    const Arc& arc = seams.arcs[curve.arcs[place]];
    return mesh.cut.vertexOf[above ? arc.above : arc.below];
  };
  const bool single = std::all_of(curve.arcs.begin(), curve.arcs.end(),
                                  [&](SeamIndex arc) { return seams.arcs[arc].single; });
  if (!single || parts.order.empty()) {
    for (std::size_t i = 0; i < curve.arcs.size(); ++i) fixed[clusterAt(i)] = 1;
    return;
  }
  std::map<VertexIndex, refine::Rim::Stretch> stretches;
  for (std::uint32_t i = 0; i < parts.order.size(); ++i) {
    const VertexIndex cluster = clusterAt(parts.order[i]);
    const auto [found, fresh] = stretches.try_emplace(cluster);
    refine::Rim::Stretch& stretch = found->second;
    if (fresh) {
      stretch = {number, parts.of[i], i, i};
    } else if (stretch.last + 1 == i && stretch.part == parts.of[i]) {
      stretch.last = i;
    } else {
      fixed[cluster] = 1;
    }
  }
  for (const auto& [cluster, stretch] : stretches) rim.add(cluster, stretch);
}

}  // namespace

refine::Rim rimOf(const SeamedCut& mesh, const Seams& seams, std::vector<std::uint8_t>& fixed) {
  refine::Rim rim;
  for (std::uint32_t i = 0; i < seams.curves.size(); ++i) {
    const Parts parts = partsOf(seams, seams.curves[i]);
    addSide(mesh, seams, i, parts, false, rim, fixed);
    addSide(mesh, seams, i, parts, true, rim, fixed);
  }
  for (VertexIndex i = mesh.clusterCount; i < fixed.size(); ++i) fixed[i] = 1;
  return rim;
}

void fixEars(const SeamedCut& mesh, std::vector<std::uint8_t>& fixed) {
  const std::vector<Triangle>& triangles = mesh.made.mesh.triangles;
  for (std::size_t i = mesh.firstStrip(); i < triangles.size(); ++i) {
    const auto& v = triangles[i].vertices;
    if (std::any_of(v.begin(), v.end(), [&](VertexIndex k) { return mesh.isOnSeam(k); })) continue;
    for (const VertexIndex k : v) fixed[k] = 1;
  }
}

}  // namespace tufa::chunks
