#include <tufa/contour.h>
#include <tufa/error.h>

#include <limits>

#include "base/affine.h"
#include "base/job.h"
#include "blocks/blocks.h"
#include "blocks/field.h"
#include "components/topology.h"
#include "creases/promote.h"
#include "polygons/base_quads.h"
#include "vertices/place_vertices.h"

namespace tufa {
namespace {

template <class TreeT>
Mesh contourGrid(const openvdb::Grid<TreeT>& grid, const ContourOptions& options,
                 ContourReport& report, base::Job& job) {
  job.beginStage("blocks", 0.15);
  const blocks::IsoChoice iso = blocks::chooseIsovalue(grid, options.isovalue, options.inside);
  const blocks::Blocks<TreeT> blocks(grid.tree(), iso, options.nonFinite, job);
  const blocks::FieldScale scale = blocks::readFieldScale(grid, iso);

  job.beginStage("topology", 0.3);
  const components::Topology topology =
      components::buildTopology(blocks, scale, options.ambiguity, options.cap, job);
  if (topology.vertexCount > std::numeric_limits<VertexIndex>::max()) {
    throw Error(ErrorCode::LimitExceeded,
                "the mesh would have " + std::to_string(topology.vertexCount) +
                    " vertices, more than 32-bit indices can name; use a coarser grid");
  }

  job.beginStage("vertices", 0.75);
  Mesh mesh;
  const base::Affine affine(grid.transform());
  const bool normals = options.normals == Normals::Gradient || scale.distance;
  creases::VertexSides sides =
      vertices::placeVertices(blocks, scale, topology, affine, normals, mesh, job);

  job.beginStage("polygons", 0.95);
  const polygons::QuadContext<TreeT> quads{blocks, topology, scale, affine, sides};
  polygons::connectQuads(quads, mesh, job);

  job.beginStage("creases", 1.0);
  if (scale.distance) {
    creases::promoteToCreases(mesh, sides, affine.voxelSize(), job);
    polygons::splitAtCreases(quads, mesh, job);
  }
  if (options.normals == Normals::Faces) vertices::setFaceNormals(mesh, job);
  if (options.normals == Normals::None) mesh.normals = {};

  report.isovalue = iso.isovalue;
  report.insideIsBelow = iso.insideIsBelow;
  report.distanceField = scale.distance;
  report.activeVoxels = blocks.activeVoxels();
  report.nonFiniteValues = blocks.nonFiniteValues();
  report.surfaceCells = topology.cellCount;
  report.creaseCells = sides.sharpCount();
  report.faceFlips = topology.faceFlips;
  report.cutEdges = topology.cutEdges;
  return mesh;
}

template <class GridT>
Mesh runContour(const GridT& grid, const ContourOptions& options, ContourReport* report) {
  ContourReport own;
  ContourReport& out = report != nullptr ? *report : own;
  out = {};
  base::Job job(options.threads, options.progress);
  Mesh mesh;
  job.run([&] {
    mesh = contourGrid(grid, options, out, job);
    out.stages = job.finish();
  });
  return mesh;
}

}  // namespace

Mesh contour(const openvdb::GridBase& grid, const ContourOptions& options, ContourReport* report) {
  if (!grid.transform().isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" has a " + grid.transform().mapType() +
                    " transform; only linear ones can be meshed; resample the grid first");
  }
  if (grid.isType<openvdb::FloatGrid>()) {
    return runContour(static_cast<const openvdb::FloatGrid&>(grid), options, report);
  }
  if (grid.isType<openvdb::DoubleGrid>()) {
    return runContour(static_cast<const openvdb::DoubleGrid&>(grid), options, report);
  }
  (void)blocks::chooseIsovalue(grid, options.isovalue, options.inside);  // throws: not a scalar grid
  return {};
}

}  // namespace tufa
