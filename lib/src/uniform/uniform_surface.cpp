#include "uniform/uniform_surface.h"

#include <tufa/error.h>

#include <limits>
#include <string>
#include <utility>

#include "uniform/block_ranges.h"
#include "uniform/place_vertices.h"
#include "uniform/quads.h"
#include "uniform/sample_balls.h"
#include "uniform/snap_to_creases.h"

namespace tufa::uniform {
namespace {

CellTopology checkedTopology(const grid::Volume& volume, const ContourOptions& options,
                             base::Job& job) {
  CellTopology topology =
      buildCellTopology(volume.blocks, volume.scale, options.ambiguity, options.cap, job);
  requireIndexable(topology.vertexCount);
  requireFaces(2 * topology.quadCount, options.uniform ? 1 : 3);
  return topology;
}

}  // namespace

void requireIndexable(std::uint64_t vertices) {
  if (vertices <= std::numeric_limits<VertexIndex>::max()) return;
  throw Error(ErrorCode::LimitExceeded,
              "the mesh would have " + std::to_string(vertices) +
                  " vertices, more than 32-bit indices can name; use a coarser grid");
}

void requireFaces(std::uint64_t triangles, std::uint64_t each) {
  const std::uint64_t most = std::numeric_limits<VertexIndex>::max() / each;
  if (triangles <= most) return;
  throw Error(ErrorCode::LimitExceeded, "the uniform mesh has " + std::to_string(triangles) +
                                            " triangles, more than the " + std::to_string(most) +
                                            " that can be worked on; use a coarser grid" +
                                            (each > 1 ? ", or ask for the uniform mesh" : ""));
}

UniformSurface makeUniformSurface(grid::Volume volume, const ContourOptions& options,
                                  const StageEnds& ends, base::Job& job) {
  job.beginStage("topology", ends.topology);
  CellTopology topology = checkedTopology(volume, options, job);
  UniformSurface surface{std::move(volume), std::move(topology), VertexSheets(), Mesh()};
  const grid::FieldScale& scale = surface.volume.scale;
  job.beginStage("vertices", ends.vertices);
  // Repair looks at them; the mesh is the same whatever normals it is to have.
  const bool normals =
      options.normals == Normals::Gradient || scale.distance || !options.uniform || options.repair;
  surface.sheets = placeVertices(surface.volume.blocks, scale, surface.topology, surface.affine(),
                                 normals, surface.mesh, job);
  job.beginStage("polygons", ends.polygons);
  connectQuads(surface.view(), surface.mesh, job);
  job.beginStage("creases", ends.creases);
  if (scale.distance) {
    snapToCreases(
        surface.mesh, surface.sheets, surface.affine().voxelSize(),
        [&](const std::vector<VertexIndex>& vertices, const std::vector<std::uint8_t>& marks) {
          return quadsAt(surface.topology, surface.mesh, vertices, marks, job);
        },
        [&](const Position& place) {
          const auto accessor = surface.volume.blocks.accessor();
          const Coord& origin = surface.affine().origin();
          return SampleBalls(scale, *accessor, origin)
              .admit(surface.affine().latticePoint(place, origin));
        },
        job);
    splitAtCreases(surface.view(), surface.mesh, job);
  }
  return surface;
}

ContourReport reportOf(const grid::Volume& volume, const CellTopology& topology) {
  const grid::Blocks& blocks = volume.blocks;
  ContourReport report;
  report.isovalue = blocks.iso().isovalue;
  report.insideIsBelow = blocks.iso().insideIsBelow;
  report.distanceField = volume.scale.distance;
  report.activeVoxels = blocks.activeVoxels();
  report.nonFiniteValues = blocks.nonFiniteValues();
  for (const SurfaceBlock& block : topology.blocks) {
    if (volume.own && !volume.own->contains(blocks.origin(block.block))) continue;
    report.surfaceCells += block.cellCount;
    if (block.special < 0) continue;
    const SpecialBlock& special = topology.specials[static_cast<std::size_t>(block.special)];
    report.faceFlips += special.faceFlips;
    for (const grid::BlockBits& cut : special.cut) report.openEdges += cut.count();
  }
  return report;
}

ContourReport reportOf(const UniformSurface& surface) {
  ContourReport report = reportOf(surface.volume, surface.topology);
  report.creaseCells = surface.sheets.sharpCount();
  return report;
}

}  // namespace tufa::uniform
