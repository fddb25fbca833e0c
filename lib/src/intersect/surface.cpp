#include "intersect/surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/sort_unique.h"

namespace tufa::intersect {

using base::Box;

std::vector<PolygonIndex> polygonsOf(const std::vector<PolygonPair>& pairs) {
  std::vector<PolygonIndex> polygons;
  for (const auto& [a, b] : pairs) {
    polygons.push_back(a);
    polygons.push_back(b);
  }
  return polygons;
}

std::vector<PolygonIndex> distinctPolygonsOf(const std::vector<PolygonPair>& pairs) {
  std::vector<PolygonIndex> polygons = polygonsOf(pairs);
  base::sortUnique(polygons);
  return polygons;
}

void renewPairsOf(const std::vector<PolygonIndex>& changed, const ClosePairs& found,
                  ClosePairs& known) {
  const auto isChanged = [&](PolygonIndex polygon) {
    return std::binary_search(changed.begin(), changed.end(), polygon);
  };
  const auto renew = [&](const std::vector<PolygonPair>& fresh, std::vector<PolygonPair>& pairs) {
    std::erase_if(pairs, [&](const PolygonPair& p) { return isChanged(p.a) || isChanged(p.b); });
    std::vector<PolygonPair> all;
    all.reserve(pairs.size() + fresh.size());
    std::merge(pairs.begin(), pairs.end(), fresh.begin(), fresh.end(), std::back_inserter(all));
    pairs = std::move(all);
  };
  renew(found.intersecting, known.intersecting);
  renew(found.close, known.close);
}

std::vector<VertexIndex> verticesOf(const Mesh& mesh, const std::vector<PolygonIndex>& polygons) {
  std::vector<VertexIndex> vertices;
  for (const PolygonIndex polygon : polygons) {
    if (polygon < mesh.quads.size()) {
      const auto& v = mesh.quads[polygon].vertices;
      vertices.insert(vertices.end(), v.begin(), v.end());
    } else {
      const auto& v = mesh.triangles[polygon - mesh.quads.size()].vertices;
      vertices.insert(vertices.end(), v.begin(), v.end());
    }
  }
  base::sortUnique(vertices);
  return vertices;
}

Surface::Surface(Mesh& mesh, base::Job& job) : mesh_(mesh) {
  runs_.resize((size() + kRun - 1) / kRun);
  sections_.resize((runs_.size() + kSection - 1) / kSection, Box::empty());
  job.forRanges(sections_.size(), 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t section = begin; section < end; ++section) {
      for (std::size_t run = section * kSection; run < sectionEnd(section); ++run) {
        Box all = Box::empty();
        for (PolygonIndex p = runBegin(run); p < runEnd(run); ++p) all.add(box(p));
        runs_[run] = all;
        sections_[section].add(all);
      }
    }
  });
}

Box Surface::box(PolygonIndex polygon) const {
  Box box = Box::empty();
  for (const VertexIndex vertex : corners(polygon)) {
    const Position& p = mesh_.positions[vertex];
    box.add(Vec3(p));
  }
  return box;
}

void Surface::turn(PolygonIndex quad) {
  auto& v = mesh_.quads[quad].vertices;
  std::rotate(v.begin(), v.begin() + 1, v.end());
}

void Surface::fan(PolygonIndex quad, const Position& centre) {
  const auto v = mesh_.quads[quad].vertices;
  const auto middle = static_cast<VertexIndex>(mesh_.positions.size());
  mesh_.positions.push_back(centre);
  if (!mesh_.normals.empty()) {
    Vec3 sum(0);
    for (const VertexIndex vertex : v) {
      const Normal& n = mesh_.normals[vertex];
      sum += Vec3(n);
    }
    sum.normalize();
    mesh_.normals.emplace_back(static_cast<float>(sum[0]), static_cast<float>(sum[1]),
                               static_cast<float>(sum[2]));
  }
  for (int i = 0; i < 4; ++i) {
    mesh_.triangles.emplace_back(middle, v[i], v[(i + 1) % 4]);
    update(static_cast<PolygonIndex>(size() - 1));
  }
  mesh_.quads[quad].vertices.fill(v[0]);
  fanned_ = true;
}

void Surface::update(PolygonIndex polygon) {
  const std::size_t run = polygon / kRun;
  if (run >= runs_.size()) runs_.resize(run + 1, Box::empty());
  const std::size_t section = run / kSection;
  if (section >= sections_.size()) sections_.resize(section + 1, Box::empty());
  const Box own = box(polygon);
  runs_[run].add(own);
  sections_[section].add(own);
}

void Surface::finish() {
  if (!fanned_) return;
  std::erase_if(mesh_.quads, [](const Quad& q) { return q.vertices[0] == q.vertices[1]; });
}

std::vector<PolygonIndex> findIntersecting(Mesh& mesh, base::Job& job) {
  const Surface surface(mesh, job);
  std::vector<PolygonIndex> all(surface.size());
  std::iota(all.begin(), all.end(), 0);
  return polygonsOf(findPairs(surface, all, job));
}

}  // namespace tufa::intersect
