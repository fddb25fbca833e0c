#include "chunks/seamed_cut.h"

#include <algorithm>

#include "chunks/stitch.h"

namespace tufa::chunks {
namespace {

// One side of a curve.
ChunkSeam sideOf(const SeamCurve& curve, bool above, const Seams& seams, const SeamLines& lines,
                 const std::vector<VertexIndex>& seamVertices, const cut::Cut& cut) {
  ChunkSeam side;
  for (const SeamIndex arc : curve.arcs) {
    side.tiles.push_back(cut.vertexOf[above ? seams.arcs[arc].above : seams.arcs[arc].below]);
    side.line.push_back(seamVertices[lines[arc]]);
  }
  if (curve.begin != kNoSeam) side.begin = seamVertices[curve.begin];
  if (curve.end != kNoSeam) side.end = seamVertices[curve.end];
  side.closed = curve.closed;
  if (above) {
    std::reverse(side.tiles.begin(), side.tiles.end());
    std::reverse(side.line.begin(), side.line.end());
    std::swap(side.begin, side.end);
  }
  return side;
}

// Which vertices of the chunks a strip may join.
class Joints {
 public:
  // Strips see their own side of a curve only. An edge between two vertices that both lie beside
  // several curves might come up in several strips.
  Joints(const Mesh& mesh, const std::vector<VertexIndex>& beside, std::size_t vertexCount)
      : curves_(vertexCount, 0) {
    for (const VertexIndex vertex : beside) curves_[vertex] = kBeside;
    const auto add = [&](VertexIndex a, VertexIndex b) {
      if (curves_[a] != 0 && curves_[b] != 0) edges_.emplace_back(std::min(a, b), std::max(a, b));
    };
    for (const Quad& quad : mesh.quads) {
      const auto& v = quad.vertices;
      for (int i = 0; i < 4; ++i) add(v[i], v[(i + 1) % 4]);
      add(v[0], v[2]);
      add(v[1], v[3]);  // mending may turn it
    }
    for (const Triangle& triangle : mesh.triangles) {
      const auto& v = triangle.vertices;
      for (int i = 0; i < 3; ++i) add(v[i], v[(i + 1) % 3]);
    }
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

// Adds the strips on both sides of all seams, where the chunk is to be made.
void addStrips(const Seams& seams, const SeamLines& lines,
               const std::vector<VertexIndex>& seamVertices, const ChunkCells& chunks,
               SeamedCut& result) {
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
      openvdb::Coord chunk = curve.chunk;
      if (!above) --chunk[curve.axis];
      if (!chunks.own.isInside(chunk)) continue;
      sides.push_back(
          {&curve, above, sideOf(curve, above, seams, lines, seamVertices, result.cut)});
      joints.addCurve(sides.back().seam);
    }
  }
  for (const auto& [curve, above, seam] : sides) {
    const bool several = std::any_of(curve->arcs.begin(), curve->arcs.end(),
                                     [&](SeamIndex arc) { return !seams.arcs[arc].single; });
    for (const StripTriangle& strip :
         stitch(seam, several, mesh.positions, mesh.normals,
                [&](VertexIndex a, VertexIndex b) { return joints.mayJoin(a, b); })) {
      const std::size_t arc = above ? curve->arcs.size() - 1 - strip.arc : strip.arc;
      mesh.triangles.push_back(strip.triangle);
      result.strips.push_back({static_cast<std::uint32_t>(curve - seams.curves.data()), above});
      result.made.triangleSources.push_back(seams.arcs[curve->arcs[arc]].quad);
    }
  }
}

// Quads whose diagonal is an edge of a strip are split along the other one.
void partDiagonals(SeamedCut& result) {
  Mesh& mesh = result.made.mesh;
  std::vector<std::pair<VertexIndex, VertexIndex>> edges;
  const auto edge = [](VertexIndex a, VertexIndex b) {
    return std::pair(std::min(a, b), std::max(a, b));
  };
  for (std::size_t i = mesh.triangles.size() - result.strips.size(); i < mesh.triangles.size();
       ++i) {
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

void keepInChunks(const std::vector<openvdb::Coord>& vertexCells, const ChunkCells& chunks,
                  const base::Affine& affine, SeamedCut& mesh) {
  for (std::size_t i = 0; i < vertexCells.size(); ++i) {
    const VertexIndex vertex = mesh.cut.vertexOf[i];
    if (mesh.cut.clusters[vertex].level == 0) continue;
    Position& position = mesh.made.mesh.positions[vertex];
    const openvdb::Coord& cell = vertexCells[i];
    const openvdb::Vec3d at = affine.latticePoint(position, cell);
    const openvdb::Vec3d kept = chunks.keepInside(at, cell, cell);
    if (kept != at) position = affine.position(cell, kept[0], kept[1], kept[2]);
  }
}

SeamedCut meshWithSeams(const forest::Forest& forest, cut::Cut cut, const Seams& seams,
                        const SeamLines& lines, const std::vector<openvdb::Coord>& vertexCells,
                        const ChunkCells& chunks, const base::Affine& affine, base::Job& job) {
  SeamedCut result;
  result.clusterCount = static_cast<VertexIndex>(cut.clusters.size());
  const std::size_t baseCount = cut.vertexOf.size();
  std::vector<VertexIndex> vertexOf(seams.vertices.size());
  for (SeamIndex i = 0; i < lines.size(); ++i) {
    if (lines[i] != i) continue;
    vertexOf[i] = static_cast<VertexIndex>(cut.clusters.size());
    cut.clusters.push_back({0, 0, 0, static_cast<std::uint32_t>(baseCount + i)});
    result.seamOf.push_back(i);
  }
  for (const SeamIndex line : lines) cut.vertexOf.push_back(vertexOf[line]);
  for (const VertexIndex base : seams.beside) result.altered.push_back(cut.vertexOf[base]);
  std::sort(result.altered.begin(), result.altered.end());
  result.altered.erase(std::unique(result.altered.begin(), result.altered.end()),
                       result.altered.end());
  for (auto i = result.clusterCount; i < cut.clusters.size(); ++i) result.altered.push_back(i);
  result.cut = std::move(cut);
  result.made = polygons::meshCut(forest, result.cut, seams.mesh, seams.quads, affine, job);
  keepInChunks(vertexCells, chunks, affine, result);
  addStrips(seams, lines, vertexOf, chunks, result);
  partDiagonals(result);
  return result;
}

}  // namespace tufa::chunks
