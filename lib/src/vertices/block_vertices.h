#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "blocks/field.h"
#include "blocks/samples.h"
#include "components/topology.h"
#include "creases/crease_cell.h"
#include "creases/vertex_sides.h"
#include "crossings/crossings.h"
#include "qef/qef.h"

namespace tufa::vertices {

/// Gathers the QEFs of one block's vertices and solves them. Made once for each range of blocks and
/// used again for each block, so that its arrays stay in the cache.
class BlockVertices {
 public:
  explicit BlockVertices(const blocks::FieldScale& scale)
      : scale_(scale), finder_(samples_, scale), creaseCell_(samples_, scale) {}

  /// Fills the results below for one block.
  template <class TreeT>
  void place(const blocks::Blocks<TreeT>& blocks, const components::Topology& topology,
             const components::SurfaceBlock& block,
             typename blocks::Blocks<TreeT>::Accessor& accessor);

  /// The first half of place(): what massPoint() needs.
  template <class TreeT>
  void gather(const blocks::Blocks<TreeT>& blocks, const components::Topology& topology,
              const components::SurfaceBlock& block,
              typename blocks::Blocks<TreeT>::Accessor& accessor);

  /// Surface cell of each vertex of the block, in their order.
  [[nodiscard]] const std::vector<std::uint16_t>& cells() const { return cells_; }
  /// Each vertex, in voxels from the middle of its cell.
  [[nodiscard]] const std::vector<qef::Vector>& points() const { return points_; }
  /// The mean of the crossings of a vertex, in voxels from the block's first lattice point.
  [[nodiscard]] qef::Vector massPoint(std::size_t vertex) const {
    return qefs_[vertex + 1].massPoint();
  }
  /// The sum of the normals gathered at each vertex, in index space.
  [[nodiscard]] const std::vector<qef::Vector>& normals() const { return normals_; }
  /// A vertex on a crease or corner, and the normals of the sides that meet there, in index space.
  struct Meeting {
    std::uint32_t vertex;
    int count;
    std::array<qef::Vector, 3> normals;
  };
  [[nodiscard]] const std::vector<Meeting>& meetings() const { return meetings_; }
  /// Vertices of the block that may lie outside of their cells.
  [[nodiscard]] const std::vector<std::uint32_t>& strays() const { return strays_; }
  /// Each vertex's relation to creases.
  [[nodiscard]] const std::vector<creases::VertexSides::Kind>& kinds() const { return kinds_; }

 private:
  // Samples and cells are numbered alike, by BlockSamples::index() of a cell's first corner.
  static constexpr int kSlots = blocks::BlockSamples::kSize * blocks::BlockSamples::kStrideX;
  // Among qefs_: what belongs to cells outside of the block goes there. Vertex i is at i + 1.
  static constexpr std::uint16_t kNobody = 0;
  static constexpr int kMostEdges =
      blocks::kBlockSize * (blocks::kBlockSize + 1) * (blocks::kBlockSize + 1);

  void numberVertices(const components::Topology& topology, const components::SurfaceBlock& block,
                      const blocks::CornerWords& corners);
  template <int axis>
  void addEdges(const blocks::CornerWords& corners);
  template <int axis>
  void collectEdges(const blocks::CornerWords& corners);
  template <int axis>
  void addCrossing(int slot, const qef::Qef& plane, bool crease);
  void solveVertices();
  void placeAtCrease(std::size_t vertex);

  const blocks::FieldScale& scale_;
  blocks::BlockSamples samples_;
  crossings::CrossingFinder finder_;
  creases::CreaseCell creaseCell_;
  bool special_ = false;
  std::array<std::uint16_t, kSlots> firstVertexOf_{};          ///< kNobody, or number + 1
  std::array<components::Components, kSlots> componentsOf_{};  ///< if special_
  std::array<std::uint16_t, kSlots> cutEdgesOf_{};             ///< if special_
  std::array<std::uint16_t, kMostEdges + crossings::CrossingBatch::kSize> edges_;  ///< slots
  int edgeCount_ = 0;
  std::array<qef::Qef, crossings::CrossingBatch::kSize> planes_;  ///< of the batch at hand
  std::vector<std::uint16_t> cells_;
  std::vector<qef::Vector> centers_;  ///< middle of each vertex's cell
  std::vector<qef::Qef> qefs_;
  std::vector<creases::VertexSides::Kind> kinds_;
  std::vector<Meeting> meetings_;
  std::vector<std::uint32_t> strays_;
  std::vector<qef::Vector> points_;
  std::vector<qef::Vector> normals_;
};

}  // namespace tufa::vertices
