// .nvdb: grids of NanoVDB, whose bytes in memory are those of the file, compressed or not. Every
// offset between nodes is checked before it is followed.

#include "io/grid/nanovdb.h"

#include <blosc.h>
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>
#include <zlib.h>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <type_traits>

namespace tufa::io {
namespace {

using openvdb::GridBase;
using Fail = std::function<void(const std::string&)>;

/// What deflate compresses best by, and more than Blosc's codec does.
constexpr std::uint64_t kMostRatio = 1040;
/// Bytes of a compressed part, once unpacked.
constexpr std::uint64_t kPartBytes = 1ULL << 30;

/// The memory that a file may take: its grids unpacked, and as OpenVDB's. Of leaves of few bytes
/// OpenVDB makes twenty times as many, and of zeros deflate a thousandth.
class Budget {
 public:
  Budget(std::uint64_t fileBytes, const Fail& fail)
      : left_(std::max(kLeast, kFactor * fileBytes)), fail_(fail) {}

  void take(std::uint64_t bytes) {
    if (bytes > left_) {
      fail_("its grids would take more than " + std::to_string(kFactor) +
            " times its size, and more than " + std::to_string(kLeast >> 20U) + " MB of memory");
    }
    left_ -= bytes;
  }

 private:
  static constexpr std::uint64_t kLeast = 256ULL << 20U;
  static constexpr std::uint64_t kFactor = 200;
  std::uint64_t left_;
  const Fail& fail_;
};

/// The bytes of a file, taken from the front.
class Taker {
 public:
  Taker(std::string_view bytes, const Fail& fail) : rest_(bytes), fail_(fail) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  std::string_view take(std::uint64_t count, const char* what) {
    if (count > rest_.size()) {
      fail_(std::string("the file ends inside ") + what + ", it is truncated or damaged");
    }
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }
  template <class Record>
  Record record(const char* what) {
    static_assert(std::is_trivially_copyable_v<Record>);
    Record record;
    std::memcpy(static_cast<void*>(&record), take(sizeof record, what).data(), sizeof record);
    return record;
  }

 private:
  std::string_view rest_;
  const Fail& fail_;
};

/// The head of a segment, as nanovdb::io::Header has it.
struct SegmentHead {
  std::uint64_t magic;
  std::uint32_t version;
  std::uint16_t gridCount;
  std::uint16_t codec;
};
static_assert(sizeof(SegmentHead) == sizeof(nanovdb::io::Header));

struct Free {
  void operator()(char* bytes) const { std::free(bytes); }
};

/// A grid in memory, aligned as NanoVDB's nodes are.
struct Buffer {
  std::unique_ptr<char, Free> bytes;
  std::uint64_t size = 0;
};

Buffer makeBuffer(std::uint64_t size) {
  constexpr std::uint64_t kAlignment = NANOVDB_DATA_ALIGNMENT;
  Buffer buffer;
  buffer.size = size;
  const std::uint64_t room = (size + kAlignment - 1) / kAlignment * kAlignment;
  buffer.bytes.reset(static_cast<char*>(std::aligned_alloc(kAlignment, room)));
  if (buffer.bytes == nullptr) throw std::bad_alloc();
  return buffer;
}

void unpackZip(Taker& taker, const Buffer& buffer, const Fail& fail) {
  const auto size = taker.record<std::uint64_t>("a grid");
  const std::string_view packed = taker.take(size, "a grid");
  uLongf length = buffer.size;
  const int status = uncompress(reinterpret_cast<Bytef*>(buffer.bytes.get()), &length,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || length != buffer.size) fail("a compressed grid is damaged");
}

void unpackBlosc(Taker& taker, const Buffer& buffer, const Fail& fail) {
  for (std::uint64_t at = 0; at < buffer.size;) {
    const std::uint64_t due = std::min(buffer.size - at, kPartBytes);
    const auto size = taker.record<std::uint64_t>("a grid");
    const std::string_view packed = taker.take(size, "a grid");
    std::size_t length = 0;
    const bool sound = blosc_cbuffer_validate(packed.data(), packed.size(), &length) == 0 &&
                       length == due &&
                       blosc_decompress_ctx(packed.data(), buffer.bytes.get() + at, due, 1) ==
                           static_cast<int>(due);
    if (!sound) fail("a compressed grid is damaged");
    at += due;
  }
}

Buffer unpack(Taker& taker, const nanovdb::io::MetaData& meta, std::uint16_t codec, Budget& budget,
              const Fail& fail) {
  if (meta.gridSize < sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<3>) ||
      meta.gridSize / kMostRatio > meta.fileSize) {
    fail("the size of a grid cannot be right: damaged");
  }
  // Before memory is taken for what it says.
  if (Taker rest = taker; meta.fileSize > 0) static_cast<void>(rest.take(meta.fileSize, "a grid"));
  budget.take(meta.gridSize);
  Buffer buffer = makeBuffer(meta.gridSize);
  switch (static_cast<nanovdb::io::Codec>(codec)) {
    case nanovdb::io::Codec::NONE:
      std::memcpy(buffer.bytes.get(), taker.take(buffer.size, "a grid").data(), buffer.size);
      break;
    case nanovdb::io::Codec::ZIP:
      unpackZip(taker, buffer, fail);
      break;
    case nanovdb::io::Codec::BLOSC:
      unpackBlosc(taker, buffer, fail);
      break;
    default:
      fail("its compression is unknown");
  }
  return buffer;
}

/// Makes OpenVDB's grid of one of NanoVDB's. `BuildT` is how NanoVDB stores values.
template <class BuildT, class GridT>
class Converter {
 public:
  Converter(const Buffer& buffer, Budget& budget, const Fail& fail)
      : begin_(buffer.bytes.get()), size_(buffer.size), budget_(budget), fail_(fail) {}

  GridBase::Ptr convert() {
    const auto& head = *at<nanovdb::GridData>(0);
    const auto& tree = *at<nanovdb::TreeData<3>>(sizeof(nanovdb::GridData));
    const std::int64_t place =
        static_cast<std::int64_t>(sizeof(nanovdb::GridData) + tree.mNodeOffset[3]);
    const RootData& root = *at<RootData>(place);
    const std::uint64_t tiles = std::uint64_t{root.mTableSize} * sizeof(typename RootData::Tile);
    requireInside(place + static_cast<std::int64_t>(sizeof(RootData)), tiles);
    grid_ = GridT::create(valueOf(root.mBackground));
    setHead(head);
    for (std::uint32_t n = 0; n < root.mTableSize; ++n) {
      const auto& tile = *root.tile(n);
      const auto key = RootData::KeyToCoord(tile.key);
      const openvdb::Coord origin(key[0], key[1], key[2]);
      if (tile.child != 0) {
        addUpper(sum(place, tile.child), origin);
      } else {
        addTile(kRootLevel, origin, valueOf(tile.value), tile.state != 0);
      }
    }
    return grid_;
  }

 private:
  using NanoGrid = nanovdb::NanoGrid<BuildT>;
  using RootData = typename NanoGrid::TreeType::RootType::DataType;
  using Upper = typename NanoGrid::TreeType::Node2;
  using Lower = typename NanoGrid::TreeType::Node1;
  using Leaf = typename NanoGrid::TreeType::Node0;
  using Value = typename GridT::ValueType;
  using OpenUpper = typename GridT::TreeType::RootNodeType::ChildNodeType;
  using OpenLower = typename OpenUpper::ChildNodeType;
  using OpenLeaf = typename OpenLower::ChildNodeType;
  static constexpr int kRootLevel = 3;

  template <class NanoValue>
  static Value valueOf(const NanoValue& value) {
    if constexpr (openvdb::VecTraits<Value>::IsVec) {
      return Value(value[0], value[1], value[2]);
    } else {
      return static_cast<Value>(value);
    }
  }

  // Offsets are what the file says: the sum may wrap around, and is checked where it is used.
  static std::int64_t sum(std::int64_t place, std::int64_t offset) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(place) +
                                     static_cast<std::uint64_t>(offset));
  }

  void requireInside(std::int64_t place, std::uint64_t bytes) const {
    const bool inside = place >= 0 && static_cast<std::uint64_t>(place) <= size_ &&
                        bytes <= size_ - static_cast<std::uint64_t>(place) &&
                        place % NANOVDB_DATA_ALIGNMENT == 0;
    if (!inside) fail_("a grid is damaged: a node lies outside of it");
  }

  /// What lies at a place. The bytes are those of plain data.
  template <class Node>
  const Node* at(std::int64_t place) const {
    requireInside(place, sizeof(Node));
    return reinterpret_cast<const Node*>(begin_ + place);
  }

  /// Nodes that several others share would make work without end.
  template <class Node>
  const Node* visit(std::int64_t place) {
    const Node* const node = at<Node>(place);
    visited_ += sizeof(Node);
    if (visited_ > size_) fail_("a grid is damaged: nodes are used twice");
    return node;
  }

  void setHead(const nanovdb::GridData& head) {
    switch (head.mGridClass) {
      case nanovdb::GridClass::LevelSet:
        grid_->setGridClass(openvdb::GRID_LEVEL_SET);
        break;
      case nanovdb::GridClass::FogVolume:
        grid_->setGridClass(openvdb::GRID_FOG_VOLUME);
        break;
      case nanovdb::GridClass::Staggered:
        grid_->setGridClass(openvdb::GRID_STAGGERED);
        break;
      default:
        break;
    }
    const auto& m = head.mMap.mMatD;
    const auto& v = head.mMap.mVecD;
    // OpenVDB's points are row vectors.
    const openvdb::Mat4d matrix(m[0], m[3], m[6], 0.0, m[1], m[4], m[7], 0.0, m[2], m[5], m[8], 0.0,
                                v[0], v[1], v[2], 1.0);
    grid_->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  }

  void addTile(int level, const openvdb::Coord& origin, const Value& value, bool active) {
    if (!active && value == grid_->background()) return;
    grid_->tree().addTile(static_cast<openvdb::Index>(level), origin, value, active);
  }

  /// Calls child(place of the node, its corner) or adds a tile for each of the cells of a node.
  template <class Node, class Child>
  void forCells(std::int64_t place, const openvdb::Coord& origin, int level, const Child& child) {
    const auto& data = *visit<Node>(place)->data();
    constexpr std::uint32_t kBits = Node::LOG2DIM;
    constexpr std::uint32_t kMask = (1U << kBits) - 1;
    constexpr int kCell = 1 << Node::ChildNodeType::TOTAL;
    for (std::uint32_t n = 0; n < Node::SIZE; ++n) {
      const openvdb::Coord corner = origin.offsetBy(kCell * static_cast<int>(n >> 2 * kBits),
                                                    kCell * static_cast<int>(n >> kBits & kMask),
                                                    kCell * static_cast<int>(n & kMask));
      if (data.mChildMask.isOn(n)) {
        child(sum(place, data.mTable[n].child), corner);
      } else {
        addTile(level, corner, valueOf(data.mTable[n].value), data.mValueMask.isOn(n));
      }
    }
  }

  void addUpper(std::int64_t place, const openvdb::Coord& origin) {
    budget_.take(sizeof(OpenUpper));
    forCells<Upper>(place, origin, 2, [&](std::int64_t lower, const openvdb::Coord& corner) {
      budget_.take(sizeof(OpenLower));
      forCells<Lower>(lower, corner, 1, [&](std::int64_t leaf, const openvdb::Coord& leafCorner) {
        addLeaf(leaf, leafCorner);
      });
    });
  }

  void addLeaf(std::int64_t place, const openvdb::Coord& origin) {
    const auto& data = *visit<Leaf>(place)->data();
    // Of those with bits of a width of their own, the values lie behind.
    requireInside(place, data.memUsage());
    budget_.take(sizeof(OpenLeaf) + OpenLeaf::SIZE * sizeof(Value));
    auto leaf = std::make_unique<OpenLeaf>(origin, grid_->background());
    for (openvdb::Index n = 0; n < OpenLeaf::SIZE; ++n) {
      leaf->setValueOnly(n, valueOf(data.getValue(n)));
      leaf->setActiveState(n, data.mValueMask.isOn(n));
    }
    grid_->tree().addLeaf(leaf.release());
  }

  const char* begin_;
  std::uint64_t size_;
  Budget& budget_;
  const Fail& fail_;
  std::uint64_t visited_ = 0;
  typename GridT::Ptr grid_;
};

GridBase::Ptr convert(const Buffer& buffer, const std::string& name, Budget& budget,
                      const Fail& fail) {
  using nanovdb::GridType;
  nanovdb::GridData head;
  std::memcpy(static_cast<void*>(&head), buffer.bytes.get(), sizeof head);
  switch (head.mGridType) {
    case GridType::Float:
      return Converter<float, openvdb::FloatGrid>(buffer, budget, fail).convert();
    case GridType::Double:
      return Converter<double, openvdb::DoubleGrid>(buffer, budget, fail).convert();
    case GridType::Fp4:
      return Converter<nanovdb::Fp4, openvdb::FloatGrid>(buffer, budget, fail).convert();
    case GridType::Fp8:
      return Converter<nanovdb::Fp8, openvdb::FloatGrid>(buffer, budget, fail).convert();
    case GridType::Fp16:
      return Converter<nanovdb::Fp16, openvdb::FloatGrid>(buffer, budget, fail).convert();
    case GridType::FpN:
      return Converter<nanovdb::FpN, openvdb::FloatGrid>(buffer, budget, fail).convert();
    case GridType::Vec3f:
      return Converter<nanovdb::Vec3f, openvdb::Vec3SGrid>(buffer, budget, fail).convert();
    case GridType::Int32:
      return Converter<std::int32_t, openvdb::Int32Grid>(buffer, budget, fail).convert();
    case GridType::Int64:
      return Converter<std::int64_t, openvdb::Int64Grid>(buffer, budget, fail).convert();
    default:
      break;
  }
  const bool known = head.mGridType < GridType::End;
  fail("grid \"" + name + "\" holds values of NanoVDB's type " +
       (known ? nanovdb::toStr(head.mGridType) : "?") +
       ", which are not read; float, double, Float4 to FloatN, int32, int64 and Vec3f are");
  return nullptr;
}

void readSegment(Taker& taker, std::vector<GridBase::Ptr>& grids, Budget& budget,
                 const Fail& fail) {
  const auto head = taker.record<SegmentHead>("the header");
  if (head.magic != NANOVDB_MAGIC_NUMBER) fail("a segment is damaged: it does not begin as one");
  const std::uint32_t major = head.version >> 21U;
  if (major != NANOVDB_MAJOR_VERSION_NUMBER) {
    fail("its format is version " + std::to_string(major) + " of NanoVDB, and version " +
         std::to_string(NANOVDB_MAJOR_VERSION_NUMBER) + " is read");
  }
  std::vector<nanovdb::io::MetaData> metas;
  std::vector<std::string> names;
  for (int n = 0; n < head.gridCount; ++n) {
    metas.push_back(taker.record<nanovdb::io::MetaData>("the header of a grid"));
    std::string name(taker.take(metas.back().nameSize, "the name of a grid"));
    names.push_back(name.substr(0, name.find('\0')));
  }
  for (std::size_t n = 0; n < metas.size(); ++n) {
    const Buffer buffer = unpack(taker, metas[n], head.codec, budget, fail);
    grids.push_back(convert(buffer, names[n], budget, fail));
    grids.back()->setName(names[n]);
  }
}

}  // namespace

bool hasNanoVdb() { return true; }

std::vector<GridBase::Ptr> readNanoVdb(std::string_view bytes, const Fail& fail) {
  std::vector<GridBase::Ptr> grids;
  Taker taker(bytes, fail);
  Budget budget(bytes.size(), fail);
  while (!taker.empty()) readSegment(taker, grids, budget, fail);
  return grids;
}

}  // namespace tufa::io
