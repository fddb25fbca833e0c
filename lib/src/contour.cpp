#include <tufa/contour.h>
#include <tufa/error.h>

#include <limits>

#include "base/affine.h"
#include "base/job.h"
#include "base/single_precision.h"
#include "blocks/blocks.h"
#include "blocks/field.h"
#include "certify/adapt.h"
#include "components/topology.h"
#include "creases/promote.h"
#include "cut/cut_rule.h"
#include "forest/forest.h"
#include "mend/mend.h"
#include "polygons/base_quads.h"
#include "polygons/suspects.h"
#include "vertices/place_vertices.h"

namespace tufa {
namespace {

// The end of a call's progress that each stage reaches, uniform or not.
struct StageEnds {
  double blocks, topology, vertices, polygons, creases, forest, cut;
};
constexpr StageEnds kUniformEnds = {0.15, 0.3, 0.7, 0.9, 0.95, 0.95, 0.95};
constexpr StageEnds kAdaptiveEnds = {0.08, 0.15, 0.36, 0.46, 0.5, 0.75, 0.95};

// The lowest corner of all blocks: a grid that is moved by whole blocks keeps it in its place.
template <class TreeT>
openvdb::Coord lowestOrigin(const blocks::Blocks<TreeT>& blocks) {
  if (blocks.count() == 0) return openvdb::Coord(0);
  openvdb::Coord lowest = blocks.origin(0);
  for (std::size_t i = 1; i < blocks.count(); ++i) {
    lowest.minComponent(blocks.origin(static_cast<blocks::BlockRef>(i)));
  }
  return lowest;
}

// The farthest that rounding to single precision may move a position, in voxels. Vertices keep
// twice as far from the faces of their cells.
constexpr double kMostRounding = 5e-4;

// Takes the self-intersections out of the level-0 mesh, whose positions are final.
template <class TreeT>
void repair(const polygons::QuadContext<TreeT>& quads, bool singlePrecision, Mesh& mesh,
            ContourReport& report, base::Job& job) {
  const auto toWorld = [&](std::vector<Position> points) {
    for (Position& point : points) point = quads.affine.toWorld(point);
    return points;
  };
  mend::Source source;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    return toWorld(vertices::massPoints(quads.blocks, quads.scale, quads.topology, quads.affine,
                                        vertices, job));
  };
  source.crossings = [&](const std::vector<mend::PolygonIndex>& polygons) {
    return toWorld(polygons::quadCrossings(quads, polygons, job));
  };
  source.voxelSize = quads.affine.voxelSize();
  source.singlePrecision = singlePrecision;
  const mend::MendReport mended =
      mend::mend(mesh, polygons::findSuspects(quads, mesh, job), source, job);
  report.intersectionsFound = mended.pairsFound;
  report.intersectionsLeft = mended.left.size();
  report.movedVertices = mended.movedVertices;
  report.turnedQuads = mended.turnedQuads;
  report.fannedQuads = mended.fannedQuads;
}

template <class TreeT>
Mesh contourGrid(const openvdb::Grid<TreeT>& grid, const ContourOptions& options,
                 ContourReport& report, base::Job& job) {
  const StageEnds& ends = options.uniform ? kUniformEnds : kAdaptiveEnds;
  const cut::CutRule rule = cut::readRule(options, grid.transform());
  job.beginStage("blocks", ends.blocks);
  const blocks::IsoChoice iso = blocks::chooseIsovalue(grid, options.isovalue, options.inside);
  const blocks::Blocks<TreeT> blocks(grid.tree(), iso, options.nonFinite, job);
  const blocks::FieldScale scale = blocks::readFieldScale(grid, iso);

  job.beginStage("topology", ends.topology);
  const components::Topology topology =
      components::buildTopology(blocks, scale, options.ambiguity, options.cap, job);
  if (topology.vertexCount > std::numeric_limits<VertexIndex>::max()) {
    throw Error(ErrorCode::LimitExceeded,
                "the mesh would have " + std::to_string(topology.vertexCount) +
                    " vertices, more than 32-bit indices can name; use a coarser grid");
  }

  job.beginStage("vertices", ends.vertices);
  Mesh mesh;
  const base::Affine affine(grid.transform(), lowestOrigin(blocks));
  const bool normals = options.normals == Normals::Gradient || scale.distance || !options.uniform;
  creases::VertexSides sides =
      vertices::placeVertices(blocks, scale, topology, affine, normals, mesh, job);

  job.beginStage("polygons", ends.polygons);
  const polygons::QuadContext<TreeT> quads{blocks, topology, scale, affine, sides};
  polygons::connectQuads(quads, mesh, job);

  job.beginStage("creases", ends.creases);
  if (scale.distance) {
    creases::promoteToCreases(mesh, sides, affine.voxelSize(), job);
    polygons::splitAtCreases(quads, mesh, job);
  }
  if (!options.uniform && !mesh.positions.empty()) {
    const forest::Base<TreeT> base{blocks, topology, affine, mesh, sides, options.maxAngle < 180};
    job.beginStage("forest", ends.forest);
    const forest::Forest forest = forest::buildForest(base, rule.maxLevel, job);
    job.beginStage("cut", ends.cut);
    certify::AdaptiveMesh adaptive = certify::adapt(base, forest, rule, job);
    report.certificate = certify::certificateOf(adaptive, affine.voxelSize(), options.keepLeaves);
    mesh = std::move(adaptive.mesh);
  }
  job.beginStage("repair", 1.0);
  job.forRanges(mesh.positions.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mesh.positions[i] = affine.toWorld(mesh.positions[i]);
  });
  const bool single = base::roundToSingle(mesh, kMostRounding * affine.leastHeight(), job);
  if (options.repair && options.uniform) repair(quads, single, mesh, report, job);
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
  (void)blocks::chooseIsovalue(grid, options.isovalue,
                               options.inside);  // throws: not a scalar grid
  return {};
}

}  // namespace tufa
