#include "io/grid/head_checks.h"

#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string_view>

#include "io/grid/tree_walker.h"

namespace tufa::io {
namespace {

/// Takes numbers and stretches from the front of a text.
class Pieces {
 public:
  explicit Pieces(std::string_view rest) : rest_(rest) {}

  std::string_view take(std::uint64_t count) {
    if (count > rest_.size()) throw DamagedGrid("its list of leaves is too short");
    const std::string_view piece = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return piece;
  }

  std::uint32_t takeNumber() {
    std::uint32_t number = 0;
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
  }

 private:
  std::string_view rest_;
};

/// `chunkBytes` of Blosc that hold `count` items or, of few bytes, the padding that
/// points/StreamCompression.h gives them; or the items as they are if there are no such bytes.
void requireSoundItems(Pieces& pieces, std::uint64_t chunkBytes, std::uint64_t count,
                       std::uint64_t itemBytes) {
  const std::uint64_t bytes = count * itemBytes;
  if (chunkBytes == 0) {
    pieces.take(bytes);
    return;
  }
  constexpr std::uint64_t kPaddedBytes = 128;
  std::array<std::uint32_t, 4> head{};
  const std::string_view chunk = pieces.take(chunkBytes);
  if (chunk.size() < sizeof head) throw DamagedGrid("a chunk of Blosc is too short for its head");
  std::memcpy(head.data(), chunk.data(), sizeof head);
  const bool padded = head[1] == kPaddedBytes && bytes < kPaddedBytes;
  requireSoundBloscChunk(head, chunkBytes, padded ? kPaddedBytes : bytes);
}

/// One byte for each leaf, then one number of eight bytes for each or none:
/// DelayedLoadMetadata::readValue().
void requireSoundLeafList(const std::string& value, std::uint64_t fileBytes) {
  if (value.empty()) return;
  Pieces pieces(value);
  const std::uint32_t leaves = pieces.takeNumber();
  if (leaves > fileBytes) {
    throw DamagedGrid("it claims " + std::to_string(leaves) + " leaves");
  }
  requireSoundItems(pieces, pieces.takeNumber(), leaves, 1);
  const std::uint32_t sizesBytes = pieces.takeNumber();
  if (sizesBytes == std::numeric_limits<std::uint32_t>::max()) return;
  requireSoundItems(pieces, sizesBytes, leaves, sizeof(std::int64_t));
}

}  // namespace

void requireSoundMetadata(const std::string& type, const std::string& value,
                          std::uint64_t fileBytes) {
  using openvdb::Metadata;
  if (type == openvdb::io::DelayedLoadMetadata::staticTypeName()) {
    return requireSoundLeafList(value, fileBytes);
  }
  if (type == openvdb::StringMetadata::staticTypeName() || !Metadata::isRegisteredType(type)) {
    return;
  }
  // OpenVDB takes the bytes of the type, whatever length the file gives. Types that an application
  // has registered may be of any length.
  const std::uint64_t bytes = Metadata::createMetadata(type)->size();
  if (bytes != 0 && value.size() != bytes) {
    throw DamagedGrid("it claims " + std::to_string(value.size()) + " bytes for metadata of type " +
                      type);
  }
  if (type == openvdb::BoolMetadata::staticTypeName() && static_cast<unsigned char>(value[0]) > 1) {
    throw DamagedGrid("it has a bool that is none");
  }
}

}  // namespace tufa::io
