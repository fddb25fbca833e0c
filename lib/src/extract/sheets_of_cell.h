#pragma once

#include <array>
#include <memory>
#include <optional>

#include "grid/samples.h"
#include "grid/volume.h"
#include "uniform/cell_topology.h"
#include "uniform/crease_cell.h"

namespace tufa::extraction {

/// Where the smooth sheets around a cell of a distance field meet, as dual contouring finds it, see
/// uniform::CreaseCell: the cubes around the cell tell their planes more exactly than its crossings
/// do, whose differences may reach across the kink of the field. For one thread.
class SheetsOfCell {
 public:
  explicit SheetsOfCell(const grid::Volume& volume)
      : volume_(volume), accessor_(volume.blocks.accessor()), finder_(samples_, volume.scale) {}

  /// To be called at each surface block. Samples are read when the first cell of it is asked for.
  void moveTo(const uniform::SurfaceBlock& block) {
    block_ = &block;
    gathered_ = false;
  }

  /// The corner or crease at a cell of the block; nothing where there is none. Points are in voxels
  /// from the middle of the cell.
  [[nodiscard]] std::optional<uniform::CreasePlacement> at(const std::array<int, 3>& cell,
                                                           const uniform::Vector& massPoint) {
    if (!gathered_) {
      samples_.gather(volume_.blocks, volume_.scale, block_->block, block_->neighbours, *accessor_);
      finder_.reset();
      gathered_ = true;
    }
    const uniform::CreasePlacement found = finder_.place(cell[0], cell[1], cell[2], massPoint);
    return found.planes >= 2 ? std::optional(found) : std::nullopt;
  }

 private:
  const grid::Volume& volume_;
  std::unique_ptr<grid::Accessor> accessor_;
  grid::BlockSamples samples_;
  uniform::CreaseCell finder_;
  const uniform::SurfaceBlock* block_ = nullptr;
  bool gathered_ = false;
};

}  // namespace tufa::extraction
