#include "extract/cms.h"

#include <cmath>
#include <optional>
#include <utility>

#include "extract/face_arcs.h"
#include "extract/fan_mesher.h"
#include "extract/marching_cubes.h"
#include "extract/merged_cells.h"
#include "extract/place_crossings.h"

namespace tufa::extraction {

namespace {

// The number of an arc of the face at a cell's lower end across an axis.
constexpr int arcPart(int axis, int arc) { return 2 * axis + arc; }

// Where the crease at a point of a cell passes the face at a height along an axis, counted from the
// middle of the cell. Of more than two sheets, those are meant that are most like the tangent
// planes at the ends of an arc.
std::optional<FacePoint> creaseAt(const uniform::CreasePlacement& crease, int axis, double height,
                                  const std::array<Vec3, 2>& ends) {
  constexpr double kLeastSine = 0.05;  // between the crease and the face
  if (crease.planes < 2) return std::nullopt;
  std::array<int, 2> nearest{};
  for (int end = 0; end < 2; ++end) {
    for (int sheet = 1; sheet < crease.planes; ++sheet) {
      const auto likeness = [&](int k) { return uniform::toVec3(crease.sheets[k]).dot(ends[end]); };
      if (likeness(sheet) > likeness(nearest[end])) nearest[end] = sheet;
    }
  }
  if (nearest[0] == nearest[1]) return std::nullopt;
  const Vec3 way =
      uniform::toVec3(crease.sheets[nearest[0]]).cross(uniform::toVec3(crease.sheets[nearest[1]]));
  if (!(std::abs(way[axis]) > kLeastSine * way.length())) return std::nullopt;
  const Vec3 point = uniform::toVec3(crease.point);
  const Vec3 there = point + way * ((height - point[axis]) / way[axis]);
  const auto [u, v] = uniform::otherAxes(axis);
  return FacePoint{0.5 + there[u], 0.5 + there[v]};
}

class SquaresMesher {
 public:
  SquaresMesher(const grid::Volume& volume, CubeCells& cells, double sharpAngle, double tolerance,
                base::Job& job)
      : volume_(volume),
        cells_(cells),
        leastCosine_(cosineOf(sharpAngle)),
        tolerance_(tolerance),
        job_(job) {}

  Mesh run(ContourReport& report) {
    job_.beginStage("vertices", kVerticesEnd);
    mesh_ = meshOfCrossings(volume_, cells_, job_);
    job_.beginStage("faces", kFacesEnd);
    joinFaces();
    job_.beginStage("features", kFeaturesEnd);
    loops_ = findSharpLoops(volume_, cells_, mesh_, leastCosine_, job_);
    placePoints();
    std::vector<BlockTriangles> leaves;
    if (tolerance_ > 0) {
      leaves = mergeCells(volume_, cells_, loops_.cells, mesh_, {tolerance_, leastCosine_}, job_);
    }
    FanMesher fans(volume_, cells_, loops_, mesh_, job_);
    const auto steps = [&](const WalkedCell& cell, int edge) {
      return pointAfter(cell, edge) ? 2 : 1;
    };
    fans.run(arcs_, kTrianglesEnd, steps, [&](const WalkedCell& cell, int edge, const auto& body) {
      if (const auto point = pointAfter(cell, edge)) body(*point);
      body(cell.vertexAt(cell.cubeCase().next[edge]));
    });
    report.creaseCells = fans.featureCount();
    appendBlocks(leaves, cells_.edgeCount, mesh_);
    if (cells_.topology.openEdges > 0 || tolerance_ > 0) dropUnused(mesh_, job_);
    return std::move(mesh_);
  }

 private:
  // Shares of the time that stages took on the sample volumes.
  static constexpr double kVerticesEnd = 0.6, kFacesEnd = 0.7, kFeaturesEnd = 0.85,
                          kTrianglesEnd = 0.95;

  // The crossing of an edge, seen in a face across an axis. The same numbers for both cells there.
  [[nodiscard]] FaceCrossing crossingAt(const WalkedCell& cell, int edge, int axis) const {
    const VertexIndex vertex = cell.vertexAt(edge);
    const Vec3 at =
        volume_.affine.latticePoint(mesh_.positions[vertex], cell.corner(volume_.blocks));
    const Vec3 plane = volume_.affine.planeInLattice(mesh_.normals[vertex]);
    const auto [u, v] = uniform::otherAxes(axis);
    return {{at[u], at[v]}, {plane[u], plane[v]}, mesh_.normals[vertex]};
  }

  // Decides the ambiguous faces of all cells.
  void joinFaces() {
    walkCells(cells_, job_, [&](const WalkedCell& cell) {
      const CornerMask mask = cell.mask();
      if (uniform::ambiguousFaces(mask) == 0) return;
      const FaceBits saddles = joinedFacesOf(cell.code);
      unsigned joined = 0;
      base::forEachBit(uniform::ambiguousFaces(mask), [&](int face) {
        std::array<FaceCrossing, 4> crossings;
        for (int i = 0; i < 4; ++i) {
          crossings[i] = crossingAt(cell, uniform::kFaceEdges[face][i], face / 2);
        }
        const bool otherwise = ((saddles >> face) & 1) != 0;
        if (joinsInside(mask, face, crossings, leastCosine_, otherwise)) joined |= 1u << face;
      });
      cells_.codes[cell.place.cell] = codeOf(mask, static_cast<FaceBits>(joined));
    });
  }

  // Finds the sharp points of the faces at the lower ends of cells.
  void placePoints() {
    arcs_.blocks.resize(cells_.topology.blocks.size());
    base::resizeLarge(arcs_.cells, cells_.topology.cellCount, job_);
    walkCells(cells_, job_, [&](const WalkedCell& cell) {
      std::vector<Feature>& points = arcs_.blocks[cell.place.block];
      CellFeatures& arcs = arcs_.cells[cell.place.cell];
      arcs.first = static_cast<VertexIndex>(points.size());
      if (loops_.cells[cell.place.cell].parts == 0) return;
      const FaceBits joined = joinedFacesOf(cell.code);
      for (int axis = 0; axis < 3; ++axis) {
        const int face = 2 * axis;
        const FaceArcs contour = arcsOf(cell.mask(), face, ((joined >> face) & 1) != 0);
        for (int arc = 0; arc < contour.count; ++arc) {
          const auto point = pointOf(cell, axis, contour.arcs[arc]);
          if (!point) continue;
          arcs.add(arcPart(axis, arc));
          points.push_back(*point);
        }
      }
    });
  }

  // The point of an arc of the face at a cell's lower end across an axis.
  [[nodiscard]] std::optional<Feature> pointOf(const WalkedCell& cell, int axis,
                                               const FaceArc& arc) const {
    const auto& edges = uniform::kFaceEdges[2 * axis];
    const FaceCrossing from = crossingAt(cell, edges[arc.from], axis);
    const FaceCrossing to = crossingAt(cell, edges[arc.to], axis);
    const LoopFeature* const own = featureOf(cell.place, edges[arc.from]);
    const LoopFeature* const below = featureBelow(cell, axis, edges[arc.from]);
    const bool both = own != nullptr && below != nullptr;
    std::optional<FacePoint> point;
    // Where one of the vertices is beyond the face, the contour would run back.
    const bool apart = own != nullptr && own->sheets.point[axis] > -0.5F &&
                       (below == nullptr || below->sheets.point[axis] < 0.5F);
    if (isSharp(from, to, leastCosine_) && apart) {
      point = pointOfCrease({own, below}, axis, from, to);
      if (!point) point = sharpPoint(from, to, leastCosine_);
    }
    Vec3 normal = Vec3(from.normal) + Vec3(to.normal);
    if (!normal.normalize()) normal = Vec3(from.normal);
    if (point) {
      const auto [u, v] = uniform::otherAxes(axis);
      std::array<double, 3> in{};
      in[u] = (*point)[0];
      in[v] = (*point)[1];
      return Feature{volume_.affine.position(cell.corner(volume_.blocks), in[0], in[1], in[2]),
                     Normal(normal)};
    }
    if (!both || !volume_.scale.distance) return std::nullopt;
    const Vec3 first(own->vertex.position), second(below->vertex.position);
    if (first == second) return std::nullopt;
    // The crease passes beside the face: half way between the vertices of both cells.
    return Feature{(first + second) / 2, Normal(normal)};
  }

  // The feature of the loop that has an edge of a cell.
  [[nodiscard]] const LoopFeature* featureOf(const CubeCells::Place& place, int edge) const {
    const CubeCase& chosen = caseOf(cells_.codes[place.cell]);
    return chosen.next[edge] < 0 ? nullptr : loops_.of(place, chosen.loopOf[edge]);
  }
  [[nodiscard]] const LoopFeature* featureBelow(const WalkedCell& cell, int axis, int edge) const {
    std::array<int, 3> at = cell.at;
    --at[axis];
    const auto below = cells_.find(cell.block, at);
    return below ? featureOf(*below, kBeyond[edge][axis]) : nullptr;
  }

  // Where the crease that the loops on both sides of a face know passes it: the mean of the two.
  [[nodiscard]] std::optional<FacePoint> pointOfCrease(
      const std::array<const LoopFeature*, 2>& sides, int axis, const FaceCrossing& from,
      const FaceCrossing& to) const {
    const Vec3 first = volume_.affine.planeInLattice(from.normal);
    const Vec3 second = volume_.affine.planeInLattice(to.normal);
    FacePoint sum{};
    int count = 0;
    for (int side = 0; side < 2; ++side) {
      if (sides[side] == nullptr) continue;
      const auto point =
          creaseAt(sides[side]->sheets, axis, side == 0 ? -0.5 : 0.5, {first, second});
      if (!point) continue;
      sum[0] += (*point)[0];
      sum[1] += (*point)[1];
      ++count;
    }
    if (count == 0) return std::nullopt;
    const FacePoint mean = {sum[0] / count, sum[1] / count};
    return isInFace(mean) ? std::optional(mean) : std::nullopt;
  }

  // The sharp point of the arc from a crossing to the next, if it has one: its number in its block,
  // or, once all are numbered, its vertex.
  [[nodiscard]] std::optional<VertexIndex> pointAfter(const WalkedCell& cell, int edge) const {
    const int next = cell.cubeCase().next[edge], face = kFaceOf[edge][next], axis = face / 2;
    const int part = arcPart(axis, arcWith(cell.mask(), face, edge, next));
    std::optional<CubeCells::Place> owner = cell.place;
    if ((face & 1) != 0) {
      std::array<int, 3> at = cell.at;
      ++at[axis];
      owner = cells_.find(cell.block, at);
    }
    if (!owner || !arcs_.cells[owner->cell].has(part)) return std::nullopt;
    return arcs_.cells[owner->cell].of(part);
  }

  const grid::Volume& volume_;
  CubeCells& cells_;
  double leastCosine_;
  double tolerance_;
  base::Job& job_;
  Mesh mesh_;
  ArcPoints arcs_;
  SharpLoops loops_;
};

}  // namespace

Mesh meshSquares(const grid::Volume& volume, double sharpAngle, double tolerance,
                 const ContourOptions& options, ContourReport& report, base::Job& job) {
  CubeCells cells = chooseCases(volume, marchingCubesRule(Ambiguity::Asymptotic), options.cap, job);
  report = uniform::reportOf(volume, cells.topology);
  return SquaresMesher(volume, cells, sharpAngle, tolerance, job).run(report);
}

}  // namespace tufa::extraction
