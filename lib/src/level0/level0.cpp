#include "level0/level0.h"

#include <tufa/error.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <string>

#include "creases/promote.h"
#include "level0/lone_samples.h"
#include "level0/with_grid.h"
#include "mend/pieces.h"
#include "polygons/suspects.h"
#include "vertices/place_vertices.h"

namespace tufa::level0 {
namespace {

// So often pieces that were passed by another one are put back.
constexpr int kMostReturns = 3;

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

blocks::IsoChoice beginBlocks(const openvdb::GridBase& grid, const ContourOptions& options,
                              const StageEnds& ends, base::Job& job) {
  job.beginStage("blocks", ends.blocks);
  return blocks::chooseIsovalue(grid, options.isovalue, options.inside);
}

template <class TreeT>
components::Topology checkedTopology(const blocks::Blocks<TreeT>& blocks,
                                     const blocks::FieldScale& scale, const ContourOptions& options,
                                     const StageEnds& ends, base::Job& job) {
  job.beginStage("topology", ends.topology);
  components::Topology topology =
      components::buildTopology(blocks, scale, options.ambiguity, options.cap, job);
  if (topology.vertexCount > std::numeric_limits<VertexIndex>::max()) {
    throw Error(ErrorCode::LimitExceeded,
                "the mesh would have " + std::to_string(topology.vertexCount) +
                    " vertices, more than 32-bit indices can name; use a coarser grid");
  }
  return topology;
}

}  // namespace

void requireScalar(const openvdb::GridBase& grid) {
  if (!grid.transform().isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" has a " + grid.transform().mapType() +
                    " transform; only linear ones can be meshed; resample the grid first");
  }
  if (!grid.isType<openvdb::FloatGrid>() && !grid.isType<openvdb::DoubleGrid>()) {
    throw Error(ErrorCode::UnsupportedGrid, "grid \"" + grid.getName() +
                                                "\" holds values of type " + grid.valueType() +
                                                "; only float and double grids have an isosurface");
  }
}

void requireCoordinates(const openvdb::GridBase& grid) {
  // Cells and nodes of the tree reach that far beyond the data at most.
  constexpr std::int64_t kMargin = 4096;
  constexpr std::int64_t kEnd = std::int64_t{1} << 31;
  openvdb::CoordBBox box;
  if (!grid.constBaseTree().evalLeafBoundingBox(box)) return;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.min()[axis] >= kMargin - kEnd && box.max()[axis] < kEnd - kMargin) continue;
    throw Error(ErrorCode::LimitExceeded,
                "grid \"" + grid.getName() + "\" has coordinates from " +
                    std::to_string(box.min()[axis]) + " to " + std::to_string(box.max()[axis]) +
                    ", too near to the ends of 32-bit integers; move it towards the origin");
  }
}

template <class TreeT>
Level0<TreeT>::Level0(const openvdb::Grid<TreeT>& grid, const ContourOptions& options,
                      const StageEnds& ends, base::Job& job)
    : iso_(beginBlocks(grid, options, ends, job)),
      blocks_(grid.tree(), iso_, options.nonFinite, job),
      scale_(blocks::readFieldScale(grid, iso_)),
      topology_(checkedTopology(blocks_, scale_, options, ends, job)),
      affine_(grid.transform(), lowestOrigin(blocks_)) {
  makeMesh(options, ends, job);
}

template <class TreeT>
Level0<TreeT>::Level0(const openvdb::math::Transform& transform, const blocks::Blocks<TreeT>& whole,
                      const openvdb::CoordBBox& box, const blocks::FieldScale& scale,
                      const ContourOptions& options, const StageEnds& ends, base::Job& job)
    : iso_(whole.iso()),
      blocks_(whole, box),
      scale_(scale),
      topology_(checkedTopology(blocks_, scale_, options, ends, job)),
      affine_(transform, lowestOrigin(whole)) {
  makeMesh(options, ends, job);
}

template <class TreeT>
void Level0<TreeT>::makeMesh(const ContourOptions& options, const StageEnds& ends, base::Job& job) {
  job.beginStage("vertices", ends.vertices);
  const bool normals = options.normals == Normals::Gradient || scale_.distance || !options.uniform;
  sides_ = vertices::placeVertices(blocks_, scale_, topology_, affine_, normals, mesh_, job);
  job.beginStage("polygons", ends.polygons);
  polygons::connectQuads(quads(), mesh_, job);
  job.beginStage("creases", ends.creases);
  if (scale_.distance) {
    creases::promoteToCreases(mesh_, sides_, affine_.voxelSize(), job);
    polygons::splitAtCreases(quads(), mesh_, job);
  }
  report_.isovalue = iso_.isovalue;
  report_.insideIsBelow = iso_.insideIsBelow;
  report_.distanceField = scale_.distance;
  report_.activeVoxels = blocks_.activeVoxels();
  report_.nonFiniteValues = blocks_.nonFiniteValues();
  report_.surfaceCells = topology_.cellCount;
  report_.creaseCells = sides_.sharpCount();
  report_.faceFlips = topology_.faceFlips;
  report_.cutEdges = topology_.cutEdges;
  if (blocks_.isPart()) {
    before_.positions = mesh_.positions;
    before_.quads = mesh_.quads;
  }
  job.beginStage("repair", ends.repair);
  if (options.repair) repair(job);
}

template <class TreeT>
mend::Source Level0<TreeT>::source(base::Job& job) const {
  mend::Source source;
  source.massPoints = [this, &job](const std::vector<VertexIndex>& vertices) {
    return vertices::massPoints(blocks_, scale_, topology_, affine_, vertices, job);
  };
  source.crossings = [this, &job](const std::vector<mend::PolygonIndex>& polygons) {
    return polygons::quadCrossings(quads(), polygons, job);
  };
  source.voxelSize = affine_.voxelSize();
  return source;
}

template <class TreeT>
void Level0<TreeT>::repair(base::Job& job) {
  report_.movedVertices = unfoldLonePieces(mesh_, source(job), job);
  // Rounding moves each of two polygons.
  const double margin = 2 * kMostRounding * affine_.leastHeight();
  suspects_ = polygons::findSuspects(quads(), mesh_, margin, job);
  mendSuspects(job);
  for (int i = 0; i < kMostReturns && putBackPieces(job); ++i) mendSuspects(job);
}

template <class TreeT>
void Level0<TreeT>::mendSuspects(base::Job& job) {
  mend::Source own = source(job);
  own.crossings = nullptr;  // a forest has no place for the centres of fans
  const mend::MendReport mended = mend::mend(mesh_, suspects_, own, job);
  addSuspects(mended.changed);
  report_.intersectionsFound = std::max(report_.intersectionsFound, mended.pairsFound);
  report_.intersectionsLeft = mended.left.size();
  report_.movedVertices += mended.movedVertices;
  report_.turnedQuads += mended.turnedQuads;
}

// Vertices that a crease or mending drew out of their cells may have passed small pieces: these and
// what is beside them goes back into its cells. Whether there are any.
template <class TreeT>
bool Level0<TreeT>::putBackPieces(base::Job& job) {
  if (sides_.sharpCount() == 0 || topology_.cutEdges > 0 || blocks_.isPart()) return false;
  const std::vector<VertexIndex> misplaced = mend::findMisplaced(mesh_, job);
  if (misplaced.empty()) return false;
  const std::vector<Position> havens = source(job).massPoints(misplaced);
  for (std::size_t i = 0; i < misplaced.size(); ++i) mesh_.positions[misplaced[i]] = havens[i];
  report_.movedVertices += misplaced.size();
  std::vector<mend::PolygonIndex> around;
  for (std::uint32_t i = 0; i < mesh_.quads.size(); ++i) {
    const auto& v = mesh_.quads[i].vertices;
    if (std::any_of(v.begin(), v.end(), [&](VertexIndex vertex) {
          return std::binary_search(misplaced.begin(), misplaced.end(), vertex);
        })) {
      around.push_back(i);
    }
  }
  addSuspects(around);
  return true;
}

template <class TreeT>
void Level0<TreeT>::addSuspects(const std::vector<mend::PolygonIndex>& polygons) {
  std::vector<std::uint32_t> all;
  std::set_union(suspects_.begin(), suspects_.end(), polygons.begin(), polygons.end(),
                 std::back_inserter(all));
  suspects_ = std::move(all);
}

template class Level0<openvdb::FloatTree>;
template class Level0<openvdb::DoubleTree>;

}  // namespace tufa::level0
