#include "chunks/levels/strip_validation.h"

#include <algorithm>

#include "chunks/seams/curve_side.h"
#include "chunks/seams/stitch.h"
#include "intersect/surface.h"

namespace tufa::chunks {
namespace {

// A small mesh of some polygons of a larger one, its vertices in the same order.
class Extract {
 public:
  std::vector<std::array<VertexIndex, 3>> triangles;
  std::vector<std::array<VertexIndex, 4>> quads;

  // The mesh; `positions` are those of the larger one.
  [[nodiscard]] Mesh mesh(const std::vector<Position>& positions) {
    const auto take = [&](const auto& polygons) {
      for (const auto& v : polygons) vertices_.insert(vertices_.end(), v.begin(), v.end());
    };
    take(triangles);
    take(quads);
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    Mesh mesh;
    for (const VertexIndex vertex : vertices_) mesh.positions.push_back(positions[vertex]);
    for (const auto& v : quads) {
      mesh.quads.emplace_back(numberOf(v[0]), numberOf(v[1]), numberOf(v[2]), numberOf(v[3]));
    }
    for (const auto& v : triangles) {
      mesh.triangles.emplace_back(numberOf(v[0]), numberOf(v[1]), numberOf(v[2]));
    }
    return mesh;
  }

 private:
  [[nodiscard]] VertexIndex numberOf(VertexIndex vertex) const {
    const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), vertex);
    return static_cast<VertexIndex>(found - vertices_.begin());
  }

  std::vector<VertexIndex> vertices_;
};

}  // namespace

StripValidation::StripValidation(const Mesh& before, const Seams& seams,
                                 const std::vector<Coord>& vertexCells, const ChunkCells& chunks,
                                 const grid::Affine& affine, base::Job& job)
    : quads_(before.quads), seams_(seams), job_(job), positions_(before.positions) {
  for (const SeamVertex& vertex : seams.vertices) {
    positions_.push_back(
        affine.position(vertex.cell, vertex.offset[0], vertex.offset[1], vertex.offset[2]));
  }
  std::vector<std::uint8_t> beside(before.positions.size(), 0);
  for (const Arc& arc : seams.arcs) beside[arc.below] = beside[arc.above] = 1;
  for (std::uint32_t i = 0; i < before.quads.size(); ++i) {
    const auto& v = before.quads[i].vertices;
    if (std::none_of(v.begin(), v.end(), [&](VertexIndex k) { return beside[k] != 0; })) continue;
    const Coord chunk = chunks.chunkOf(vertexCells[v[0]]);
    const bool whole = std::all_of(
        v.begin(), v.end(), [&](VertexIndex k) { return chunks.chunkOf(vertexCells[k]) == chunk; });
    if (!whole) continue;
    for (const VertexIndex vertex : v) {
      if (beside[vertex] != 0) quadsAt_.emplace_back(vertex, i);
    }
  }
  std::sort(quadsAt_.begin(), quadsAt_.end());
}

FaceValidation StripValidation::ofFace(std::size_t begin, std::size_t end, bool far) const {
  return [this, begin, end, far, seen = std::array<Seen, 2>()](const SeamPolylines& lines) mutable {
    LineFaults faults;
    for (const bool above : {false, true}) {
      lookAtSide(begin, end, above, lines, seen[above ? 1 : 0], faults);
    }
    if (far) {
      faults.folded.insert(faults.folded.end(), faults.meeting.begin(), faults.meeting.end());
      faults.meeting.clear();
    }
    for (std::vector<SeamIndex>* found : {&faults.meeting, &faults.folded}) {
      std::sort(found->begin(), found->end());
      found->erase(std::unique(found->begin(), found->end()), found->end());
    }
    return faults;
  };
}

// Builds the strips on one side of a face and the uniform quads beside them as a small mesh, and
// searches it for folded and intersecting triangles. From call to call only new triangles are
// searched: polylines are refined in few places.
void StripValidation::lookAtSide(std::size_t begin, std::size_t end, bool above,
                                 const SeamPolylines& lines, Seen& seen, LineFaults& faults) const {
  // Seam vertices are numbered behind the uniform ones.
  const auto baseCount = static_cast<VertexIndex>(positions_.size() - seams_.vertices.size());
  const auto note = [&](const std::array<VertexIndex, 3>& triangle, std::vector<SeamIndex>& found) {
    for (const VertexIndex vertex : triangle) {
      if (vertex >= baseCount) found.push_back(vertex - baseCount);
    }
  };
  Extract extract;
  std::vector<std::uint32_t> quads;
  for (std::size_t i = begin; i < end; ++i) {
    const SeamCurve& curve = seams_.curves[i];
    const ChunkSeam side = sideOf(
        curve, above, seams_, lines, [](VertexIndex vertex) { return vertex; },
        [&](SeamIndex seam) { return baseCount + seam; });
    const bool several = std::any_of(curve.arcs.begin(), curve.arcs.end(),
                                     [&](SeamIndex arc) { return !seams_.arcs[arc].single; });
    for (const StripTriangle& strip : stitch(side, several, positions_, seams_.mesh.normals)) {
      extract.triangles.push_back(strip.triangle.vertices);
      if (isFolded(strip.triangle, positions_, seams_.mesh.normals))
        note(strip.triangle.vertices, faults.folded);
    }
    for (const VertexIndex tile : side.tiles) {
      auto at = std::lower_bound(quadsAt_.begin(), quadsAt_.end(), std::pair(tile, 0U));
      for (; at != quadsAt_.end() && at->first == tile; ++at) quads.push_back(at->second);
    }
  }
  std::sort(quads.begin(), quads.end());
  quads.erase(std::unique(quads.begin(), quads.end()), quads.end());
  for (const std::uint32_t quad : quads) extract.quads.push_back(quads_[quad].vertices);
  Mesh mesh = extract.mesh(positions_);
  // A triangle of the validation before intersects what it did then; only new ones are searched.
  std::vector<intersect::PolygonIndex> candidates;
  const auto first = static_cast<intersect::PolygonIndex>(mesh.quads.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (std::binary_search(seen.triangles.begin(), seen.triangles.end(), extract.triangles[i])) {
      continue;
    }
    candidates.push_back(first + static_cast<intersect::PolygonIndex>(i));
  }
  seen.triangles = extract.triangles;
  std::sort(seen.triangles.begin(), seen.triangles.end());
  std::erase_if(seen.met, [&](const auto& pair) {
    const auto isGone = [&](const StripCorners& triangle) {
      return !std::binary_search(seen.triangles.begin(), seen.triangles.end(), triangle);
    };
    return isGone(pair.first) || isGone(pair.second);
  });
  for (const auto& [a, b] :
       intersect::findPairs(intersect::Surface(mesh, job_), candidates, job_)) {
    const StripCorners& later = extract.triangles[b - first];
    seen.met.emplace_back(a < first ? later : extract.triangles[a - first], later);
  }
  for (const auto& [a, b] : seen.met) {
    note(a, faults.meeting);
    note(b, faults.meeting);
  }
}

}  // namespace tufa::chunks
