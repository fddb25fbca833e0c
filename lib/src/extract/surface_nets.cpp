#include "extract/surface_nets.h"

#include "base/huge_pages.h"
#include "uniform/block_vertices.h"
#include "uniform/quads.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {
namespace {

// Shares of the time that stages took on the sample volumes.
constexpr double kTopologyEnd = 0.2, kVerticesEnd = 0.7, kPolygonsEnd = 0.95;

void placeMeans(const grid::Volume& volume, const uniform::CellTopology& topology, Mesh& mesh,
                base::Job& job) {
  const grid::Affine& affine = volume.affine;
  job.forRanges(topology.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    const auto accessor = volume.blocks.accessor();
    uniform::BlockVertices work(volume.scale);
    for (std::size_t i = begin; i < end; ++i) {
      const uniform::SurfaceBlock& block = topology.blocks[i];
      work.gather(volume.blocks, topology, block, *accessor);
      const Coord& origin = volume.blocks.origin(block.block);
      for (std::size_t v = 0; v < work.cells().size(); ++v) {
        const uniform::Vector point = work.massPoint(v);
        mesh.positions[block.firstVertex + v] =
            affine.position(origin, static_cast<double>(point[0]), static_cast<double>(point[1]),
                            static_cast<double>(point[2]));
        const uniform::Vector normal = work.normalSum(v);
        mesh.normals[block.firstVertex + v] = affine.normal(normal[0], normal[1], normal[2]);
      }
    }
  });
}

}  // namespace

Mesh meshSurfaceNets(const grid::Volume& volume, const ContourOptions& options,
                     ContourReport& report, base::Job& job) {
  job.beginStage("topology", kTopologyEnd);
  const uniform::CellTopology topology =
      uniform::buildCellTopology(volume.blocks, volume.scale, options.ambiguity, options.cap, job);
  uniform::requireIndexable(topology.vertexCount);
  report = uniform::reportOf(volume, topology);
  job.beginStage("vertices", kVerticesEnd);
  Mesh mesh;
  base::resizeLarge(mesh.positions, topology.vertexCount, job);
  base::resizeLarge(mesh.normals, topology.vertexCount, job);  // the quads' diagonals follow them
  placeMeans(volume, topology, mesh, job);
  job.beginStage("polygons", kPolygonsEnd);
  const uniform::VertexSheets smooth(topology.vertexCount);
  uniform::connectQuads({volume.blocks, volume.scale, volume.affine, topology, smooth, mesh}, mesh,
                        job);
  return mesh;
}

}  // namespace tufa::extraction
