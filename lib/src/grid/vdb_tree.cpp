#include <openvdb/openvdb.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include "base/coord_table.h"
#include "base/huge_pages.h"
#include "grid/node_accessor.h"
#include "grid/node_tiles.h"
#include "grid/non_finite.h"
#include "grid/openvdb_templates.h"
#include "grid/samples.h"
#include "grid/tile_contacts.h"
#include "grid/tile_surface.h"
#include "grid/tree.h"
#include "grid/vdb_coord.h"

namespace tufa::grid {
namespace {

// The value v such that "below v" (or "above v") in T means the same as below (above) the isovalue.
template <class T>
T threshold(const IsoChoice& iso) {
  const T rounded = static_cast<T>(iso.isovalue);
  const T infinity = std::numeric_limits<T>::infinity();
  if (iso.insideIsBelow) {
    return rounded < iso.isovalue ? std::nextafter(rounded, infinity) : rounded;
  }
  return rounded > iso.isovalue ? std::nextafter(rounded, -infinity) : rounded;
}

// Side bits of 512 samples. Bytes first, then eight bytes to eight bits by one multiplication: the
// compiler vectorizes the first part and the second is short.
template <bool kBelow, class T>
void packSides(const T* values, T limit, BlockBits& bits) {
  constexpr std::uint64_t kGather = 0x0102040810204080u;
  for (int slab = 0; slab < kBlockSize; ++slab) {
    alignas(64) std::array<std::uint8_t, 64> sides;
    const T* from = values + slab * 64;
    for (int i = 0; i < 64; ++i) sides[i] = kBelow ? from[i] < limit : from[i] > limit;
    std::uint64_t word = 0;
    for (int row = 0; row < 8; ++row) {
      std::uint64_t bytes;
      std::memcpy(&bytes, &sides[row * 8], 8);
      word |= ((bytes * kGather) >> 56) << (row * 8);
    }
    bits.slabs[slab] = word;
  }
}

template <class T>
bool allFinite(const T* values) {
  // x * 0 is 0 for finite x and NaN otherwise; NaN stays in a sum.
  std::array<T, 16> sums{};
  for (int i = 0; i < kBlockCells; i += 16) {
    for (int lane = 0; lane < 16; ++lane) sums[lane] += values[i + lane] * T(0);
  }
  T sum = 0;
  for (const T lane : sums) sum += lane;
  return sum == T(0);
}

// The samples of one block: those of a leaf, or eight equal ones that stand for each row of a tile.
template <class T>
struct Source {
  const T* values = nullptr;
  int mask = 0;  // keeps the row's part of an index in a leaf, drops it in a tile
  std::array<T, kBlockSize> tileRow;

  [[nodiscard]] const T* row(int first) const { return values + (first & mask); }
};

/// Keeps a finite value finite and on its side: the sides of samples were read before they are
/// scaled, and those that are not finite are taken as outside. Beyond 10^30 only the side is left.
template <class T>
float scaled(T value, T isovalue, T factor) {
  constexpr T kMost = static_cast<T>(1e30);
  const T size = (value - isovalue) * factor;
  const T bounded = size < -kMost ? -kMost : kMost < size ? kMost : size;
  // 0 for a finite value, else not a number.
  return static_cast<float>(bounded + value * T(0));
}

/// Values of some leaves, beside a tree that holds none.
template <class T>
class LoadedLeaves {
 public:
  void reserve(std::size_t leaves, base::Job& job) {
    base::resizeLarge(values_, leaves * kBlockCells, job);
    places_.reserve(leaves);
  }
  /// Room for the values of one leaf more.
  T* add(const Coord& origin) {
    places_.tryEmplace(origin, count_);
    return &values_[kBlockCells * count_++];
  }
  /// Null where none has been added.
  [[nodiscard]] const T* find(const Coord& at) const {
    const std::uint32_t place = places_.find(at & ~(kBlockSize - 1));
    return place == base::CoordTable::kNone ? nullptr : &values_[place * std::size_t{kBlockCells}];
  }

 private:
  std::vector<T> values_;
  base::CoordTable places_;
  std::uint32_t count_ = 0;
};

template <class TreeT>
class VdbAccessor final : public Accessor {
  using T = typename TreeT::ValueType;

 public:
  /// `loaded`: null if the tree holds all values.
  VdbAccessor(const TreeT& tree, const std::vector<const T*>& values, const LoadedLeaves<T>* loaded)
      : accessor_(tree), values_(values), loaded_(loaded) {}

  double value(const Coord& at) override {
    if (loaded_ != nullptr) {
      if (const T* leaf = loaded_->find(at))
        return leaf[cellIndex(at[0] & 7, at[1] & 7, at[2] & 7)];
    }
    return accessor_.getValue(toVdb(at));
  }
  bool isActive(const Coord& at) override { return accessor_.isValueOn(toVdb(at)); }

  void gather(const std::array<LeafRef, 27>& leaves, const Coord& origin, const FieldScale& scale,
              float* samples) override {
    std::array<Source<T>, 27> sources;
    for (int i = 0; i < 27; ++i) {
      Source<T>& source = sources[i];
      source.mask = ~0;
      if (leaves[i] != kNoLeaf) {
        source.values = values_[leaves[i]];
        continue;
      }
      const Coord there = origin.offsetBy((i / 9 - 1) * kBlockSize, (i / 3 % 3 - 1) * kBlockSize,
                                          (i % 3 - 1) * kBlockSize);
      source.tileRow.fill(accessor_.getValue(toVdb(there)));
      source.values = source.tileRow.data();
      source.mask = 0;
    }
    // Copied first, and scaled all at once, which the compiler vectorizes.
    std::array<T, BlockSamples::kCount> values;
    for (int x = -1; x <= kBlockSize + 1; ++x) {
      for (int y = -1; y <= kBlockSize + 1; ++y) {
        const Source<T>* along = &sources[neighbourIndex(x >> 3, y >> 3, -1)];
        const int first = cellIndex(x & 7, y & 7, 0);
        const T* below = along[0].row(first);
        const T* here = along[1].row(first);
        const T* above = along[2].row(first);
        T* const to = &values[static_cast<std::size_t>(BlockSamples::index(x, y, -1))];
        to[0] = below[kBlockSize - 1];
        std::copy_n(here, kBlockSize, to + 1);
        to[9] = above[0];
        to[10] = above[1];
      }
    }
    const T isovalue = static_cast<T>(scale.isovalue);
    const T factor = static_cast<T>(scale.factor);
    for (std::size_t i = 0; i < values.size(); ++i)
      samples[i] = scaled(values[i], isovalue, factor);
  }

 private:
  NodeAccessor<TreeT> accessor_;
  const std::vector<const T*>& values_;
  const LoadedLeaves<T>* loaded_;
};

template <class TreeT>
class VdbTree final : public Tree {
  using T = typename TreeT::ValueType;
  using Leaf = typename TreeT::LeafNodeType;
  using UpperNode = typename TreeT::RootNodeType::ChildNodeType;
  using Node = typename UpperNode::ChildNodeType;
  static_assert(Leaf::LOG2DIM == 3 && Node::LOG2DIM == BlockPlaces::kNodeBits);

 public:
  VdbTree(std::string gridName, const TreeT& tree, base::LeafSource* source, base::Job& job)
      : gridName_(std::move(gridName)), tree_(tree), source_(source) {
    tree.getNodes(leaves_);
    base::resizeLarge(values_, leaves_.size(), job);
    if (source_ != nullptr) return;
    job.forRanges(leaves_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        values_[i] = leaves_[i]->buffer().data();  // may load them: delayed by OpenVDB
      }
    });
  }

  /// The part of another one.
  VdbTree(const VdbTree& whole, const Slab& slab, base::Job& job)
      : gridName_(whole.gridName_), tree_(whole.tree_), leaves_(whole.leaves_) {
    std::vector<std::size_t> inside;
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (slab.contains(leafOrigin(static_cast<LeafRef>(i)))) inside.push_back(i);
    }
    base::resizeLarge(values_, leaves_.size(), job);
    loaded_ = std::make_unique<LoadedLeaves<T>>();
    loaded_->reserve(inside.size(), job);
    for (std::size_t n = 0; n < inside.size(); ++n) {
      job.checkCancelled(n, inside.size());
      T* const values = loaded_->add(leafOrigin(static_cast<LeafRef>(inside[n])));
      whole.source_->read(inside[n], values);
      values_[inside[n]] = values;
    }
  }

  [[nodiscard]] const std::string& gridName() const override { return gridName_; }
  [[nodiscard]] bool isInMemory() const override { return source_ == nullptr; }
  [[nodiscard]] std::shared_ptr<const Tree> loadedIn(const Slab& slab,
                                                     base::Job& job) const override {
    return std::make_shared<VdbTree>(*this, slab, job);
  }
  [[nodiscard]] std::size_t leafCount() const override { return leaves_.size(); }
  [[nodiscard]] Coord leafOrigin(LeafRef leaf) const override {
    return fromVdb(leaves_[leaf]->origin());
  }
  [[nodiscard]] double leafValue(LeafRef leaf, int cell) const override {
    return values_[leaf][cell];
  }
  [[nodiscard]] std::uint64_t leafActive(LeafRef leaf, int x) const override {
    return leaves_[leaf]->getValueMask().template getWord<std::uint64_t>(x);
  }
  [[nodiscard]] std::unique_ptr<Accessor> accessor() const override {
    return std::make_unique<VdbAccessor<TreeT>>(tree_, values_, loaded_.get());
  }

  Summary readSides(const IsoChoice& iso, std::vector<BlockBits>& inside,
                    base::Job& job) const override {
    Summary summary = readLeaves(iso, inside, job);
    readTiles(summary, job);
    return summary;
  }

  void findPlaces(const IsoChoice& iso, BlockPlaces& places, base::Job& job) const override {
    std::vector<const Node*> nodes;
    tree_.getNodes(nodes);
    std::vector<Coord> origins;
    std::vector<BlockRef> firstLeaf;
    BlockRef leaves = 0;
    for (const Node* node : nodes) {
      origins.push_back(fromVdb(node->origin()));
      firstLeaf.push_back(leaves);
      leaves += static_cast<BlockRef>(node->getChildMask().countOn());
    }
    places.setNodes(origins, job);
    job.forRanges(nodes.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        BlockRef* place = places.node(i);
        forTiles(*nodes[i], [&](openvdb::Index at, T value) {
          place[at] = isInside(value, iso) ? kInsideTile : kOutsideTile;
        });
        BlockRef next = firstLeaf[i];
        for (auto leaf = nodes[i]->cbeginChildOn(); leaf; ++leaf) place[leaf.pos()] = next++;
      }
    });
  }

  [[nodiscard]] std::uint64_t tileSurface(const IsoChoice& iso, base::Job& job) const override {
    return grid::tileSurface(tree_, iso, job);
  }

  [[nodiscard]] std::vector<Coord> tileContacts(const IsoChoice& iso,
                                                base::Job& job) const override {
    std::vector<Coord> contacts;
    for (const openvdb::Coord& block : findTileContacts(tree_, iso, job)) {
      contacts.push_back(fromVdb(block));
    }
    return contacts;
  }

 private:
  // Side bits of the leaves; values that are not finite are outside.
  Summary readLeaves(const IsoChoice& iso, std::vector<BlockBits>& inside, base::Job& job) const {
    base::resizeLarge(inside, values_.size(), job);
    const T limit = threshold<T>(iso);
    Summary summary;
    std::mutex mutex;
    std::size_t firstBad = values_.size();
    std::atomic<std::size_t> active{0};
    forValues(job, [&](std::size_t i, const T* values) {
      active.fetch_add(leaves_[i]->getValueMask().countOn(), std::memory_order_relaxed);
      if (iso.insideIsBelow) {
        packSides<true>(values, limit, inside[i]);
      } else {
        packSides<false>(values, limit, inside[i]);
      }
      if (allFinite(values)) return;
      const std::scoped_lock lock(mutex);
      for (int cell = 0; cell < kBlockCells; ++cell) {
        if (std::isfinite(values[cell])) continue;
        ++summary.nonFiniteValues;
        inside[i].slabs[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63));
        if (i < firstBad) {
          firstBad = i;
          summary.firstNonFinite =
              leafOrigin(static_cast<LeafRef>(i)).offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7);
        }
      }
    });
    summary.activeVoxels = active;
    return summary;
  }

  // Calls use(leaf, values) for each leaf, in parallel. Values that are not in memory are read some
  // at a time.
  template <class Use>
  void forValues(base::Job& job, const Use& use) const {
    if (source_ == nullptr) {
      job.forRanges(values_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) use(i, values_[i]);
      });
      return;
    }
    constexpr std::size_t kAtOnce = 4096;
    std::vector<T> values(kAtOnce * kBlockCells);
    for (std::size_t first = 0; first < leaves_.size(); first += kAtOnce) {
      const std::size_t count = std::min(kAtOnce, leaves_.size() - first);
      job.beginLoop(double(first) / double(leaves_.size()),
                    double(first + count) / double(leaves_.size()));
      for (std::size_t i = 0; i < count; ++i) {
        job.pollCancelled(i);
        source_->read(first + i, &values[i * kBlockCells]);
      }
      job.forRanges(count, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) use(first + i, &values[i * kBlockCells]);
      });
    }
  }

  void readTiles(Summary& summary, base::Job& job) const {
    requireFiniteBackground(gridName_, static_cast<double>(tree_.background()));
    for (auto tile = tree_.root().cbeginValueAll(); tile; ++tile) {
      if (tile.isValueOn()) summary.activeVoxels += UpperNode::NUM_VOXELS;
      if (std::isfinite(*tile)) continue;
      if (summary.nonFiniteValues++ == 0) summary.firstNonFinite = fromVdb(tile.getCoord());
    }
    readTilesOf<UpperNode>(summary, job);
    readTilesOf<Node>(summary, job);
  }

  template <class NodeT>
  void readTilesOf(Summary& summary, base::Job& job) const {
    std::vector<const NodeT*> nodes;
    tree_.getNodes(nodes);
    std::mutex mutex;
    std::size_t firstBad = nodes.size(), nonFinite = 0;
    openvdb::Coord firstPlace;
    std::atomic<std::uint64_t> active{0};
    job.forRanges(nodes.size(), 16, [&](std::size_t begin, std::size_t end) {
      std::uint64_t activeHere = 0;
      for (std::size_t i = begin; i < end; ++i) {
        activeHere += activeTiles(*nodes[i]);
        forTiles(*nodes[i], [&](openvdb::Index at, T value) {
          if (std::isfinite(value)) return;
          const std::scoped_lock lock(mutex);
          ++nonFinite;
          if (i >= firstBad) return;
          firstBad = i;
          firstPlace = nodes[i]->offsetToGlobalCoord(at);
        });
      }
      active += activeHere;
    });
    summary.activeVoxels += active * NodeT::ChildNodeType::NUM_VOXELS;
    if (nonFinite == 0) return;
    if (summary.nonFiniteValues == 0) summary.firstNonFinite = fromVdb(firstPlace);
    summary.nonFiniteValues += nonFinite;
  }

  std::string gridName_;
  const TreeT& tree_;
  base::LeafSource* source_ = nullptr;       ///< of values that are not in memory
  std::vector<const T*> values_;             ///< the 512 values of each leaf, or null
  std::vector<const Leaf*> leaves_;          ///< in the order of the tree
  std::unique_ptr<LoadedLeaves<T>> loaded_;  ///< of a part: what values_ points to
};

}  // namespace

std::shared_ptr<const Tree> treeOf(const StoredGrid& stored, base::Job& job) {
  const openvdb::GridBase& grid = stored.grid;
  if (grid.isType<openvdb::FloatGrid>()) {
    return std::make_shared<VdbTree<openvdb::FloatTree>>(
        grid.getName(), static_cast<const openvdb::FloatGrid&>(grid).tree(), stored.leaves, job);
  }
  return std::make_shared<VdbTree<openvdb::DoubleTree>>(
      grid.getName(), static_cast<const openvdb::DoubleGrid&>(grid).tree(), stored.leaves, job);
}

}  // namespace tufa::grid
