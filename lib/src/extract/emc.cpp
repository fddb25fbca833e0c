#include "extract/emc.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/huge_pages.h"
#include "extract/cell_walk.h"
#include "extract/cube_mesher.h"
#include "extract/loop_crossings.h"
#include "extract/marching_cubes.h"
#include "extract/place_crossings.h"
#include "extract/sharp_loops.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using uniform::SurfaceBlock;

namespace {

// Shares of the time that stages took on the sample volumes.
constexpr double kVerticesEnd = 0.65, kFeaturesEnd = 0.8, kTrianglesEnd = 0.95;
class SharpMesher {
 public:
  SharpMesher(const grid::Volume& volume, const CubeCells& cells, double sharpAngle, base::Job& job)
      : volume_(volume),
        cells_(cells),
        topology_(cells.topology),
        leastCosine_(std::cos(sharpAngle * std::numbers::pi / 180)),
        job_(job) {}

  Mesh run() {
    job_.beginStage("vertices", kVerticesEnd);
    base::resizeLarge(mesh_.positions, cells_.edgeCount, job_);
    base::resizeLarge(mesh_.normals, cells_.edgeCount, job_);
    placeCrossings(volume_, topology_, cells_.edges, mesh_, job_);
    job_.beginStage("features", kFeaturesEnd);
    features_ = findSharpLoops(volume_, cells_, mesh_, leastCosine_, job_);
    countTriangles();
    number();
    job_.beginStage("triangles", kTrianglesEnd);
    base::resizeLarge(mesh_.triangles, triangleCount_, job_);
    emit();
    if (topology_.openEdges > 0) dropUnused(mesh_, job_);
    return std::move(mesh_);
  }

  [[nodiscard]] std::size_t featureCells() const { return featureCells_; }

 private:
  struct BlockCounts {
    std::uint64_t firstTriangle = 0;
    std::uint64_t firstVertex = 0;  ///< features first, then the means of other loops
    std::uint32_t triangles = 0;
    std::uint32_t centres = 0;
  };

  void countTriangles() {
    counts_.resize(topology_.blocks.size());
    job_.forRanges(counts_.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const CellFeatures* features = features_.cells.data() + topology_.blocks[i].firstVertex;
        cells_.forCells(topology_.blocks[i], [&](int, int, CaseCode code) {
          countTriangles(caseOf(code), *features++, counts_[i]);
        });
      }
    });
  }

  static void countTriangles(const CubeCase& cell, const CellFeatures& features, BlockCounts& own) {
    own.centres += hasCentre(cell, features) ? 1 : 0;
    for (int i = 0; i < cell.count; ++i) own.triangles += isKept(cell, i, features) ? 1 : 0;
    for (int loop = 0; loop < cell.loopCount; ++loop) {
      if (features.has(loop)) forLoop(cell, loop, [&](int) { ++own.triangles; });
    }
  }

  void number() {
    std::uint64_t vertices = cells_.edgeCount;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      job_.pollCancelled(i);
      BlockCounts& own = counts_[i];
      own.firstVertex = vertices;
      own.firstTriangle = triangleCount_;
      vertices += features_.blocks[i].size() + own.centres;
      triangleCount_ += own.triangles;
      featureCells_ += features_.blocks[i].size();
    }
    uniform::requireIndexable(vertices);
    base::resizeLarge(mesh_.positions, vertices, job_);
    base::resizeLarge(mesh_.normals, vertices, job_);
    job_.forRanges(counts_.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        std::size_t vertex = counts_[i].firstVertex;
        for (std::uint32_t cell = 0; cell < block.cellCount; ++cell) {
          features_.cells[block.firstVertex + cell].first += static_cast<VertexIndex>(vertex);
        }
        for (const LoopFeature& feature : features_.blocks[i]) {
          mesh_.positions[vertex] = feature.vertex.position;
          mesh_.normals[vertex++] = feature.vertex.normal;
        }
      }
    });
  }

  void emit() {
    // Of each block, where its next triangle and its next mean go.
    std::vector<std::pair<Triangle*, VertexIndex>> next(counts_.size());
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] = {mesh_.triangles.data() + counts_[i].firstTriangle,
                 static_cast<VertexIndex>(counts_[i].firstVertex + features_.blocks[i].size())};
    }
    walkCells(cells_, job_, [&](const WalkedCell& cell) {
      auto& [triangle, centre] = next[cell.place.block];
      emitCell(cell, triangle, centre);
    });
  }

  void emitCell(const WalkedCell& cell, Triangle*& triangle, VertexIndex& centre) {
    const CubeCase& chosen = cell.cubeCase();
    const CellFeatures& features = features_.cells[cell.place.cell];
    const bool mirrored = volume_.affine.mirrored();
    const auto add = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
      *triangle++ = mirrored ? Triangle(a, c, b) : Triangle(a, b, c);
    };
    const auto at = [&](int edge) {
      return edge < kEdges ? cell.table[cell.tablePlace() + kEdgeOffsets[edge]] : centre;
    };
    for (int t = 0; t < chosen.count; ++t) {
      const auto& [a, b, c] = chosen.triangles[t];
      if (isKept(chosen, t, features)) add(at(a), at(b), at(c));
    }
    for (int loop = 0; features.parts != 0 && loop < chosen.loopCount; ++loop) {
      if (!features.has(loop)) continue;
      forLoop(chosen, loop, [&](int edge) {
        const auto beyond = featureBeyond(cell, edge);
        add(at(edge), beyond ? *beyond : at(chosen.next[edge]), features.of(loop));
      });
    }
    if (hasCentre(chosen, features)) {
      placeCentre(chosen.aroundCentre[0], cell.tablePlace(), cell.table, centre++, mesh_);
    }
  }

  // The feature of the loop that shares the arc from a crossing to the next, if the edge between
  // the two features is to take the place of the arc's.
  [[nodiscard]] std::optional<VertexIndex> featureBeyond(const WalkedCell& cell, int edge) const {
    const LoopBeyond beyond = loopBeyond(cells_, cell, edge);
    if (beyond.loop < 0) return std::nullopt;
    const CellFeatures& features = features_.cells[beyond.place.cell];
    if (!features.has(beyond.loop)) return std::nullopt;
    const CubeCase& chosen = cell.cubeCase();
    if (ownsBothArcs(chosen, chosen.loopOf[edge], beyond.face) &&
        ownsBothArcs(caseOf(cells_.codes[beyond.place.cell]), beyond.loop, beyond.face ^ 1)) {
      return std::nullopt;
    }
    return features.of(beyond.loop);
  }

  // Whether one loop has all four edges of a face.
  static bool ownsBothArcs(const CubeCase& cell, int loop, int face) {
    for (const int edge : uniform::kFaceEdges[face]) {
      if (cell.next[edge] < 0 || cell.loopOf[edge] != loop) return false;
    }
    return true;
  }

  const grid::Volume& volume_;
  const CubeCells& cells_;
  const uniform::CellTopology& topology_;
  double leastCosine_;
  base::Job& job_;
  Mesh mesh_;
  SharpLoops features_;              ///< numbers in the mesh, once they are given
  std::vector<BlockCounts> counts_;  ///< of each surface block
  std::uint64_t triangleCount_ = 0;
  std::size_t featureCells_ = 0;
};

}  // namespace

Mesh meshSharp(const grid::Volume& volume, double sharpAngle, const ContourOptions& options,
               ContourReport& report, base::Job& job) {
  const CubeCells cells =
      chooseCases(volume, marchingCubesRule(options.ambiguity), options.cap, job);
  report = uniform::reportOf(volume, cells.topology);
  SharpMesher mesher(volume, cells, sharpAngle, job);
  Mesh mesh = mesher.run();
  report.creaseCells = mesher.featureCells();
  return mesh;
}

}  // namespace tufa::extraction
