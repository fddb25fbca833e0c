#include "extract/emc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/huge_pages.h"
#include "extract/crease_point.h"
#include "extract/cube_mesher.h"
#include "extract/loop_crossings.h"
#include "extract/marching_cubes.h"
#include "extract/place_crossings.h"
#include "uniform/qef.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using uniform::SurfaceBlock;

namespace {

// Shares of the time that stages took on the sample volumes.
constexpr double kVerticesEnd = 0.65, kFeaturesEnd = 0.8, kTrianglesEnd = 0.95;
// The face that holds two edges, as consecutive crossings of a loop are.
constexpr auto kFaceOf = [] {
  std::array<std::array<std::int8_t, kEdges>, kEdges> faces{};
  for (int face = 0; face < kFaces; ++face) {
    for (const int a : uniform::kFaceEdges[face]) {
      for (const int b : uniform::kFaceEdges[face]) faces[a][b] = static_cast<std::int8_t>(face);
    }
  }
  return faces;
}();

// A lattice edge on a face across an axis, as the cell beyond that face numbers it.
constexpr auto kBeyond = [] {
  std::array<std::array<std::int8_t, 3>, kEdges> beyond{};
  for (int edge = 0; edge < kEdges; ++edge) {
    const auto [lower, upper] = uniform::edgeCorners(edge);
    for (int axis = 0; axis < 3; ++axis) {
      const int step = 4 >> axis;
      beyond[edge][axis] =
          static_cast<std::int8_t>(uniform::edgeBetween(lower ^ step, upper ^ step));
    }
  }
  return beyond;
}();

// A vertex on a crease or corner.
struct Feature {
  Position position;
  Normal normal;
};

// Which loops of a cell have one, and the number of the first: of a vertex, or of tangent planes.
struct CellFeatures {
  VertexIndex first = 0;
  std::uint8_t loops = 0;

  void add(int loop) { loops = static_cast<std::uint8_t>(loops | 1 << loop); }
  [[nodiscard]] bool has(int loop) const { return ((loops >> loop) & 1) != 0; }
  [[nodiscard]] VertexIndex of(int loop) const {
    return first + static_cast<VertexIndex>(base::countBits(loops & base::bitsBelow(loop)));
  }
};

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
    findSharp();
    placeFeatures();
    number();
    job_.beginStage("triangles", kTrianglesEnd);
    base::resizeLarge(mesh_.triangles, triangleCount_, job_);
    emit();
    if (topology_.openEdges > 0) dropUnused(mesh_, job_);
    return std::move(mesh_);
  }

  [[nodiscard]] std::size_t featureCells() const { return featureCells_; }

 private:
  struct BlockFeatures {
    std::vector<uniform::Qef> planes;  ///< of loops whose own normals differ
    std::vector<Feature> features;
    std::uint64_t firstTriangle = 0;
    std::uint64_t firstVertex = 0;  ///< features first, then the means of other loops
    std::uint32_t triangles = 0;
    std::uint32_t centres = 0;
  };

  // Calls body(block, index, table) for each surface block.
  template <class Body>
  void forBlocks(const Body& body) {
    job_.forRanges(topology_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      CubeTable table;
      for (std::size_t i = begin; i < end; ++i) {
        table.fill(topology_, topology_.blocks[i], cells_.edges);
        body(topology_.blocks[i], i, table);
      }
    });
  }

  [[nodiscard]] Coord cornerOf(const SurfaceBlock& block, const std::array<int, 3>& at) const {
    return volume_.blocks.origin(block.block).offsetBy(at[0], at[1], at[2]);
  }

  // Finds the loops whose normals differ enough.
  void findSharp() {
    blocks_.resize(topology_.blocks.size());
    base::resizeLarge(sharp_, topology_.cellCount, job_);
    forBlocks([&](const SurfaceBlock& block, std::size_t i, const CubeTable& table) {
      std::vector<uniform::Qef>& planes = blocks_[i].planes;
      CellFeatures* sharp = sharp_.data() + block.firstVertex;
      cells_.forCells(block, [&](int x, int bit, CaseCode code) {
        const std::array<int, 3> at = {x, bit >> 3, bit & 7};
        sharp->first = static_cast<VertexIndex>(planes.size());
        const CubeCase& cell = caseOf(code);
        const int place = CubeTable::placeOf(at[0], at[1], at[2]);
        for (int loop = 0; loop < cell.loopCount; ++loop) {
          const LoopCrossings crossings(cell, loop, place, table, mesh_);
          if (crossings.leastCosine() >= leastCosine_) continue;
          sharp->add(loop);
          planes.push_back(crossings.planes(volume_.affine, cornerOf(block, at)));
        }
        ++sharp;
      });
    });
  }

  void placeFeatures() {
    base::resizeLarge(features_, topology_.cellCount, job_);
    forBlocks([&](const SurfaceBlock& block, std::size_t i, const CubeTable& table) {
      BlockFeatures& own = blocks_[i];
      CellFeatures* features = features_.data() + block.firstVertex;
      const CellFeatures* sharp = sharp_.data() + block.firstVertex;
      // Outside of distance fields planes are not exact enough to follow them.
      const bool follows = volume_.scale.distance && isNearSharp(block);
      cells_.forCells(block, [&](int x, int bit, CaseCode code) {
        const CubeCase& cell = caseOf(code);
        const std::array<int, 3> at = {x, bit >> 3, bit & 7};
        features->first = static_cast<VertexIndex>(own.features.size());
        const int place = CubeTable::placeOf(at[0], at[1], at[2]);
        for (int loop = 0; loop < cell.loopCount; ++loop) {
          if (!sharp->has(loop) && !follows) continue;
          const LoopCrossings crossings(cell, loop, place, table, mesh_);
          const auto point = sharp->has(loop) ? pointFor(own.planes[sharp->of(loop)])
                                              : creaseThrough(block, at, cell, loop, crossings);
          if (!point) continue;
          features->add(loop);
          own.features.push_back(featureAt(*point, cornerOf(block, at), crossings));
        }
        countTriangles(cell, *features++, own);
        ++sharp;
      });
    });
  }

  [[nodiscard]] std::optional<uniform::Vector> pointFor(const uniform::Qef& planes) const {
    if (!volume_.scale.distance) return uniform::solve(planes, CreasePoint::kHalfCell);
    // A crease may leave the cell and come back.
    const CreasePoint best(planes);
    return best.isInside ? best.inside : best.beyond;
  }

  // Whether a loop of a block, or of one beside it, has normals that differ enough.
  [[nodiscard]] bool isNearSharp(const SurfaceBlock& block) const {
    constexpr std::array<std::array<int, 3>, 7> kSteps = {
        {{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
    return std::any_of(kSteps.begin(), kSteps.end(), [&](const std::array<int, 3>& step) {
      const auto index = topology_.neighbour(block, step[0], step[1], step[2]);
      return index != uniform::kNoSurfaceBlock && !blocks_[index].planes.empty();
    });
  }

  [[nodiscard]] Feature featureAt(const uniform::Vector& point, const Coord& corner,
                                  const LoopCrossings& crossings) const {
    Vec3 sum(0);
    for (int i = 0; i < crossings.size(); ++i) sum += Vec3(crossings.normal(i));
    if (!sum.normalize()) sum = Vec3(0);
    return {volume_.affine.position(corner, 0.5 + static_cast<double>(point[0]),
                                    0.5 + static_cast<double>(point[1]),
                                    0.5 + static_cast<double>(point[2])),
            Normal(sum)};
  }

  // A crease may clip a cell whose own crossings all lie on one sheet. The loops beyond its arcs
  // tell of the other: where the sheets meet in this cell there is a vertex, too.
  [[nodiscard]] std::optional<uniform::Vector> creaseThrough(const SurfaceBlock& block,
                                                             const std::array<int, 3>& at,
                                                             const CubeCase& cell, int loop,
                                                             const LoopCrossings& crossings) const {
    std::optional<uniform::Qef> planes;
    forLoop(cell, loop, [&](int edge) {
      const Beyond beyond = loopBeyond(block, at, cell, edge);
      if (beyond.loop < 0 || !sharp_[beyond.cell].has(beyond.loop)) return;
      if (!planes) planes = crossings.planes(volume_.affine, cornerOf(block, at));
      uniform::Vector here{};
      here[beyond.face / 2] = (beyond.face & 1) != 0 ? -1.0F : 1.0F;
      *planes += blocks_[beyond.block].planes[sharp_[beyond.cell].of(beyond.loop)].seenFrom(here);
    });
    if (!planes) return std::nullopt;
    // Along the crease the vertex is nearest to the crossings of this loop.
    const uniform::Qef own = crossings.planes(volume_.affine, cornerOf(block, at));
    for (int i = 0; i < 3; ++i) planes->points[i] = own.points[i] * planes->count / own.count;
    if (!CreasePoint::mayBeInside(*planes)) return std::nullopt;
    const CreasePoint best(*planes);
    if (!best.isInside) return std::nullopt;
    return best.inside;
  }

  // Whether a triangle of the case belongs to a loop without a feature. Its first corner is an
  // edge.
  static bool isKept(const CubeCase& cell, int triangle, const CellFeatures& features) {
    return !features.has(cell.loopOf[cell.triangles[triangle][0]]);
  }

  // The mean of a loop's crossings, if the case has it and the loop no feature.
  static bool hasCentre(const CubeCase& cell, const CellFeatures& features) {
    if (cell.centreCount == 0) return false;
    return !features.has(cell.loopOf[std::countr_zero(cell.aroundCentre[0])]);
  }

  static void countTriangles(const CubeCase& cell, const CellFeatures& features,
                             BlockFeatures& own) {
    own.centres += hasCentre(cell, features) ? 1 : 0;
    for (int i = 0; i < cell.count; ++i) own.triangles += isKept(cell, i, features) ? 1 : 0;
    for (int loop = 0; loop < cell.loopCount; ++loop) {
      if (features.has(loop)) forLoop(cell, loop, [&](int) { ++own.triangles; });
    }
  }

  void number() {
    std::uint64_t vertices = cells_.edgeCount;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      job_.pollCancelled(i);
      BlockFeatures& own = blocks_[i];
      own.firstVertex = vertices;
      own.firstTriangle = triangleCount_;
      vertices += own.features.size() + own.centres;
      triangleCount_ += own.triangles;
      featureCells_ += own.features.size();
    }
    uniform::requireIndexable(vertices);
    base::resizeLarge(mesh_.positions, vertices, job_);
    base::resizeLarge(mesh_.normals, vertices, job_);
    job_.forRanges(blocks_.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = topology_.blocks[i];
        const auto first = static_cast<VertexIndex>(blocks_[i].firstVertex);
        for (std::uint32_t cell = 0; cell < block.cellCount; ++cell) {
          features_[block.firstVertex + cell].first += first;
        }
        for (std::size_t k = 0; k < blocks_[i].features.size(); ++k) {
          mesh_.positions[first + k] = blocks_[i].features[k].position;
          mesh_.normals[first + k] = blocks_[i].features[k].normal;
        }
      }
    });
  }

  void emit() {
    const int second = volume_.affine.mirrored() ? 2 : 1;
    forBlocks([&](const SurfaceBlock& block, std::size_t i, const CubeTable& table) {
      Triangle* triangle = mesh_.triangles.data() + blocks_[i].firstTriangle;
      auto centre = static_cast<VertexIndex>(blocks_[i].firstVertex + blocks_[i].features.size());
      const CellFeatures* features = features_.data() + block.firstVertex;
      cells_.forCells(block, [&](int x, int bit, CaseCode code) {
        const CubeCase& cell = caseOf(code);
        const int place = CubeTable::placeOf(x, bit >> 3, bit & 7);
        const auto add = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
          *triangle++ = second == 1 ? Triangle(a, b, c) : Triangle(a, c, b);
        };
        const auto at = [&](int edge) {
          return edge < kEdges ? table[place + kEdgeOffsets[edge]] : centre;
        };
        for (int t = 0; t < cell.count; ++t) {
          const auto& [a, b, c] = cell.triangles[t];
          if (isKept(cell, t, *features)) add(at(a), at(b), at(c));
        }
        for (int loop = 0; loop < cell.loopCount; ++loop) {
          if (!features->has(loop)) continue;
          forLoop(cell, loop, [&](int edge) {
            const int next = cell.next[edge];
            const VertexIndex own = features->of(loop);
            VertexIndex other = at(next);
            if (const auto beyond = featureBeyond(block, {x, bit >> 3, bit & 7}, cell, edge)) {
              other = *beyond;
            }
            add(at(edge), other, own);
          });
        }
        if (hasCentre(cell, *features)) {
          placeCentre(cell.aroundCentre[0], place, table, centre++, mesh_);
        }
        ++features;
      });
    });
  }

  // The loop of the next cell that shares an arc.
  struct Beyond {
    std::size_t block = 0;   ///< of the surface blocks
    std::uint64_t cell = 0;  ///< of all surface cells
    int face = 0;            ///< between the two cells, as the first one numbers it
    int loop = -1;           ///< -1 for none
  };

  // That of the arc from a crossing to the next.
  [[nodiscard]] Beyond loopBeyond(const SurfaceBlock& block, std::array<int, 3> at,
                                  const CubeCase& cell, int edge) const {
    Beyond beyond;
    beyond.face = kFaceOf[edge][cell.next[edge]];
    const int axis = beyond.face / 2;
    at[axis] += (beyond.face & 1) != 0 ? 1 : -1;
    const uniform::SurfaceBlockIndex index =
        topology_.neighbour(block, at[0] >> 3, at[1] >> 3, at[2] >> 3);
    if (index == uniform::kNoSurfaceBlock) return beyond;
    const SurfaceBlock& owner = topology_.blocks[index];
    const int local = grid::cellIndex(at[0] & 7, at[1] & 7, at[2] & 7);
    beyond.block = index;
    beyond.cell = owner.firstVertex + topology_.firstVertexInBlock(owner, local);
    const CubeCase& next = caseOf(cells_.codes[beyond.cell]);
    const int arrives = kBeyond[edge][axis];
    // It has no triangles where it has open edges.
    if (next.next[arrives] >= 0) beyond.loop = next.loopOf[arrives];
    return beyond;
  }

  // The feature of the loop that shares the arc from a crossing to the next, if the edge between
  // the two features is to take the place of the arc's.
  [[nodiscard]] std::optional<VertexIndex> featureBeyond(const SurfaceBlock& block,
                                                         const std::array<int, 3>& at,
                                                         const CubeCase& cell, int edge) const {
    const Beyond beyond = loopBeyond(block, at, cell, edge);
    if (beyond.loop < 0) return std::nullopt;
    const CellFeatures& features = features_[beyond.cell];
    if (!features.has(beyond.loop)) return std::nullopt;
    if (ownsBothArcs(cell, cell.loopOf[edge], beyond.face) &&
        ownsBothArcs(caseOf(cells_.codes[beyond.cell]), beyond.loop, beyond.face ^ 1)) {
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
  std::vector<BlockFeatures> blocks_;
  std::vector<CellFeatures> sharp_;     ///< of each surface cell: loops with planes
  std::vector<CellFeatures> features_;  ///< of each surface cell
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
