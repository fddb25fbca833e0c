#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "grid/field.h"
#include "grid/samples.h"
#include "uniform/cell_topology.h"
#include "uniform/crease_cell.h"
#include "uniform/crossings.h"
#include "uniform/qef.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// Gathers the QEFs of one block's vertices and solves them. One object serves a range of blocks,
/// so its arrays stay in the cache.
class BlockVertices {
 public:
  explicit BlockVertices(const grid::FieldScale& scale)
      : scale_(scale), finder_(samples_, scale), creaseCell_(samples_, scale) {}

  /// Computes the results below for one block.
  void place(const grid::Blocks& blocks, const CellTopology& topology, const SurfaceBlock& block,
             grid::Accessor& accessor);

  /// The first half of place(): what massPoint() and plainPoint() need.
  void gather(const grid::Blocks& blocks, const CellTopology& topology, const SurfaceBlock& block,
              grid::Accessor& accessor);
  /// The same for some of the block's vertices alone, counted inside it.
  void gatherFor(std::span<const VertexIndex> vertices, const grid::Blocks& blocks,
                 const CellTopology& topology, const SurfaceBlock& block, grid::Accessor& accessor);

  /// Surface cell of each vertex of the block, in their order.
  [[nodiscard]] const std::vector<std::uint16_t>& cells() const { return cells_; }
  /// Each vertex, in voxels from the middle of its cell.
  [[nodiscard]] const std::vector<Vector>& points() const { return points_; }
  /// The mean of the crossings of a vertex, in voxels from the block's first lattice point.
  [[nodiscard]] Vector massPoint(std::size_t vertex) const { return qefs_[vertex + 1].massPoint(); }
  /// The sum of the normals at the crossings of a vertex, in index space.
  [[nodiscard]] Vector normalSum(std::size_t vertex) const { return qefs_[vertex + 1].normals; }
  /// The point that a vertex's QEF alone gives, in voxels from the middle of its cell.
  [[nodiscard]] Vector plainPoint(std::size_t vertex) const;
  /// The sum of the normals gathered at each vertex, in index space.
  [[nodiscard]] const std::vector<Vector>& normals() const { return normals_; }
  /// A vertex on a crease or corner, and the normals of the sheets that meet there, in index space.
  struct Meeting {
    std::uint32_t vertex;
    int count;
    std::array<Vector, 3> normals;
  };
  [[nodiscard]] const std::vector<Meeting>& meetings() const { return meetings_; }
  /// Vertices of the block that may lie out of their cells.
  [[nodiscard]] const std::vector<std::uint32_t>& outOfCell() const { return outOfCell_; }
  /// Each vertex's relation to creases.
  [[nodiscard]] const std::vector<VertexSheets::Kind>& kinds() const { return kinds_; }

 private:
  // Samples and cells are numbered alike, by BlockSamples::index() of a cell's first corner.
  static constexpr int kSlots = grid::BlockSamples::kSize * grid::BlockSamples::kStrideX;
  // Among qefs_: collects the planes of cells outside the block and is never solved. Vertex i is at
  // i + 1.
  static constexpr std::uint16_t kNobody = 0;
  static constexpr int kMostEdges =
      grid::kBlockSize * (grid::kBlockSize + 1) * (grid::kBlockSize + 1);

  void addAllEdges(const grid::CornerWords& corners);
  void numberVertices(const CellTopology& topology, const SurfaceBlock& block,
                      const grid::CornerWords& corners);
  template <int axis>
  void addEdges(const grid::CornerWords& corners);
  template <int axis>
  void collectEdges(const grid::CornerWords& corners);
  template <int axis>
  void dropEdgesOfNobody();
  template <int axis>
  void addCrossing(int slot, const Qef& plane, Kink kink);
  void solveVertices(const Coord& origin, grid::Accessor& accessor);
  void placeAtCrease(std::size_t vertex);

  const grid::FieldScale& scale_;
  grid::BlockSamples samples_;
  CrossingFinder finder_;
  CreaseCell creaseCell_;
  bool special_ = false;
  bool isPart_ = false;  ///< not all cells have a vertex in firstVertexOf_
  std::array<std::uint16_t, kSlots> firstVertexOf_{};                   ///< kNobody, or number + 1
  std::array<Components, kSlots> componentsOf_{};                       ///< if special_
  std::array<std::uint16_t, kSlots> openEdgesOf_{};                     ///< if special_
  std::array<std::uint16_t, kMostEdges + CrossingBatch::kSize> edges_;  ///< slots
  int edgeCount_ = 0;
  std::array<Qef, CrossingBatch::kSize> planes_;  ///< of the batch at hand
  std::vector<std::uint16_t> cells_;
  std::vector<Vector> centers_;  ///< middle of each vertex's cell
  std::vector<Qef> qefs_;
  std::vector<VertexSheets::Kind> kinds_;
  std::vector<Meeting> meetings_;
  std::vector<std::uint32_t> outOfCell_;
  std::vector<Vector> points_;
  std::vector<Vector> normals_;
};

}  // namespace tufa::uniform
