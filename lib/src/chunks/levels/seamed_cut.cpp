#include "chunks/levels/seamed_cut.h"

#include <algorithm>
#include <array>

#include "base/polygons.h"
#include "chunks/seams/curve_side.h"
#include "chunks/seams/stitch.h"

namespace tufa::chunks {
namespace {

// Tells which vertices of the chunks a strip may join by an edge.
class Joints {
 public:
  // A strip knows its own side of a curve only. An edge between two vertices that both lie beside
  // several curves might occur in several strips, and one that the mesh has already would be used
  // twice.
  Joints(const Mesh& mesh, const std::vector<VertexIndex>& beside, std::size_t vertexCount)
      : curves_(vertexCount, 0) {
    for (const VertexIndex vertex : beside) curves_[vertex] = kBeside;
    const auto add = [&](VertexIndex a, VertexIndex b) {
      if (curves_[a] != 0 && curves_[b] != 0) edges_.emplace_back(std::min(a, b), std::max(a, b));
    };
    base::forPolygons(mesh, [&](base::PolygonIndex, base::Corners v) {
      for (std::size_t i = 0; i < v.size(); ++i) add(v[i], v[(i + 1) % v.size()]);
      if (v.size() < 4) return;
      add(v[0], v[2]);
      add(v[1], v[3]);  // the repair may flip it
    });
    std::sort(edges_.begin(), edges_.end());
  }

  void addCurve(const ChunkSeam& side) {
    for (std::size_t i = 0; i < side.tiles.size(); ++i) {
      if (i == 0 || side.tiles[i] != side.tiles[i - 1]) ++curves_[side.tiles[i]];
    }
  }
  [[nodiscard]] bool mayJoin(VertexIndex a, VertexIndex b) const {
    if (curves_[a] > kBeside + 1 && curves_[b] > kBeside + 1) return false;
    return !std::binary_search(edges_.begin(), edges_.end(),
                               std::pair(std::min(a, b), std::max(a, b)));
  }

 private:
  static constexpr int kBeside = 1;
  std::vector<int> curves_;  // of each vertex beside seams: kBeside, and one for each curve
  std::vector<std::pair<VertexIndex, VertexIndex>> edges_;  // between such vertices
};

// Starts a mesh of `cut` with the vertices of the polylines behind those of the clusters. Returns
// the mesh vertex of each seam vertex that is on a polyline.
std::vector<VertexIndex> addLines(const Seams& seams, const SeamPolylines& lines, octree::Cut cut,
                                  SeamedCut& result) {
  result.clusterCount = static_cast<VertexIndex>(cut.clusters.size());
  const std::size_t baseCount = cut.vertexOf.size();
  std::vector<VertexIndex> vertexOf(seams.vertices.size());
  for (SeamIndex i = 0; i < lines.size(); ++i) {
    if (lines[i] != i) continue;
    vertexOf[i] = static_cast<VertexIndex>(cut.clusters.size());
    cut.clusters.push_back({0, static_cast<std::uint32_t>(baseCount + i)});
    result.seamOf.push_back(i);
  }
  for (const SeamIndex line : lines) cut.vertexOf.push_back(vertexOf[line]);
  for (const VertexIndex base : seams.beside) result.altered.push_back(cut.vertexOf[base]);
  std::sort(result.altered.begin(), result.altered.end());
  result.altered.erase(std::unique(result.altered.begin(), result.altered.end()),
                       result.altered.end());
  for (auto i = result.clusterCount; i < cut.clusters.size(); ++i) result.altered.push_back(i);
  result.cut = std::move(cut);
  return vertexOf;
}

bool isSet(const SideFlags& flags, const StripPlace& place) {
  return !flags.empty() && flags[place.number()] != 0;
}

// Adds the strips on both sides of all seams in chunks to be made, except those that are kept;
// empty: none are.
void addStrips(const Seams& seams, const SeamPolylines& lines,
               const std::vector<VertexIndex>& seamVertices, const ChunkCells& chunks,
               const SideFlags& kept, SeamedCut& result) {
  // All sides are collected first: whether two vertices may be joined depends on all strips.
  struct Side {
    const SeamCurve* curve;
    bool above;
    ChunkSeam seam;
  };
  Mesh& mesh = result.made.mesh;
  Joints joints(mesh, result.altered, result.cut.clusters.size());
  std::vector<Side> sides;
  for (const SeamCurve& curve : seams.curves) {
    for (const bool above : {false, true}) {
      Coord chunk = curve.chunk;
      if (!above) --chunk[curve.axis];
      if (!chunks.own.contains(chunk)) continue;
      sides.push_back({&curve, above,
                       sideOf(
                           curve, above, seams, lines,
                           [&](VertexIndex base) { return result.cut.vertexOf[base]; },
                           [&](SeamIndex seam) { return seamVertices[seam]; })});
      joints.addCurve(sides.back().seam);
    }
  }
  for (const auto& [curve, above, seam] : sides) {
    const StripPlace place{static_cast<std::uint32_t>(curve - seams.curves.data()), above};
    if (isSet(kept, place)) continue;
    const bool asArcsRun = isSet(result.direct, place) ||
                           std::any_of(curve->arcs.begin(), curve->arcs.end(),
                                       [&](SeamIndex arc) { return !seams.arcs[arc].single; });
    for (const StripTriangle& strip :
         stitch(seam, asArcsRun, mesh.positions, mesh.normals,
                [&](VertexIndex a, VertexIndex b) { return joints.mayJoin(a, b); })) {
      const std::size_t arc = above ? curve->arcs.size() - 1 - strip.arc : strip.arc;
      mesh.triangles.push_back(strip.triangle);
      result.strips.push_back(place);
      result.made.triangleSources.push_back(seams.arcs[curve->arcs[arc]].quad);
    }
  }
}

// Marks the sides of curves on which no edge across is used more than twice by what is left of the
// strips.
SideFlags findClosed(const SeamedCut& before, const std::vector<StripLeft>& left,
                     const Seams& seams, const SeamedCut& result) {
  using Edge = std::array<std::size_t, 3>;  // of a side: cluster and seam vertex
  std::vector<Edge> edges;
  for (const StripLeft& strip : left) {
    const StripPlace& place = before.strips[strip.strip];
    if (!seams.curves[place.curve].closed) continue;
    for (int i = 0; i < 3; ++i) {
      const VertexIndex a = strip.triangle.vertices[i], b = strip.triangle.vertices[(i + 1) % 3];
      if (result.isOnSeam(a) == result.isOnSeam(b)) continue;
      edges.push_back({place.number(), std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  SideFlags closed(2 * seams.curves.size(), 1);
  for (std::size_t i = 2; i < edges.size(); ++i) {
    if (edges[i] == edges[i - 2]) closed[edges[i][0]] = 0;
  }
  return closed;
}

// Adds what is left of the strips to be kept.
void keepStrips(const SeamedCut& before, const std::vector<StripLeft>& left, const SideFlags& kept,
                SeamedCut& result) {
  const std::size_t first = before.firstStrip();
  for (const StripLeft& strip : left) {
    const StripPlace& place = before.strips[strip.strip];
    if (kept[place.number()] == 0) continue;
    result.made.mesh.triangles.push_back(strip.triangle);
    result.made.triangleSources.push_back(before.made.triangleSources[first + strip.strip]);
    result.strips.push_back(place);
  }
}

// Flips the diagonals of quads that are edges of a strip.
void partDiagonals(SeamedCut& result) {
  Mesh& mesh = result.made.mesh;
  std::vector<std::pair<VertexIndex, VertexIndex>> edges;
  const auto edge = [](VertexIndex a, VertexIndex b) {
    return std::pair(std::min(a, b), std::max(a, b));
  };
  for (std::size_t i = result.firstStrip(); i < mesh.triangles.size(); ++i) {
    const auto& v = mesh.triangles[i].vertices;
    for (int k = 0; k < 3; ++k) {
      const VertexIndex a = v[k], b = v[(k + 1) % 3];
      if (!result.isOnSeam(a) && !result.isOnSeam(b)) edges.push_back(edge(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  for (Quad& quad : mesh.quads) {
    auto& v = quad.vertices;
    if (std::binary_search(edges.begin(), edges.end(), edge(v[0], v[2]))) {
      std::rotate(v.begin(), v.begin() + 1, v.end());
    }
  }
}

}  // namespace

void keepInChunks(const std::vector<Coord>& vertexCells, const ChunkCells& chunks,
                  const grid::Affine& affine, SeamedCut& mesh) {
  for (std::size_t i = 0; i < vertexCells.size(); ++i) {
    const VertexIndex vertex = mesh.cut.vertexOf[i];
    if (mesh.cut.clusters[vertex].level == 0) continue;
    Position& position = mesh.made.mesh.positions[vertex];
    const Coord& cell = vertexCells[i];
    const Vec3 at = affine.latticePoint(position, cell);
    const Vec3 kept = chunks.keepInside(at, cell, cell);
    if (kept != at) position = affine.position(cell, kept[0], kept[1], kept[2]);
  }
}

SeamedCut meshWithSeams(const octree::ClusterForest& forest, octree::Cut cut, const Seams& seams,
                        const SeamPolylines& lines, const std::vector<Coord>& vertexCells,
                        const ChunkCells& chunks, const grid::Affine& affine, SideFlags direct,
                        base::Job& job) {
  SeamedCut result;
  result.direct = std::move(direct);
  const std::vector<VertexIndex> seamVertices = addLines(seams, lines, std::move(cut), result);
  result.made = octree::meshCut(forest, result.cut, seams.mesh, seams.quads, affine, job);
  keepInChunks(vertexCells, chunks, affine, result);
  addStrips(seams, lines, seamVertices, chunks, {}, result);
  partDiagonals(result);
  return result;
}

std::vector<StripLeft> stripsLeft(const SeamedCut& before, const octree::Cut& now) {
  std::vector<VertexIndex> numbers(before.cut.clusters.size());
  for (std::size_t i = 0; i < now.vertexOf.size(); ++i) {
    numbers[before.cut.vertexOf[i]] = now.vertexOf[i];
  }
  const std::vector<Triangle>& triangles = before.made.mesh.triangles;
  const std::size_t first = before.firstStrip();
  std::vector<StripLeft> left;
  for (std::size_t i = 0; i < before.strips.size(); ++i) {
    const auto& v = triangles[first + i].vertices;
    const VertexIndex a = numbers[v[0]], b = numbers[v[1]], c = numbers[v[2]];
    if (a != b && b != c && c != a) left.push_back({i, {a, b, c}});
  }
  return left;
}

SeamedCut withStripsOf(const SeamedCut& before, const SeamedCut& mesh, const Seams& seams,
                       const SeamPolylines& lines, const ChunkCells& chunks) {
  SeamedCut result;
  result.direct = before.direct;
  octree::Cut cut = mesh.cut;
  cut.clusters.resize(mesh.clusterCount);
  cut.vertexOf.resize(cut.vertexOf.size() - lines.size());
  const std::size_t baseCount = cut.vertexOf.size();
  const std::vector<VertexIndex> seamVertices = addLines(seams, lines, std::move(cut), result);
  for (const VertexIndex vertex : mesh.altered) {
    if (!mesh.isOnSeam(vertex)) result.altered.push_back(vertex);
  }
  result.made = mesh.made;
  Mesh& own = result.made.mesh;
  own.triangles.resize(mesh.firstStrip());
  result.made.triangleSources.resize(own.triangles.size());
  own.positions.resize(mesh.clusterCount);
  own.normals.resize(mesh.clusterCount);
  for (const SeamIndex seam : result.seamOf) {
    own.positions.push_back(seams.mesh.positions[baseCount + seam]);
    own.normals.push_back(seams.mesh.normals[baseCount + seam]);
  }
  const std::vector<StripLeft> left = stripsLeft(before, result.cut);
  const SideFlags kept = findClosed(before, left, seams, result);
  keepStrips(before, left, kept, result);
  addStrips(seams, lines, seamVertices, chunks, kept, result);
  partDiagonals(result);
  return result;
}

}  // namespace tufa::chunks
