#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <utility>
#include <vector>

#include "io/grid/byte_window.h"

namespace tufa::io {

/// How a type of tree lies in a file.
struct TreeLayout {
  enum class Leaf {
    Values,  ///< a buffer of values
    Bools,   ///< two masks
    Mask,    ///< one mask
    Points,  ///< buffers that are not known here: only the topology can be walked
  };

  std::size_t valueBytes = 0;
  std::size_t halfBytes = 0;  ///< of a value in half precision; 0 if there are none of this type
  Leaf leaf = Leaf::Values;
};

/// The layout of the trees that OpenVDB registers; none for others.
[[nodiscard]] std::optional<TreeLayout> layoutOf(const openvdb::GridBase& grid);

/// Files of before OpenVDB 1.0 (2013) are not read: their trees, transforms and names lie
/// otherwise.
inline constexpr std::uint32_t kOldestFormat = openvdb::OPENVDB_FILE_VERSION_NEW_TRANSFORM;

/// How the tree of one grid is written.
struct TreeCoding {
  std::uint32_t version = 0;      ///< of the file's format: kOldestFormat or later
  std::uint32_t compression = 0;  ///< flags, those of openvdb/io/Compression.h
  bool half = false;              ///< real values are in half precision
};

/// Goes over the bytes of a tree, before OpenVDB does, and looks at every size there is in them.
/// OpenVDB 10 trusts these: a buffer that claims more bytes than its node has room for is read over
/// the end of that room, and one that claims gigabytes is given them. What passes here it reads
/// within its bounds; payloads may still turn out not to be decompressible, which it says.
///
/// The layout is that of OpenVDB's readTopology() and readBuffers(): tree/Tree.h, RootNode.h,
/// InternalNode.h, LeafNode.h, LeafNodeBool.h, LeafNodeMask.h, and of io/Compression.h.
class TreeWalker {
 public:
  /// Begins where the stream stands; `end` is the place behind the last byte of the grid.
  TreeWalker(std::istream& stream, std::uint64_t end, const TreeLayout& layout,
             const TreeCoding& coding);

  /// Throws DamagedGrid, and std::ios_base::failure where the file ends inside the tree. Of points
  /// it walks the topology, which lies before all that leaves hold.
  void walk();

  /// Where the buffers of each leaf begin, in the order of the tree.
  [[nodiscard]] std::vector<std::uint64_t> takeLeafPlaces() { return std::move(leafPlaces_); }

  /// Where the walk has come to.
  [[nodiscard]] std::uint64_t place() const { return bytes_.place(); }

 private:
  /// A child of the root, and the origins of its leaves if the buffers repeat them.
  struct Branch {
    openvdb::Coord origin;
    std::size_t leaves = 0;
    std::vector<openvdb::Coord> leafOrigins;
  };

  template <std::size_t Log2>
  struct Mask {
    static constexpr std::size_t kSlots = std::size_t{1} << (3 * Log2);
    std::array<std::uint64_t, kSlots / 64> words;
    [[nodiscard]] bool isOn(std::size_t slot) const { return words[slot / 64] >> (slot % 64) & 1; }
    [[nodiscard]] std::size_t count() const;
  };

  void walkTopology();
  void walkBuffers();
  template <std::size_t Log2>
  Mask<Log2> takeMask();
  openvdb::Coord takeOrigin();
  openvdb::Coord takeRootOrigin();
  void takeRootValue();
  template <std::size_t Log2>
  void walkInner(const openvdb::Coord& origin, Branch& branch);
  template <std::size_t Log2>
  void walkChild(const openvdb::Coord& origin, Branch& branch);
  template <std::size_t Log2>
  void walkValues(std::size_t slots, const Mask<Log2>& active);
  void walkData(std::size_t count, std::size_t valueBytes, std::uint32_t compression);
  void walkChunk(std::uint64_t bytes, std::uint32_t compression);
  void walkLeaf(const openvdb::Coord* origin);

  /// Else, before 2013, nodes hold fewer values and leaves more: their origin, unused buffers.
  [[nodiscard]] bool maskCompressed() const;
  [[nodiscard]] bool buffersHaveOrigins() const;
  [[nodiscard]] std::size_t storedBytes() const;

  ByteWindow bytes_;
  TreeLayout layout_;
  TreeCoding coding_;
  std::vector<Branch> branches_;
  std::vector<std::uint64_t> leafPlaces_;
};

/// Throws DamagedGrid unless a chunk of Blosc's is all of `chunkBytes` and unpacks to `bytes`.
/// Blosc is told only where a chunk begins: it takes the lengths from there.
void requireSoundBloscChunk(const std::array<std::uint32_t, 4>& head, std::uint64_t chunkBytes,
                            std::uint64_t bytes);

}  // namespace tufa::io
