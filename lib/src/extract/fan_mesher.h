#pragma once

#include <utility>
#include <vector>

#include "base/huge_pages.h"
#include "extract/cell_walk.h"
#include "extract/cube_mesher.h"
#include "extract/loop_crossings.h"
#include "extract/sharp_loops.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

/// Vertices on arcs of the faces at the lower ends of cells. There may be none at all.
struct ArcPoints {
  std::vector<CellFeatures> cells;           ///< of each surface cell, numbers in its block
  std::vector<std::vector<Feature>> blocks;  ///< of each surface block
};

/// Adds the triangles of all cells to a mesh of their crossings: a fan around the feature of each
/// loop that has one, and what its case tells for any other loop. The vertices that a block adds
/// are numbered in this order: points of arcs, features of loops, means of other loops.
class FanMesher {
 public:
  FanMesher(const grid::Volume& volume, const CubeCells& cells, SharpLoops& loops, Mesh& mesh,
            base::Job& job)
      : volume_(volume), cells_(cells), loops_(loops), mesh_(mesh), job_(job) {}

  /// `walk(cell, edge, body)` calls body(vertex) for each vertex to which a fan goes on from the
  /// crossing of an edge of its loop, the last one in place of the next crossing; steps(cell, edge)
  /// tells how many. When it is called, `loops` and `points` have the numbers of vertices in place
  /// of those in their blocks.
  template <class Steps, class Walk>
  void run(ArcPoints& points, double trianglesEnd, const Steps& steps, const Walk& walk) {
    counts_.resize(cells_.topology.blocks.size());
    walkCells(cells_, job_,
              [&](const WalkedCell& cell) { count(cell, counts_[cell.place.block], steps); });
    number(points);
    job_.beginStage("triangles", trianglesEnd);
    base::resizeLarge(mesh_.triangles, triangleCount_, job_);
    emit(walk);
  }

  [[nodiscard]] std::size_t featureCount() const { return featureCount_; }

 private:
  struct BlockCounts {
    std::uint64_t firstTriangle = 0;
    std::uint64_t firstVertex = 0;  ///< then, of emit(), that of the next mean
    std::uint32_t triangles = 0;
    std::uint32_t means = 0;
  };

  template <class Steps>
  void count(const WalkedCell& cell, BlockCounts& own, const Steps& steps) const {
    const CubeCase& chosen = cell.cubeCase();
    const CellFeatures& loops = loops_.cells[cell.place.cell];
    if (loops.parts == 0) {
      own.means += chosen.centreCount;
      own.triangles += chosen.count;
      return;
    }
    own.means += hasCentre(chosen, loops) ? 1 : 0;
    for (int i = 0; i < chosen.count; ++i) own.triangles += isKept(chosen, i, loops) ? 1 : 0;
    forFans(chosen, loops,
            [&](int, int edge) { own.triangles += static_cast<std::uint32_t>(steps(cell, edge)); });
  }

  // Calls body(loop, edge) for the crossings of each loop with a feature.
  template <class Body>
  static void forFans(const CubeCase& chosen, const CellFeatures& loops, const Body& body) {
    for (int loop = 0; loops.parts != 0 && loop < chosen.loopCount; ++loop) {
      if (loops.has(loop)) forLoop(chosen, loop, [&](int edge) { body(loop, edge); });
    }
  }

  void number(ArcPoints& points) {
    std::uint64_t vertices = cells_.edgeCount;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      job_.pollCancelled(i);
      BlockCounts& own = counts_[i];
      own.firstVertex = vertices;
      own.firstTriangle = triangleCount_;
      if (!points.blocks.empty()) vertices += points.blocks[i].size();
      vertices += loops_.blocks[i].size() + own.means;
      triangleCount_ += own.triangles;
      featureCount_ += loops_.blocks[i].size();
    }
    uniform::requireIndexable(vertices);
    base::resizeLarge(mesh_.positions, vertices, job_);
    base::resizeLarge(mesh_.normals, vertices, job_);
    job_.forRanges(counts_.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!points.blocks.empty()) {
          write(points, i, [](const Feature& point) -> const Feature& { return point; });
        }
        write(loops_, i, [](const LoopFeature& loop) -> const Feature& { return loop.vertex; });
      }
    });
  }

  // Writes the points or features of a block as its next vertices.
  template <class Parts, class VertexOf>
  void write(Parts& parts, std::size_t i, const VertexOf& vertexOf) {
    const uniform::SurfaceBlock& block = cells_.topology.blocks[i];
    std::uint64_t& vertex = counts_[i].firstVertex;
    for (std::uint32_t cell = 0; cell < block.cellCount; ++cell) {
      parts.cells[block.firstVertex + cell].first += static_cast<VertexIndex>(vertex);
    }
    for (const auto& part : parts.blocks[i]) {
      mesh_.positions[vertex] = vertexOf(part).position;
      mesh_.normals[vertex++] = vertexOf(part).normal;
    }
  }

  template <class Walk>
  void emit(const Walk& walk) {
    // Of each block where its next triangle goes. A block is done by one thread.
    std::vector<Triangle*> next(counts_.size());
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] = mesh_.triangles.data() + counts_[i].firstTriangle;
    }
    walkCells(cells_, job_, [&](const WalkedCell& cell) {
      emit(cell, next[cell.place.block], counts_[cell.place.block].firstVertex, walk);
    });
  }

  template <class Walk>
  void emit(const WalkedCell& cell, Triangle*& triangle, std::uint64_t& mean, const Walk& walk) {
    const CubeCase& chosen = cell.cubeCase();
    const CellFeatures& loops = loops_.cells[cell.place.cell];
    const CubeTable& table = cell.table();
    const int place = cell.tablePlace();
    const bool mirrored = volume_.affine.mirrored();
    const auto add = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
      *triangle++ = mirrored ? Triangle(a, c, b) : Triangle(a, b, c);
    };
    const auto at = [&](int edge) {
      return edge < kEdges ? table[place + kEdgeOffsets[edge]] : static_cast<VertexIndex>(mean);
    };
    for (int t = 0; t < chosen.count; ++t) {
      const auto& [a, b, c] = chosen.triangles[t];
      if (isKept(chosen, t, loops)) add(at(a), at(b), at(c));
    }
    forFans(chosen, loops, [&](int loop, int edge) {
      VertexIndex from = at(edge);
      walk(cell, edge, [&](VertexIndex to) {
        add(from, to, loops.of(loop));
        from = to;
      });
    });
    if (!hasCentre(chosen, loops)) return;
    placeCentre(chosen.aroundCentre[0], place, table, static_cast<VertexIndex>(mean++), mesh_);
  }

  const grid::Volume& volume_;
  const CubeCells& cells_;
  SharpLoops& loops_;
  Mesh& mesh_;
  base::Job& job_;
  std::vector<BlockCounts> counts_;  ///< of each surface block
  std::uint64_t triangleCount_ = 0;
  std::size_t featureCount_ = 0;
};

}  // namespace tufa::extraction
