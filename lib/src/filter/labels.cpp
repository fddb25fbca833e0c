// Grids of labels.

#include <openvdb/openvdb.h>
#include <tufa/labels.h>

#include <tufa/error.h>
#include <algorithm>
#include <map>
#include <string>
#include <unordered_map>

#include "filter/integer_grid.h"
#include "grid/openvdb_templates.h"

namespace tufa {
namespace {

using openvdb::FloatGrid;
using FloatLeaf = openvdb::FloatTree::LeafNodeType;

/// Calls onLeaf(leaf) for all leaves and onTile(box, value) for all active tiles.
template <class GridT, class OnLeaf, class OnTile>
void forNodes(const GridT& grid, const OnLeaf& onLeaf, const OnTile& onTile) {
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) onLeaf(*leaf);
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) onTile(tile.getBoundingBox(), *tile);
}

/// The volumes of some labels while they are filled.
class Volumes {
 public:
  Volumes(const openvdb::GridBase& grid, const std::vector<std::int64_t>& labels) {
    for (const std::int64_t label : labels) {
      const auto volume = FloatGrid::create(0.0F);
      volume->setTransform(grid.transform().copy());
      volume->setGridClass(openvdb::GRID_FOG_VOLUME);
      volume->setName("label_" + std::to_string(label));
      if (!places_.emplace(label, volumes_.size()).second) {
        throw Error(ErrorCode::InvalidArgument,
                    "label " + std::to_string(label) + " is asked for twice");
      }
      volumes_.push_back(volume);
    }
  }

  template <class Leaf>
  void addLeaf(const Leaf& leaf) {
    FloatLeaf* made = nullptr;
    std::int64_t last = 0;
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
      // Neighbours mostly have one label.
      if (made == nullptr || *voxel != last) {
        const auto place = places_.find(*voxel);
        if (place == places_.end()) continue;
        last = *voxel;
        made = volumes_[place->second]->tree().touchLeaf(leaf.origin());
      }
      made->setValueOn(voxel.pos(), 1.0F);
    }
  }
  void addTile(const openvdb::CoordBBox& box, std::int64_t label) {
    const auto place = places_.find(label);
    if (place != places_.end()) volumes_[place->second]->tree().fill(box, 1.0F);
  }

  [[nodiscard]] const std::vector<FloatGrid::Ptr>& all() const { return volumes_; }

 private:
  std::unordered_map<std::int64_t, std::size_t> places_;
  std::vector<FloatGrid::Ptr> volumes_;
};

}  // namespace

std::vector<LabelCount> labelsIn(const openvdb::GridBase& grid) {
  std::map<std::int64_t, std::size_t> counts;
  const auto add = [&](std::int64_t label, std::size_t voxels) {
    constexpr std::size_t kMost = 1000000;
    if (label == 0) return;
    counts[label] += voxels;
    if (counts.size() <= kMost) return;
    throw Error(ErrorCode::LimitExceeded, "grid \"" + grid.getName() + "\" has more than " +
                                              std::to_string(kMost) + " labels");
  };
  filter::withIntegers(grid, [&](const auto& typed) {
    forNodes(
        typed,
        [&](const auto& leaf) {
          // A run of equal values at a time.
          std::int64_t label = 0;
          std::size_t run = 0;
          for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            if (*voxel != label) {
              add(label, run);
              label = *voxel;
              run = 0;
            }
            ++run;
          }
          add(label, run);
        },
        [&](const openvdb::CoordBBox& box, std::int64_t label) { add(label, box.volume()); });
  });
  std::vector<LabelCount> labels;
  labels.reserve(counts.size());
  for (const auto& [label, voxels] : counts) labels.push_back({label, voxels});
  return labels;
}

std::vector<openvdb::GridBase::Ptr> labelVolumes(const openvdb::GridBase& grid,
                                                 const std::vector<std::int64_t>& labels) {
  Volumes volumes(grid, labels);
  filter::withIntegers(grid, [&](const auto& typed) {
    forNodes(
        typed, [&](const auto& leaf) { volumes.addLeaf(leaf); },
        [&](const openvdb::CoordBBox& box, std::int64_t label) { volumes.addTile(box, label); });
  });
  return {volumes.all().begin(), volumes.all().end()};
}

}  // namespace tufa
