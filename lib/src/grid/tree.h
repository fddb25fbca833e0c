#pragma once

#include <tufa/coord.h>
#include <tufa/openvdb_fwd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/job.h"
#include "grid/block_bits.h"
#include "grid/block_places.h"
#include "grid/field.h"
#include "grid/isovalue.h"
#include "grid/slab.h"
#include "grid/stored_grid.h"

namespace tufa::grid {

/// Index of the leaf behind a block, in the order of the tree; kNoLeaf where a tile is.
using LeafRef = std::int32_t;
inline constexpr LeafRef kNoLeaf = -1;

/// Reads values of a tree and caches the nodes on the way. For one thread.
class Accessor {
 public:
  virtual ~Accessor() = default;

  [[nodiscard]] virtual double value(const Coord& at) = 0;
  [[nodiscard]] virtual bool isActive(const Coord& at) = 0;
  /// Writes the samples of a block and of one layer below and two above it on each axis, scaled to
  /// voxels, in the order of BlockSamples. `leaves` are those of the block at `origin` and of the
  /// 26 around it.
  virtual void gather(const std::array<LeafRef, 27>& leaves, const Coord& origin,
                      const FieldScale& scale, float* samples) = 0;
};

/// The tree of an OpenVDB grid, behind an interface that hides the type of its values. A virtual
/// call handles a block or a rare single value, never one sample of a loop.
class Tree {
 public:
  virtual ~Tree() = default;

  /// What is known of all values before the surface is searched.
  struct Summary {
    std::size_t activeVoxels = 0;  ///< those of tiles included
    std::size_t nonFiniteValues = 0;
    Coord firstNonFinite;
  };

  /// For messages.
  [[nodiscard]] virtual const std::string& gridName() const = 0;
  /// Whether values of all leaves are at hand.
  [[nodiscard]] virtual bool isInMemory() const = 0;
  /// The same tree with the values of the leaves in a slab. For trees that are not in memory.
  [[nodiscard]] virtual std::shared_ptr<const Tree> loadedIn(const Slab& slab,
                                                             base::Job& job) const = 0;
  [[nodiscard]] virtual std::size_t leafCount() const = 0;
  [[nodiscard]] virtual Coord leafOrigin(LeafRef leaf) const = 0;
  /// The 512 values of a leaf as double: one of them.
  [[nodiscard]] virtual double leafValue(LeafRef leaf, int cell) const = 0;
  /// Slab x of the mask of active values.
  [[nodiscard]] virtual std::uint64_t leafActive(LeafRef leaf, int x) const = 0;
  [[nodiscard]] virtual std::unique_ptr<Accessor> accessor() const = 0;

  /// Reads every value once: side bits of all leaves, and what the summary holds. Throws
  /// Error(NonFiniteValues) for a background that is not finite.
  virtual Summary readSides(const IsoChoice& iso, std::vector<BlockBits>& inside,
                            base::Job& job) const = 0;
  /// Records the place of every leaf and the sides of tiles as large as one.
  virtual void findPlaces(const IsoChoice& iso, BlockPlaces& places, base::Job& job) const = 0;
  /// Faces of voxels between tiles of two sides, nearly; see tile_surface.h.
  [[nodiscard]] virtual std::uint64_t tileSurface(const IsoChoice& iso, base::Job& job) const = 0;
  /// Blocks in tiles with cells that the surface passes because tiles of two sides touch; see
  /// tile_contacts.h.
  [[nodiscard]] virtual std::vector<Coord> tileContacts(const IsoChoice& iso,
                                                        base::Job& job) const = 0;
};

/// The tree of a float or double grid, which must outlive it, as must what reads values. Values
/// that are not in memory are read by readSides(), and then again by each part.
[[nodiscard]] std::shared_ptr<const Tree> treeOf(const StoredGrid& grid, base::Job& job);

}  // namespace tufa::grid
