#include "extract/emc.h"

#include <optional>

#include "extract/fan_mesher.h"
#include "extract/marching_cubes.h"
#include "extract/place_crossings.h"

namespace tufa::extraction {

namespace {

class SharpMesher {
 public:
  SharpMesher(const grid::Volume& volume, const CubeCells& cells, double sharpAngle, base::Job& job)
      : volume_(volume), cells_(cells), leastCosine_(cosineOf(sharpAngle)), job_(job) {}

  Mesh run(ContourReport& report) {
    job_.beginStage("vertices", kVerticesEnd);
    Mesh mesh = meshOfCrossings(volume_, cells_, job_);
    job_.beginStage("features", kFeaturesEnd);
    features_ = findSharpLoops(volume_, cells_, mesh, leastCosine_, job_);
    FanMesher fans(volume_, cells_, features_, mesh, job_);
    ArcPoints none;
    const auto once = [](const WalkedCell&, int) { return 1; };
    fans.run(none, kTrianglesEnd, once, [&](const WalkedCell& cell, int edge, const auto& body) {
      const auto beyond = featureBeyond(cell, edge);
      body(beyond ? *beyond : cell.vertexAt(cell.cubeCase().next[edge]));
    });
    report.creaseCells = fans.featureCount();
    if (cells_.topology.openEdges > 0) dropUnused(mesh, job_);
    return mesh;
  }

 private:
  // Shares of the time that stages took on the sample volumes.
  static constexpr double kVerticesEnd = 0.65, kFeaturesEnd = 0.8, kTrianglesEnd = 0.95;

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
  double leastCosine_;
  base::Job& job_;
  SharpLoops features_;  ///< numbers in the mesh, once they are given
};

}  // namespace

Mesh meshSharp(const grid::Volume& volume, double sharpAngle, const ContourOptions& options,
               ContourReport& report, base::Job& job) {
  const CubeCells cells =
      chooseCases(volume, marchingCubesRule(options.ambiguity), options.cap, job);
  report = uniform::reportOf(volume, cells.topology);
  return SharpMesher(volume, cells, sharpAngle, job).run(report);
}

}  // namespace tufa::extraction
