// Connected components of the inside. OpenVDB's own segmentation makes a tree for each, hundreds of
// kilobytes, of which the dust of one CT scan has tens of thousands: here all share one tree of
// labels.

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/steps.h"

namespace tufa::filter {
namespace {

using openvdb::CoordBBox;
using Label = std::int32_t;  ///< from 1; 0: outside
using LabelTree = openvdb::Int32Tree;
using LabelLeaf = LabelTree::LeafNodeType;

constexpr std::array<std::array<int, 3>, 6> kSteps = {
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

openvdb::Coord neighbour(const openvdb::Coord& at, std::size_t side) {
  return at.offsetBy(kSteps[side][0], kSteps[side][1], kSteps[side][2]);
}

/// Sets of labels, joined at their roots (Tarjan 1975); the root is the least label.
class LabelSets {
 public:
  Label add(std::uint64_t voxels) {
    parents_.push_back(static_cast<Label>(parents_.size()));
    voxels_.push_back(voxels);
    return parents_.back();
  }
  void addVoxel(Label label) { ++voxels_[static_cast<std::size_t>(label)]; }

  [[nodiscard]] Label root(Label label) {
    auto at = static_cast<std::size_t>(label);
    while (parents_[at] != static_cast<Label>(at)) {
      parents_[at] = parents_[static_cast<std::size_t>(parents_[at])];
      at = static_cast<std::size_t>(parents_[at]);
    }
    return static_cast<Label>(at);
  }

  void join(Label a, Label b) {
    const auto [least, other] = std::minmax({root(a), root(b)});
    if (least == other) return;
    parents_[static_cast<std::size_t>(other)] = least;
    voxels_[static_cast<std::size_t>(least)] += voxels_[static_cast<std::size_t>(other)];
  }

  [[nodiscard]] std::uint64_t voxels(Label root) const {
    return voxels_[static_cast<std::size_t>(root)];
  }

  /// All roots, those of the most voxels first.
  [[nodiscard]] std::vector<Label> roots() const {
    std::vector<Label> roots;
    for (std::size_t i = 1; i < parents_.size(); ++i) {
      if (parents_[i] == static_cast<Label>(i)) roots.push_back(parents_[i]);
    }
    std::stable_sort(roots.begin(), roots.end(),
                     [&](Label a, Label b) { return voxels(a) > voxels(b); });
    return roots;
  }

  [[nodiscard]] std::size_t size() const { return parents_.size(); }

 private:
  std::vector<Label> parents_{0};
  std::vector<std::uint64_t> voxels_{0};
};

/// Labels the inside of a grid.
template <class GridT>
class Labelling {
 public:
  Labelling(const GridT& grid, const grid::IsoChoice& iso, ProgressInterrupter& interrupter)
      : iso_(iso), interrupter_(interrupter) {
    labelTiles(grid.tree());
    labelLeaves(grid.tree());
    joinLeaves();
    joinTiles();
  }

  LabelSets& sets() { return sets_; }
  LabelTree& labels() { return labels_; }
  const std::vector<CoordBBox>& tiles() const { return tiles_; }

 private:
  template <class Value>
  [[nodiscard]] bool isInside(Value value) const {
    return grid::isInside(static_cast<double>(value), iso_);
  }

  void labelTiles(const typename GridT::TreeType& tree) {
    auto value = tree.cbeginValueAll();
    value.setMaxDepth(decltype(value)::LEAF_DEPTH - 1);
    for (; value; ++value) {
      if (!isInside(*value)) continue;
      const CoordBBox box = value.getBoundingBox();
      labels_.fill(box, sets_.add(box.volume()));
      tiles_.push_back(box);
    }
  }

  void labelLeaves(const typename GridT::TreeType& tree) {
    std::size_t done = 0;
    for (auto leaf = tree.cbeginLeaf(); leaf && !interrupter_.cancelled(); ++leaf) {
      pollInterrupter(done++);
      labelLeaf(*leaf);
    }
  }

  /// Labels the parts of a leaf's inside, each by a flood from its first voxel.
  template <class Leaf>
  void labelLeaf(const Leaf& leaf) {
    LabelLeaf* labels = nullptr;
    for (openvdb::Index first = 0; first < Leaf::SIZE; ++first) {
      if (!isInside(leaf.getValue(first))) continue;
      if (labels == nullptr) labels = labels_.touchLeaf(leaf.origin());
      if (labels->getValue(first) != 0) continue;
      const Label label = sets_.add(0);
      labels->setValueOn(first, label);
      flood_.assign(1, first);
      while (!flood_.empty()) {
        const openvdb::Coord at = Leaf::offsetToLocalCoord(flood_.back());
        flood_.pop_back();
        sets_.addVoxel(label);
        for (std::size_t side = 0; side < kSteps.size(); ++side) {
          const openvdb::Coord next = neighbour(at, side);
          if (!isLocal(next)) continue;
          const openvdb::Index offset = Leaf::coordToOffset(next);
          if (labels->getValue(offset) != 0 || !isInside(leaf.getValue(offset))) continue;
          labels->setValueOn(offset, label);
          flood_.push_back(offset);
        }
      }
    }
  }

  static bool isLocal(const openvdb::Coord& at) {
    constexpr int kDim = LabelLeaf::DIM;
    return at[0] >= 0 && at[0] < kDim && at[1] >= 0 && at[1] < kDim && at[2] >= 0 && at[2] < kDim;
  }

  /// Joins what meets across the sides of leaves: with leaves, and with tiles.
  void joinLeaves() {
    openvdb::tree::ValueAccessor<const LabelTree> accessor(labels_);
    std::size_t done = 0;
    for (auto leaf = labels_.cbeginLeaf(); leaf && !interrupter_.cancelled(); ++leaf) {
      pollInterrupter(done++);
      for (openvdb::Index i = 0; i < LabelLeaf::SIZE; ++i) {
        const Label label = leaf->getValue(i);
        if (label == 0) continue;
        const openvdb::Coord local = LabelLeaf::offsetToLocalCoord(i);
        for (std::size_t side = 0; side < kSteps.size(); ++side) {
          const openvdb::Coord next = neighbour(local, side);
          if (isLocal(next)) continue;
          const Label other = accessor.getValue(leaf->origin() + next);
          if (other != 0) sets_.join(label, other);
        }
      }
    }
  }

  /// Joins tiles that meet: all lie at multiples of a leaf's width.
  void joinTiles() {
    openvdb::tree::ValueAccessor<const LabelTree> accessor(labels_);
    constexpr int kStride = LabelLeaf::DIM;
    std::size_t done = 0;
    for (const CoordBBox& tile : tiles_) {
      if (interrupter_.cancelled()) return;
      const Label label = accessor.getValue(tile.min());
      for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        openvdb::Coord at = tile.min();
        at[axis] = tile.max()[axis] + 1;
        for (at[u] = tile.min()[u]; at[u] <= tile.max()[u]; at[u] += kStride) {
          pollInterrupter(done++);
          for (at[v] = tile.min()[v]; at[v] <= tile.max()[v]; at[v] += kStride) {
            // Of a leaf this is one voxel of many, which were joined from there.
            const Label other = accessor.getValue(at);
            if (other != 0) sets_.join(label, other);
          }
        }
      }
    }
  }

  void pollInterrupter(std::size_t done) {
    constexpr std::size_t kBetween = 1024;
    if (done % kBetween == 0) interrupter_.wasInterrupted();
  }

  const grid::IsoChoice& iso_;
  ProgressInterrupter& interrupter_;
  LabelTree labels_{0};
  LabelSets sets_;
  std::vector<CoordBBox> tiles_;
  std::vector<openvdb::Index> flood_;
};

// Labels of voxels outside.
constexpr Label kStaysNear = -1;  ///< in the band of a component that stays
constexpr Label kGoesNear = -2;   ///< in that of one that goes

/// Which components stay, by the label of any of their voxels.
class Verdict {
 public:
  Verdict(LabelSets& sets, std::vector<bool> stays) : sets_(sets), stays_(std::move(stays)) {}
  [[nodiscard]] bool goes(Label label) const {
    return label > 0 && !stays_[static_cast<std::size_t>(sets_.root(label))];
  }

 private:
  LabelSets& sets_;
  std::vector<bool> stays_;
};

/// Shares the band of a level set outside among what stays and what goes, from the surfaces
/// outward, a voxel at a time; what stays comes first. A distance to what went would make it come
/// back where the surface is moved outward.
template <class GridT>
class BandShares {
 public:
  BandShares(const GridT& grid, LabelTree& labels) : active_(grid.tree()), labels_(labels) {}

  void share(const Verdict& verdict, ProgressInterrupter& interrupter) {
    std::vector<openvdb::Coord> stays, goes;
    for (auto label = std::as_const(tree()).cbeginValueOn(); label; ++label) {
      if (!label.isVoxelValue()) continue;
      (verdict.goes(*label) ? goes : stays).push_back(label.getCoord());
    }
    while (!stays.empty() || !goes.empty()) {
      if (interrupter.wasInterrupted()) return;
      stays = claimAround(stays, kStaysNear);
      goes = claimAround(goes, kGoesNear);
    }
  }

 private:
  LabelTree& tree() { return labels_.tree(); }

  std::vector<openvdb::Coord> claimAround(const std::vector<openvdb::Coord>& front, Label label) {
    std::vector<openvdb::Coord> claimed;
    for (const openvdb::Coord& at : front) {
      for (std::size_t side = 0; side < kSteps.size(); ++side) {
        const openvdb::Coord next = neighbour(at, side);
        if (labels_.getValue(next) != 0 || !active_.isValueOn(next)) continue;
        labels_.setValueOnly(next, label);
        claimed.push_back(next);
      }
    }
    return claimed;
  }

  openvdb::tree::ValueAccessor<const typename GridT::TreeType> active_;
  openvdb::tree::ValueAccessor<LabelTree> labels_;
};

/// Gives the background to all voxels whose component does not stay. What was active stays so, but
/// in level sets.
template <class GridT>
void clear(GridT& grid, Labelling<GridT>& labelling, const Verdict& verdict,
           ProgressInterrupter& interrupter) {
  const auto background = grid.background();
  const bool levelSet = grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  if (levelSet) BandShares<GridT>(grid, labelling.labels()).share(verdict, interrupter);
  openvdb::tree::ValueAccessor<const LabelTree> accessor(labelling.labels());
  for (const CoordBBox& tile : labelling.tiles()) {
    if (!verdict.goes(accessor.getValue(tile.min()))) continue;
    const bool active = !levelSet && grid.tree().isValueOn(tile.min());
    grid.tree().fill(tile, background, active);
  }
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf) {
    const auto* labels = std::as_const(labelling.labels()).probeConstLeaf(leaf->origin());
    if (labels == nullptr) continue;
    for (openvdb::Index i = 0; i < LabelLeaf::SIZE; ++i) {
      const Label label = labels->getValue(i);
      if (label != kGoesNear && !verdict.goes(label)) continue;
      leaf->setValueOnly(i, background);
      if (levelSet) leaf->setValueOff(i);
    }
  }
}

}  // namespace

template <class GridT>
Components keepComponents(GridT& grid, const ComponentRule& rule, const grid::IsoChoice& iso,
                          ProgressInterrupter& interrupter) {
  if (grid::isInside(static_cast<double>(grid.background()), iso)) {
    throw Error(ErrorCode::UnsupportedGrid,
                "the background of grid \"" + grid.getName() +
                    "\" is inside, so its components have no end; give an isovalue or a side");
  }
  Labelling<GridT> labelling(grid, iso, interrupter);
  if (interrupter.cancelled()) return {};
  const std::vector<Label> roots = labelling.sets().roots();
  std::vector<bool> stays(labelling.sets().size());
  Components components{roots.size(), 0};
  for (const Label root : roots) {
    if (components.kept == rule.most || labelling.sets().voxels(root) < rule.voxels) break;
    stays[static_cast<std::size_t>(root)] = true;
    ++components.kept;
  }
  if (components.kept < components.found) {
    clear(grid, labelling, Verdict(labelling.sets(), std::move(stays)), interrupter);
  }
  return components;
}

#define TUFA_STEPS(GridT)                                                                  \
  template Components keepComponents(GridT&, const ComponentRule&, const grid::IsoChoice&, \
                                     ProgressInterrupter&)
TUFA_STEPS(openvdb::FloatGrid);
TUFA_STEPS(openvdb::DoubleGrid);
#undef TUFA_STEPS

}  // namespace tufa::filter
