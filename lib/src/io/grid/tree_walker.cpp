#include "io/grid/tree_walker.h"

#include <openvdb/io/Compression.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/tools/PointIndexGrid.h>

#include <algorithm>
#include <bit>
#include <string>
#include <type_traits>

namespace tufa::io {

namespace {

constexpr std::size_t kLeafLog2 = 3;
constexpr std::size_t kLowerLog2 = 4;
constexpr std::size_t kUpperLog2 = 5;
constexpr std::size_t kLeafSlots = std::size_t{1} << (3 * kLeafLog2);
constexpr int kRootChildDim = 1 << (kLeafLog2 + kLowerLog2 + kUpperLog2);
constexpr std::size_t kOriginBytes = 3 * sizeof(std::int32_t);

template <class GridT>
bool addLayout(const openvdb::GridBase& grid, std::optional<TreeLayout>& layout,
               TreeLayout::Leaf leaf) {
  using Value = typename GridT::ValueType;
  using Half = openvdb::io::RealToHalf<Value>;
  using Leaf = typename GridT::TreeType::LeafNodeType;
  using Lower = typename GridT::TreeType::RootNodeType::ChildNodeType::ChildNodeType;
  static_assert(Leaf::LOG2DIM == kLeafLog2 && Lower::LOG2DIM == kLowerLog2);
  static_assert(GridT::TreeType::RootNodeType::ChildNodeType::LOG2DIM == kUpperLog2);
  if (!grid.isType<GridT>()) return false;
  layout = {sizeof(Value), Half::isReal ? sizeof(typename Half::HalfT) : 0, leaf};
  return true;
}

/// More than any deflate makes of values, be they noise.
constexpr std::uint64_t mostDeflated(std::uint64_t bytes) { return bytes + bytes / 8 + 64; }

}  // namespace

std::optional<TreeLayout> layoutOf(const openvdb::GridBase& grid) {
  using Leaf = TreeLayout::Leaf;
  std::optional<TreeLayout> layout;
  (void)(addLayout<openvdb::FloatGrid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::DoubleGrid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::Int32Grid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::Int64Grid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::Vec3IGrid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::Vec3SGrid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::Vec3DGrid>(grid, layout, Leaf::Values) ||
         addLayout<openvdb::BoolGrid>(grid, layout, Leaf::Bools) ||
         addLayout<openvdb::MaskGrid>(grid, layout, Leaf::Mask) ||
         addLayout<openvdb::points::PointDataGrid>(grid, layout, Leaf::Points) ||
         addLayout<openvdb::tools::PointIndexGrid>(grid, layout, Leaf::Points));
  return layout;
}

void requireSoundBloscChunk(const std::array<std::uint32_t, 4>& head, std::uint64_t chunkBytes,
                            std::uint64_t bytes) {
  // Four bytes of versions and flags, then the lengths of data, block and chunk (blosc.h).
  if (head[3] != chunkBytes) {
    throw DamagedGrid("a chunk of Blosc claims " + std::to_string(head[3]) + " bytes of " +
                      std::to_string(chunkBytes));
  }
  if (head[1] != bytes) {
    throw DamagedGrid("a chunk of Blosc claims to hold " + std::to_string(head[1]) +
                      " bytes of values in place of " + std::to_string(bytes));
  }
}

TreeWalker::TreeWalker(std::istream& stream, std::uint64_t end, const TreeLayout& layout,
                       const TreeCoding& coding)
    : bytes_(stream, end), layout_(layout), coding_(coding) {}

template <std::size_t Log2>
std::size_t TreeWalker::Mask<Log2>::count() const {
  std::size_t bits = 0;
  for (const std::uint64_t word : words) bits += static_cast<std::size_t>(std::popcount(word));
  return bits;
}

template <std::size_t Log2>
TreeWalker::Mask<Log2> TreeWalker::takeMask() {
  Mask<Log2> mask;
  bytes_.take(mask.words.data(), sizeof mask.words);
  return mask;
}

openvdb::Coord TreeWalker::takeOrigin() {
  const auto origin = bytes_.take<std::array<std::int32_t, 3>>();
  return openvdb::Coord(origin[0], origin[1], origin[2]);
}

/// OpenVDB looks for what the root holds at multiples of its children's size, and only there.
openvdb::Coord TreeWalker::takeRootOrigin() {
  const openvdb::Coord origin = takeOrigin();
  if ((origin & (kRootChildDim - 1)) != openvdb::Coord(0)) {
    throw DamagedGrid("it has a node of 4096^3 voxels at index " + std::to_string(origin.x()) +
                      ", " + std::to_string(origin.y()) + ", " + std::to_string(origin.z()));
  }
  return origin;
}

void TreeWalker::takeRootValue() {
  const bool isBool =
      layout_.leaf == TreeLayout::Leaf::Bools || layout_.leaf == TreeLayout::Leaf::Mask;
  if (!isBool) return bytes_.skip(layout_.valueBytes);
  if (bytes_.take<std::uint8_t>() > 1) throw DamagedGrid("it has a bool that is none");
}

bool TreeWalker::buffersHaveOrigins() const {
  return layout_.leaf == TreeLayout::Leaf::Bools || layout_.leaf == TreeLayout::Leaf::Mask ||
         !maskCompressed();
}

bool TreeWalker::maskCompressed() const {
  return coding_.version >= openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;
}

void TreeWalker::walk() {
  walkTopology();
  if (layout_.leaf != TreeLayout::Leaf::Points) walkBuffers();
}

void TreeWalker::walkTopology() {
  bytes_.skip(sizeof(std::int32_t));  // how many buffers leaves have, which OpenVDB ignores
  takeRootValue();                    // the background
  const auto tiles = bytes_.take<std::uint32_t>();
  const auto children = bytes_.take<std::uint32_t>();
  const std::uint64_t tileBytes = kOriginBytes + layout_.valueBytes + 1;
  const std::uint64_t childBytes = kOriginBytes + 2 * sizeof(Mask<kUpperLog2>);
  if (tiles * tileBytes + children * childBytes > bytes_.left()) {
    throw DamagedGrid("it claims " + std::to_string(tiles) + " tiles and " +
                      std::to_string(children) + " nodes where " + std::to_string(bytes_.left()) +
                      " bytes are left");
  }
  std::vector<openvdb::Coord> origins;
  for (std::uint32_t n = 0; n < tiles; ++n) {
    origins.push_back(takeRootOrigin());
    takeRootValue();
    if (bytes_.take<std::uint8_t>() > 1) throw DamagedGrid("a tile is neither active nor inactive");
  }
  for (std::uint32_t n = 0; n < children; ++n) {
    Branch& branch = branches_.emplace_back();
    branch.origin = takeRootOrigin();
    origins.push_back(branch.origin);
    walkInner<kUpperLog2>(branch.origin, branch);
  }
  // Of two at one place OpenVDB forgets one, and expects no buffers of its leaves.
  std::sort(origins.begin(), origins.end());
  if (std::adjacent_find(origins.begin(), origins.end()) != origins.end()) {
    throw DamagedGrid("two of its nodes have one place");
  }
}

template <std::size_t Log2>
void TreeWalker::walkChild(const openvdb::Coord& origin, Branch& branch) {
  if constexpr (Log2 == kUpperLog2) {
    walkInner<kLowerLog2>(origin, branch);
  } else {
    bytes_.skip(sizeof(Mask<kLeafLog2>));
    ++branch.leaves;
    if (buffersHaveOrigins()) branch.leafOrigins.push_back(origin);
  }
}

/// InternalNode::readTopology().
template <std::size_t Log2>
void TreeWalker::walkInner(const openvdb::Coord& origin, Branch& branch) {
  const auto children = takeMask<Log2>();
  const auto active = takeMask<Log2>();
  for (std::size_t word = 0; word < children.words.size(); ++word) {
    // OpenVDB would take the child's address for the value of an active tile.
    if ((children.words[word] & active.words[word]) != 0) {
      throw DamagedGrid("it has a node in place of an active tile");
    }
  }
  const auto place = [&](std::size_t slot) {
    constexpr int kChildLog2 = Log2 == kUpperLog2 ? kLowerLog2 + kLeafLog2 : kLeafLog2;
    constexpr std::size_t kLast = (std::size_t{1} << Log2) - 1;
    const auto part = [&](std::size_t shift) { return static_cast<int>(slot >> shift & kLast); };
    return origin.offsetBy(part(2 * Log2) << kChildLog2, part(Log2) << kChildLog2,
                           part(0) << kChildLog2);
  };
  walkValues(maskCompressed() ? children.kSlots : children.kSlots - children.count(), active);
  for (std::size_t slot = 0; slot < children.kSlots; ++slot) {
    if (children.isOn(slot)) walkChild<Log2>(place(slot), branch);
  }
}

/// io::readCompressedValues().
template <std::size_t Log2>
void TreeWalker::walkValues(std::size_t slots, const Mask<Log2>& active) {
  using namespace openvdb::io;
  std::size_t count = slots;
  if (maskCompressed()) {
    const int kind = bytes_.take<std::int8_t>();
    if (kind < NO_MASK_OR_INACTIVE_VALS || kind > NO_MASK_AND_ALL_VALS) {
      throw DamagedGrid("its values are left out in a way of no meaning, " + std::to_string(kind));
    }
    // Inactive values are in full precision always.
    if (kind == NO_MASK_AND_ONE_INACTIVE_VAL || kind == MASK_AND_ONE_INACTIVE_VAL) {
      bytes_.skip(layout_.valueBytes);
    }
    if (kind == MASK_AND_TWO_INACTIVE_VALS) bytes_.skip(2 * layout_.valueBytes);
    if (kind == MASK_AND_NO_INACTIVE_VALS || kind == MASK_AND_ONE_INACTIVE_VAL ||
        kind == MASK_AND_TWO_INACTIVE_VALS) {
      bytes_.skip(sizeof active.words);
    }
    const bool onlyActive = (coding_.compression & COMPRESS_ACTIVE_MASK) != 0;
    if (onlyActive && kind != NO_MASK_AND_ALL_VALS) count = active.count();
  }
  walkData(count, storedBytes(), coding_.compression);
}

std::size_t TreeWalker::storedBytes() const {
  return coding_.half && layout_.halfBytes > 0 ? layout_.halfBytes : layout_.valueBytes;
}

/// io::readData() and io::HalfReader::read().
void TreeWalker::walkData(std::size_t count, std::size_t valueBytes, std::uint32_t compression) {
  if (count == 0 && coding_.half && layout_.halfBytes > 0) return;  // then there is no size, even
  walkChunk(count * valueBytes, compression);
}

/// io::bloscFromStream() and io::unzipFromStream(), which takes the second place.
void TreeWalker::walkChunk(std::uint64_t bytes, std::uint32_t compression) {
  using namespace openvdb::io;
  const bool blosc = (compression & COMPRESS_BLOSC) != 0;
  if (!blosc && (compression & COMPRESS_ZIP) == 0) return bytes_.skip(bytes);
  const auto size = bytes_.take<std::int64_t>();
  if (size <= 0) {  // the negative size of values that are not compressed
    if (-static_cast<std::uint64_t>(size) != bytes) {
      throw DamagedGrid("it claims a buffer of " +
                        std::to_string(-static_cast<std::uint64_t>(size)) + " bytes in place of " +
                        std::to_string(bytes));
    }
    return bytes_.skip(bytes);
  }
  const auto chunkBytes = static_cast<std::uint64_t>(size);
  if (chunkBytes > bytes_.left()) {
    throw DamagedGrid("it claims a compressed buffer of " + std::to_string(chunkBytes) +
                      " bytes where " + std::to_string(bytes_.left()) + " are left");
  }
  if (blosc) {
    std::array<std::uint32_t, 4> head{};
    if (chunkBytes < sizeof head) throw DamagedGrid("a chunk of Blosc is too short for its head");
    bytes_.look(head.data(), sizeof head);
    requireSoundBloscChunk(head, chunkBytes, bytes);
  } else if (chunkBytes > mostDeflated(bytes)) {
    // OpenVDB takes what it has room for, and leaves the rest.
    throw DamagedGrid("a compressed buffer of " + std::to_string(chunkBytes) +
                      " bytes holds more than its " + std::to_string(bytes) + " bytes of values");
  }
  bytes_.skip(chunkBytes);
}

void TreeWalker::walkBuffers() {
  // OpenVDB reads them in the order of its root's map.
  std::sort(branches_.begin(), branches_.end(),
            [](const Branch& a, const Branch& b) { return a.origin < b.origin; });
  for (const Branch& branch : branches_) {
    for (std::size_t leaf = 0; leaf < branch.leaves; ++leaf) {
      leafPlaces_.push_back(bytes_.place());
      walkLeaf(buffersHaveOrigins() ? &branch.leafOrigins[leaf] : nullptr);
    }
  }
}

/// LeafNode::readBuffers(), of all types. The values' mask is there a second time, and is the one
/// that counts.
void TreeWalker::walkLeaf(const openvdb::Coord* origin) {
  const auto active = takeMask<kLeafLog2>();
  if (origin != nullptr && takeOrigin() != *origin) {
    throw DamagedGrid("a leaf claims another place than its parent");
  }
  if (layout_.leaf == TreeLayout::Leaf::Mask) return;
  if (layout_.leaf == TreeLayout::Leaf::Bools) return bytes_.skip(sizeof active.words);
  const int buffers = maskCompressed() ? 1 : bytes_.take<std::int8_t>();
  walkValues(kLeafSlots, active);
  for (int n = 1; n < buffers; ++n) {
    walkData(kLeafSlots, storedBytes(), coding_.compression & openvdb::io::COMPRESS_ZIP);
  }
}

}  // namespace tufa::io
